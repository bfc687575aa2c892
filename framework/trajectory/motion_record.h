// SPDX-License-Identifier: Apache-2.0
// How a vehicle moves between two samples, as a record with a name: which columns its samples have,
// what a simulated vehicle follows, and where the differential equation comes from.
//
// A vehicle model names its motion here. The verifier looks for an integrator of that name
// (verify/motions). A model whose motion has none states the equation as a table.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/trajectory/stated_constraint.h"

namespace lapwing {

// Numbers of every sample beyond time, position, velocity, acceleration, yaw, yaw rate, gimbal and
// target.
struct MotionColumn {
  std::string name;    // snake_case
  std::string unit;    // SI, radians; "1" for a number without a unit
  int size = 1;        // numbers, 1 to kLargest
  bool input = false;  // held until the next sample or linear towards it; else a state
  static constexpr int kLargest = 16;
  bool operator==(const MotionColumn&) const = default;
};

// What the simulated vehicle is given to follow.
enum class Tracking {
  none,          // no simulated vehicle flies this motion
  force,         // the columns `force` (N) and `yaw_torque` (N m)
  rotors,        // the columns `orientation` and `rotor_thrusts`
  acceleration,  // the acceleration and the yaw rate of the samples
};

// One component of a derivative: the result of an operation.
struct MotionRate {
  std::string name;  // "acceleration", "yaw_rate", or a column that is a state: its derivative
  int component = 0;
  int operation = 0;
};

// A differential equation as data. The state is position, velocity, yaw and every column that is a
// state: position' = velocity, velocity' = acceleration, yaw' = yaw_rate, column' = its rate.
// Operations are those of a stated constraint; their inputs are `position`, `velocity`, `yaw` and
// the columns, of the same sample.
struct MotionTable {
  std::vector<ConstraintStep> operations;
  std::vector<MotionRate> rates;  // one for each component of each derivative
};

struct MotionRecord {
  std::string name;  // snake_case
  std::vector<MotionColumn> columns = {};
  bool moves = true;  // samples have velocity, acceleration and yaw rate
  Tracking tracked = Tracking::none;
  std::optional<MotionTable> table = std::nullopt;

  // Null where there is none.
  const MotionColumn* column(std::string_view name) const;
};

// "jerk_x", "orientation_w", "rotor_thrust_1", "bank_rate": what tables call each number.
std::vector<std::string> component_names(const MotionColumn& column);

// The motions that a plan states by their name alone.
//   force:  m r'' = F + m g, I_psi psi'' = M_psi (thesis 3.1); columns force, yaw_torque
//   rotors: rigid body with four rotors (3.11 to 3.13); columns orientation, body_rates,
//           rotor_thrusts
//   path:   positions and yaw only, joined by straight lines; no columns, no inputs
const MotionRecord& force_motion();
const MotionRecord& rotors_motion();
const MotionRecord& path_motion();
// Null where the name is none of these.
const MotionRecord* named_motion(std::string_view name);

// What is wrong with a record, in words: names, sizes, a table that lacks a derivative or reads
// what is not there. Empty where it holds together.
std::vector<std::string> problems_of(const MotionRecord& motion);

}  // namespace lapwing
