// SPDX-License-Identifier: Apache-2.0
// A fixed-wing aircraft in still air that turns without sideslip (Beard, McLain, "Small Unmanned
// Aircraft", 2012, chapter 9). With U the horizontal speed, chi the course and the heading, b the
// acceleration across the course, which a bank of atan(b / g) gives in level flight:
//
//   x' = U cos chi, y' = U sin chi, z' = w,   U' = a_f,   w' = a_w,   chi' = b / U,   b' = j
//
// The inputs a_f, a_w and j are held or linear. Runge-Kutta 4, in variables that the planner's
// model does not use.
#include <cmath>
#include <numbers>

#include "framework/core/units.h"
#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

struct TurnInputs {
  double forward, up, lateral_jerk;
};

struct TurnState {
  Vector3d position;
  double across, climb, course, lateral;

  TurnState moved(const TurnState& rate, double h) const {
    return {position + h * rate.position, across + h * rate.across, climb + h * rate.climb,
            course + h * rate.course, lateral + h * rate.lateral};
  }
};

TurnInputs turn_inputs_of(const Sample& s) {
  return {s.columns.scalar("forward_acceleration"), s.columns.scalar("climb_acceleration"),
          s.columns.scalar("lateral_jerk")};
}

TurnInputs inputs_between(const TurnInputs& a, const TurnInputs& b, double share) {
  return {a.forward + share * (b.forward - a.forward), a.up + share * (b.up - a.up),
          a.lateral_jerk + share * (b.lateral_jerk - a.lateral_jerk)};
}

TurnState rate_of(const TurnState& x, const TurnInputs& u) {
  return {{x.across * std::cos(x.course), x.across * std::sin(x.course), x.climb},
          u.forward,
          u.up,
          x.lateral / x.across,
          u.lateral_jerk};
}

MotionPoint turn_point(const TurnState& x, const TurnInputs& u, double time) {
  const double c = std::cos(x.course), s = std::sin(x.course);
  return {.time = time,
          .position = x.position,
          .velocity = {x.across * c, x.across * s, x.climb},
          .acceleration = {u.forward * c - x.lateral * s, u.forward * s + x.lateral * c, u.up},
          .yaw = x.course,
          .yaw_rate = x.lateral / x.across,
          .columns = {x.lateral, u.forward, u.up, u.lateral_jerk}};
}

// (thrust - drag) / mass: what speeds the aircraft up along its path or lifts it.
double excess_thrust(const MotionPoint& p) {
  const double speed = p.velocity.norm();
  return (p.velocity.dot(p.acceleration) + kGravity * p.velocity.z()) / speed;
}

// 1 / cos(bank) of the bank that turns it.
double load_factor(const MotionPoint& p) {
  return std::hypot(1.0, p.columns[0] / kGravity);
}

class TurnIntegrator final : public MotionIntegrator {
 public:
  explicit TurnIntegrator(const Trajectory& trajectory) : held_(trajectory.inputs_held) {}

  double steps(const Sample& a, const Sample& b) const override {
    namespace tol = tolerances;
    const double h = b.time - a.time;
    const TurnInputs u = turn_inputs_of(a), v = held_ ? u : turn_inputs_of(b);
    const double lateral = std::abs(a.columns.scalar("lateral_acceleration")) +
                           h * std::max(std::abs(u.lateral_jerk), std::abs(v.lateral_jerk));
    const double forward = std::max(std::abs(u.forward), std::abs(v.forward));
    const double up = std::max(std::abs(u.up), std::abs(v.up));
    const double acceleration = std::hypot(forward, up, lateral);
    const double change = std::max(std::abs(v.forward - u.forward), std::abs(v.up - u.up)) * h / 8;
    return std::ceil(
        std::max({1.0, h / tol::kStepMaximum, h * std::sqrt(acceleration / (8 * tol::kBulge)),
                  std::sqrt(change / tol::kHiddenSpeed)}));
  }

