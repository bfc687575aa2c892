// SPDX-License-Identifier: Apache-2.0
// The vehicle's clock, as seen by ours: its offset, and jumps.
//
// TIMESYNC tells the vehicle's time in the middle of a round trip; where the vehicle does not
// answer, time_boot_ms of its telemetry does, late by the way of a packet. Before the flight the
// best of them is taken at once. In flight the offset by which the plan is paced follows slowly: by
// at most 1000 millionths where the vehicle's clock is late, and by 50 millionths, what
// a crystal may be off, where it is early, so that a plan is never flown faster than its limits
// allow. A difference of more than 0.25 s is a jump: the offset is taken anew.
#pragma once

#include <optional>

namespace lapwing {

class VehicleClock {
 public:
  // An answer to TIMESYNC: sent and received by our clock, with the vehicle's time between; s.
  void answered(double sent, double received, double vehicle);
  // time_boot_ms of a message that has just come; s.
  void telemetry(double now, double vehicle);
  // `step` seconds passed. Returns the seconds that the vehicle's clock made of them; jumps do not
  // count.
  double advance(double step);

  bool known() const { return known_; }
  double vehicle_at(double now) const { return now + offset_; }
  // By the best measurement so far, which the pace of the plan may not have reached yet.
  double ours_at(double vehicle) const { return vehicle - measured_; }
  // From now on the offset follows slowly: a plan is flown.
  void fly() { flying_ = true; }
  // s, one way, from the quickest round trip; 0 before one.
  double delay() const { return quickest_ ? *quickest_ / 2 : 0; }
  int jumps() const { return jumps_; }
  double last_jump() const { return last_jump_; }  // s

 private:
  void measured(double offset);

  bool known_ = false, flying_ = false;
  double offset_ = 0, measured_ = 0;  // s, vehicle minus ours: as used, as last measured
  std::optional<double> quickest_;
  double last_answer_ = -1e9;  // s
  int jumps_ = 0, early_ = 0;
  double last_jump_ = 0;
};

}  // namespace lapwing
