// SPDX-License-Identifier: Apache-2.0
// What the verifier checks: the list, and how the worst value of a check is kept.
//
// Internal to this room; callers include verify.h.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "framework/trajectory/plan.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/vehicle.h"
#include "framework/verify/certificate.h"
#include "framework/verify/judged_shape.h"
#include "framework/verify/motion.h"
#include "framework/verify/tolerances.h"
#include "framework/verify/verify.h"
#include "framework/verify/watch.h"

namespace lapwing {

struct CheckKind {
  const char* name;
  CheckGroup group;
  bool required;
  const char* unit;
};

// Every certificate lists all of these, in this order; then the constraints of the script.
inline constexpr std::array kCheckKinds{
    CheckKind{"document", CheckGroup::safety, true, ""},
    CheckKind{"provenance", CheckGroup::safety, true, ""},
    CheckKind{"defect_position", CheckGroup::safety, true, "m"},
    CheckKind{"defect_velocity", CheckGroup::safety, true, "m/s"},
    CheckKind{"defect_yaw", CheckGroup::safety, true, "rad"},
    CheckKind{"defect_yaw_rate", CheckGroup::safety, true, "rad/s"},
    CheckKind{"defect_gimbal", CheckGroup::safety, true, "rad"},
    CheckKind{"drift", CheckGroup::safety, true, ""},
    CheckKind{"stated_acceleration", CheckGroup::safety, true, "m/s^2"},
    CheckKind{"thrust_max", CheckGroup::safety, true, "N"},
    CheckKind{"thrust_min", CheckGroup::safety, true, "N"},
    CheckKind{"force_up", CheckGroup::safety, true, "N"},
    CheckKind{"yaw_torque", CheckGroup::safety, true, "N m"},
    CheckKind{"rotor_thrust", CheckGroup::safety, true, "N"},
    CheckKind{"speed_across", CheckGroup::safety, true, "m/s"},
    CheckKind{"climb_speed", CheckGroup::safety, true, "m/s"},
    CheckKind{"descent_speed", CheckGroup::safety, true, "m/s"},
    CheckKind{"acceleration_across", CheckGroup::safety, true, "m/s^2"},
    CheckKind{"acceleration_up", CheckGroup::safety, true, "m/s^2"},
    CheckKind{"acceleration_down", CheckGroup::safety, true, "m/s^2"},
    CheckKind{"yaw_rate", CheckGroup::safety, true, "rad/s"},
    CheckKind{"tilt_rate", CheckGroup::safety, true, "rad/s"},
    CheckKind{"gimbal_yaw", CheckGroup::safety, true, "rad"},
    CheckKind{"gimbal_pitch", CheckGroup::safety, true, "rad"},
    CheckKind{"gimbal_yaw_rate", CheckGroup::safety, true, "rad/s"},
    CheckKind{"gimbal_pitch_rate", CheckGroup::safety, true, "rad/s"},
    CheckKind{"clearance", CheckGroup::safety, true, "m"},
    CheckKind{"flight_zone", CheckGroup::safety, true, "m"},
    CheckKind{"subject_distance", CheckGroup::safety, true, "m"},
    CheckKind{"flight_time", CheckGroup::safety, true, "s"},
    CheckKind{"budget", CheckGroup::safety, true, "s"},
    CheckKind{"closed_loop", CheckGroup::safety, true, "m"},
    CheckKind{"closed_loop_yaw", CheckGroup::safety, true, "rad"},
    CheckKind{"rotors_saturated", CheckGroup::safety, false, ""},
    CheckKind{"keyframe_time", CheckGroup::task, true, "s"},
    CheckKind{"keyframe_miss", CheckGroup::task, true, "m"},
    CheckKind{"keyframe_yaw", CheckGroup::task, true, "rad"},
    CheckKind{"framing", CheckGroup::task, true, ""},
    CheckKind{"whole_subject", CheckGroup::task, false, ""},
    CheckKind{"line_of_sight", CheckGroup::task, false, ""},
    CheckKind{"gates", CheckGroup::task, true, "m"},
    CheckKind{"drawing", CheckGroup::task, true, "m"},
    CheckKind{"drawing_flown", CheckGroup::task, true, "m"},
    CheckKind{"view_miss", CheckGroup::task, true, "m"},
    CheckKind{"view_direction", CheckGroup::task, true, "rad"},
    CheckKind{"coverage", CheckGroup::task, true, ""},
};

// Listed for the motions that have them alone, behind the limits that all have.
inline constexpr std::array kMotionCheckKinds{
    CheckKind{"defect_state", CheckGroup::safety, true, ""},
    CheckKind{"jerk", CheckGroup::safety, true, "m/s^3"},
    CheckKind{"stall_speed", CheckGroup::safety, true, "m/s"},
    CheckKind{"bank", CheckGroup::safety, true, "rad"},
    CheckKind{"bank_rate", CheckGroup::safety, true, "rad/s"},
    CheckKind{"excess_thrust_max", CheckGroup::safety, true, "m/s^2"},
    CheckKind{"excess_thrust_min", CheckGroup::safety, true, "m/s^2"},
    CheckKind{"sideslip", CheckGroup::safety, true, "rad"},
};

// Listed for plans that state a pilot alone, behind 'flight_zone'.
inline constexpr std::array kPilotCheckKinds{
    CheckKind{"pilot_distance", CheckGroup::safety, true, "m"},
    CheckKind{"pilot_sight", CheckGroup::safety, true, "s"},
};

// Listed for plans alone that state what they need, behind the distances that all have.
inline constexpr std::array kHomeCheckKinds{
    CheckKind{"height_above_home", CheckGroup::safety, true, "m"},
    CheckKind{"distance_from_home", CheckGroup::safety, true, "m"},
    CheckKind{"height_above_ground", CheckGroup::safety, true, "m"},
    CheckKind{"rally_points", CheckGroup::safety, true, "m"},
};

// A check of that name, with its group, unit and whether it is required.
Check make_check(std::string_view name);
Check skipped_check(std::string_view name, std::string reason);

// The tolerance that a limit of this size has.
double tolerance_of(double limit);

// Fills in the result; a value that is not finite fails.
Check judged(Check check, double worst, double limit, double tolerance, double at,
             bool at_least = false);

// Keeps the worst of many values against one limit.
class Worst {
 public:
  Worst(std::string_view name, double limit, double tolerance, bool at_least = false);
  Worst(std::string_view name, double limit) : Worst(name, limit, tolerance_of(limit)) {}

