// SPDX-License-Identifier: Apache-2.0
// When the vehicle measured what it tells: packets come late, and state the time since its boot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lapwing::tlog {

// Times since boot on the clock of the log, by the packet that came quickest. A boot clock that
// jumps by more than 10 s, as that of a vehicle that starts anew, begins another part.
class BootClock {
 public:
  // A packet that states its time: s of the log when it was received, s since boot. All packets of
  // the file, in its order.
  void learn(double received, double boot);

  // The same packets again, in the same order: s of the log at which this one was measured.
  double measured(double boot);
  // Of a time since boot that another sender states; not a number where nothing is learned.
  double at(double boot) const;

 private:
  struct Part {
    std::size_t first;  // packet
    double offset;      // s, of the quickest: received - boot
  };
  std::vector<Part> parts_;
  std::size_t learned_ = 0, asked_ = 0, part_ = 0;
};

}  // namespace lapwing::tlog
