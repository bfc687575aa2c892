// SPDX-License-Identifier: Apache-2.0
// What a vehicle sees of the setpoints that it receives: their rate, jumps, and limits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "framework/core/value.h"
#include "framework/fly/plan_pacer.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

class SetpointAudit {
 public:
  explicit SetpointAudit(const Vehicle& vehicle) : vehicle_(vehicle) {}

  // A setpoint received at `now` (s), of the sender's time `stamp` (s of the vehicle's clock).
  void take(const Setpoint& setpoint, double stamp, double now);

  std::uint64_t count() const { return count_; }
  // Setpoints that ask for more than the vehicle's limits, or jump.
  std::uint64_t beyond() const { return beyond_; }
  double gap_worst() const { return gap_worst_; }  // s
  // "speed 80 %, acceleration 101 %, yaw rate 30 % of the limits, jump 0.02 m", the worst so far.
  std::string in_words() const;
  // Counts; shares of the limits; "rate" in 1/s; "jump_worst" in m: how far a setpoint is from
  // where the one before and both velocities put it.
  Value to_value() const;

 private:
  const Vehicle& vehicle_;
  std::uint64_t count_ = 0, beyond_ = 0;
  double first_ = 0, last_ = 0, gap_worst_ = 0;
  double speed_share_ = 0, acceleration_share_ = 0, yaw_share_ = 0, jump_worst_ = 0;
  std::optional<Setpoint> before_;
  double before_stamp_ = 0;
};

}  // namespace lapwing