  MotionPoint stated(const Sample& s) const override {
    const TurnInputs u = turn_inputs_of(s);
    const TurnState x = state_of(s);
    MotionPoint p = turn_point(x, u, s.time);
    p.velocity = s.velocity;
    p.gimbal_yaw = s.gimbal_yaw;
    p.gimbal_pitch = s.gimbal_pitch;
    p.gimbal_yaw_rate = s.gimbal_yaw_rate;
    p.gimbal_pitch_rate = s.gimbal_pitch_rate;
    return p;
  }

  void integrate(const Sample& a, const Sample& b, std::size_t count,
                 std::vector<MotionPoint>& points) const override {
    const TurnInputs first = turn_inputs_of(a), last = held_ ? first : turn_inputs_of(b);
    const double h = (b.time - a.time) / static_cast<double>(count);
    const auto inputs = [&](double steps_done) {
      return inputs_between(first, last, steps_done / static_cast<double>(count));
    };
    TurnState x = state_of(a);
    points.push_back(turn_point(x, inputs(0), a.time));
    for (std::size_t k = 0; k < count; ++k) {
      const double at = static_cast<double>(k);
      const TurnState k1 = rate_of(x, inputs(at));
      const TurnState k2 = rate_of(x.moved(k1, h / 2), inputs(at + 0.5));
      const TurnState k3 = rate_of(x.moved(k2, h / 2), inputs(at + 0.5));
      const TurnState k4 = rate_of(x.moved(k3, h), inputs(at + 1));
      x = x.moved(k1, h / 6).moved(k2, h / 3).moved(k3, h / 3).moved(k4, h / 6);
      points.push_back(
          turn_point(x, inputs(at + 1), k + 1 == count ? b.time : a.time + h * (at + 1)));
    }
    turn_gimbal(a, b, {held_}, points);
  }

  double state_defect(const MotionPoint& reached, const MotionPoint& stated) const override {
    return std::abs(reached.columns[0] - stated.columns[0]) / tolerances::kAcceleration;
  }

  std::vector<OwnLimit> limits(const Vehicle& vehicle) const override {
    const Wing& wing = *vehicle.wing;
    return {{"stall_speed", wing.stall_speed, true,
             [](const MotionPoint& p) { return p.velocity.norm() / std::sqrt(load_factor(p)); }},
            {"bank", wing.bank_max, false,
             [](const MotionPoint& p) { return std::atan(std::abs(p.columns[0]) / kGravity); }},
            {"bank_rate", wing.bank_rate_max, false,
             [](const MotionPoint& p) {
               const double tangent = p.columns[0] / kGravity;
               return std::abs(p.columns[3]) / kGravity / (1 + tangent * tangent);
             }},
            {"excess_thrust_max", wing.excess_thrust_max, false, &excess_thrust},
            {"excess_thrust_min", wing.excess_thrust_min, true, &excess_thrust},
            {"sideslip", tolerances::kYawDefect, false, [](const MotionPoint& p) {
               const double along = std::atan2(p.velocity.y(), p.velocity.x());
               return std::abs(std::remainder(p.yaw - along, 2 * std::numbers::pi));
             }}};
  }

 private:
  static TurnState state_of(const Sample& s) {
    return {s.position, s.velocity.head<2>().norm(), s.velocity.z(), s.yaw,
            s.columns.scalar("lateral_acceleration")};
  }

  bool held_;
};

}  // namespace

KnownMotion coordinated_turn_integrator() {
  return {"coordinated_turn",
          {{"lateral_acceleration", "m/s^2", 1, false},
           {"forward_acceleration", "m/s^2", 1, true},
           {"climb_acceleration", "m/s^2", 1, true},
           {"lateral_jerk", "m/s^3", 1, true}},
          [](const Trajectory& trajectory, const Vehicle&) -> std::unique_ptr<MotionIntegrator> {
            return std::make_unique<TurnIntegrator>(trajectory);
          },
          [](const Vehicle& vehicle) -> std::string { return vehicle.wing ? "" : "a wing"; }};
}

}  // namespace lapwing
