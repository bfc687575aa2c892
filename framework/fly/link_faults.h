// SPDX-License-Identifier: Apache-2.0
// What a simulated link and a simulated vehicle do wrong, on request.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/random.h"

namespace lapwing {

// Times are s after the vehicle began to follow setpoints.
struct SimulatedFaults {
  double lost = 0;               // share of packets, each way
  double late = 0;               // s: each packet takes up to this, and packets keep their order
  double noise = 0;              // share of packets with a byte that is wrong
  double gap = 0, gap_at = 3;    // s: for so long no packet passes, either way
  double jump = 0, jump_at = 3;  // s, that the vehicle's clock jumps by
  std::optional<double> takeover_at;  // the pilot switches to POSITION
  std::optional<double> unwell_at;    // the estimate is not valid any more
  bool refuse_arming = false, refuse_mode = false, refuse_fence = false, refuse_gimbal = false;
  bool lose_estimate = false;  // it is not valid from the start
  int battery = 95;            // percent at the start
  double offset = 0;           // m east of the plan's start, where the vehicle stands
};

// "lost=0.2", "gap=5@3", "refuse=mode". Throws InputError with all that there is.
void add_fault(const std::string& text, SimulatedFaults& faults);

// One direction of the link. Packets leave in the order in which they came.
class FaultyChannel {
 public:
  FaultyChannel(const SimulatedFaults& faults, std::uint64_t seed);

  // `open`: whether the link passes anything now.
  void push(std::string bytes, double now, bool open);
  // What has arrived by `now`.
  std::vector<std::string> pop(double now);

 private:
  struct OnItsWay {
    double arrives;
    std::string bytes;
  };
  const SimulatedFaults& faults_;
  Random random_;
  std::deque<OnItsWay> waiting_;
};

}  // namespace lapwing