  // True when this value is the worst so far. A value that is not a number stays the worst.
  bool see(double value, double time);
  double value() const { return value_; }
  double excess() const;  // beyond the limit when positive
  Check check() const;

 private:
  std::string name_;
  double limit_, tolerance_, value_ = 0, at_ = 0;
  bool at_least_, seen_ = false;
};

// The obstacles of an environment, in its order.
using JudgedShapes = std::vector<std::unique_ptr<JudgedShape>>;

// Everything that a check may read.
struct Flight {
  const Plan& plan;
  const Vehicle& vehicle;
  Motion& motion;
  const JudgedShapes& shapes;
  const ControllerSource& controllers;
  Watch& watch;  // `motion` tells it how far a walk along it has come
};

// The families. Each appends its checks; `document` also yields the vehicle that it read.
struct Document {
  Check check;
  Vehicle vehicle;
  JudgedShapes shapes;
};
Document check_document(const Plan& plan, const VerifyRequest& request, Watch& watch);
void check_dynamics(const Flight& flight, Certificate& certificate);
void check_limits(const Flight& flight, Certificate& certificate);
void check_clearance(const Flight& flight, Certificate& certificate);
void check_flight_zones(const Flight& flight, Certificate& certificate);
// Of plans without a pilot nothing is listed.
void check_pilot(const Flight& flight, Certificate& certificate);
void check_subject_distance(const Flight& flight, Certificate& certificate);
void check_home(const Flight& flight, Certificate& certificate);
// What was flown, where the motion model can be.
std::optional<FlownPath> check_closed_loop(const Flight& flight, Certificate& certificate);
void check_time(const Flight& flight, Certificate& certificate);
void check_task(const Flight& flight, const std::optional<FlownPath>& flown,
                Certificate& certificate);
void check_drawing(const Flight& flight, const std::optional<FlownPath>& flown,
                   Certificate& certificate);
void check_framing(const Flight& flight, Certificate& certificate);
void check_gates(const Flight& flight, Certificate& certificate);
void check_views(const Flight& flight, Certificate& certificate);
void check_coverage(const Flight& flight, Certificate& certificate);
// One for each constraint of the script, named after it, behind all that every certificate lists.
void check_constraints(const Flight& flight, Certificate& certificate);
void skip_constraints(const Plan& plan, const std::string& reason, Certificate& certificate);

// What of the environment, the cuts and the framing does not hold together, in words. The spans are
// judged against a flight that ends at `finish`.
void list_problems(const Environment& environment, std::vector<std::string>& problems);
void list_home_problems(const Plan& plan, std::vector<std::string>& problems);
void list_gate_problems(const Task& task, std::vector<std::string>& problems);
void list_scan_problems(const Plan& plan, std::vector<std::string>& problems);
void list_constraint_problems(const Plan& plan, std::vector<std::string>& problems);
void list_problems(const Plan& film, double finish, std::vector<std::string>& problems);

// Whether a figure is one that a plan may hold.
inline bool sound(double number) {
  return std::abs(number) <= tolerances::kLargestNumber;
}
inline bool sound(const Eigen::Vector3d& v) {
  return sound(v.x()) && sound(v.y()) && sound(v.z());
}

}  // namespace lapwing
