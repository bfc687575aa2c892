// SPDX-License-Identifier: Apache-2.0
// What Ipopt prints, as lines of our log.
#pragma once

#include <string>

namespace lapwing {

// Text in pieces becomes lines of the log, at level debug and named "ipopt: ". Lines that tell
// processor time are left out: equal runs give equal logs.
class JournalLines {
 public:
  ~JournalLines() { flush(); }
  void write(const char* text);
  void flush();
  // Whether the linear solver said that it got no memory. Ipopt takes that for a bad step and may
  // go on, or end as if the problem were at fault.
  bool out_of_memory() const { return out_of_memory_; }

 private:
  void line(const std::string& text);
  std::string pending_;
  bool out_of_memory_ = false;
};

}  // namespace lapwing
