// SPDX-License-Identifier: Apache-2.0
// The verifier's integrators on inputs whose motion has a closed solution.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/units.h"
#include "framework/trajectory/motion_recorder.h"
#include "framework/verify/motion.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

MotionRecord velocity_motion() {
  return {.name = "velocity",
          .columns = {{"jerk", "m/s^3", 3, true}},
          .tracked = Tracking::acceleration};
}

MotionRecord turning_motion() {
  return {.name = "coordinated_turn",
          .columns = {{"lateral_acceleration", "m/s^2", 1, false},
                      {"forward_acceleration", "m/s^2", 1, true},
                      {"climb_acceleration", "m/s^2", 1, true},
                      {"lateral_jerk", "m/s^3", 1, true}}};
}

Vehicle winged() {
  Vehicle v = reference_vehicle();
  v.has_rotors = false;
  v.inertia.setZero();
  v.rotors = {};
  v.yaw_share = 0;
  v.speed_across_max = 30;
  v.climb_speed_max = v.descent_speed_max = 6;
  v.acceleration_across_max = 8;
  v.acceleration_up_max = v.acceleration_down_max = 3;
  v.wing = Wing{12, radians(35), radians(90), -3, 3};
  v.gimbal.reset();
  return v;
}

Sample turning(double time, const Vector3d& position, const Vector3d& velocity, double course,
               double lateral, double forward = 0) {
  Sample s;
  s.time = time;
  s.position = position;
  s.velocity = velocity;
  s.yaw = course;
  s.yaw_rate = lateral / velocity.head<2>().norm();
  s.acceleration = {forward * std::cos(course) - lateral * std::sin(course),
                    forward * std::sin(course) + lateral * std::cos(course), 0};
  s.columns.set("lateral_acceleration", lateral);
  s.columns.set("forward_acceleration", forward);
  s.columns.set("climb_acceleration", 0.0);
  s.columns.set("lateral_jerk", 0.0);
  return s;
}

Plan plan_of(const Vehicle& vehicle, Trajectory trajectory) {
  Plan plan;
  plan.mission = "motion";
  plan.kind = "film";
  plan.vehicle = to_value(vehicle);
  plan.trajectory = std::move(trajectory);
  return plan;
}

// A full circle of 5 m/s^2 at 20 m/s: 80 m of radius.
Plan circle(int samples = 41) {
  const double speed = 20, lateral = 5, radius = speed * speed / lateral;
  Trajectory trajectory;
  trajectory.motion = turning_motion();
  for (int i = 0; i < samples; ++i) {
    const double angle = 2 * std::numbers::pi * i / (samples - 1);
    trajectory.samples.push_back(
        turning(angle * radius / speed, radius * Vector3d(std::sin(angle), 1 - std::cos(angle), 0),
                speed * Vector3d(std::cos(angle), std::sin(angle), 0), angle, lateral));
  }
  return plan_of(winged(), trajectory);
}

TEST(TurnIntegrator, FliesACircleAtConstantBank) {
  const Plan plan = circle();
  const Vehicle vehicle = winged();
  Motion motion(plan.trajectory, vehicle);
  for (std::size_t i = 0; i < motion.intervals(); ++i)
    for (const MotionPoint& p : motion.integrate(i)) {
      EXPECT_NEAR((p.position - Vector3d(0, 80, 0)).norm(), 80, 1e-7);
      EXPECT_NEAR(p.velocity.norm(), 20, 1e-12);
      EXPECT_NEAR(p.yaw, 0.25 * p.time, 1e-12);
    }
  const Certificate certificate = verify(plan);
  EXPECT_TRUE(certificate.feasible());
  EXPECT_NEAR(*certificate.find("bank")->worst, std::atan(5 / kGravity), 1e-12);
  EXPECT_NEAR(*certificate.find("stall_speed")->worst, 20 / std::sqrt(std::hypot(1, 5 / kGravity)),
              1e-9);
}

TEST(TurnIntegrator, ClimbsStraight) {
  Trajectory trajectory;
  trajectory.motion = turning_motion();
  // From 16 m/s with 1 m/s^2, at 3 m/s upwards.
  for (const double t : {0.0, 2.0, 4.0})
    trajectory.samples.push_back(
        turning(t, {16 * t + t * t / 2, 0, 3 * t}, {16 + t, 0, 3}, 0, 0, 1));
  const Vehicle vehicle = winged();
  Motion motion(trajectory, vehicle);
  for (std::size_t i = 0; i < motion.intervals(); ++i)
    for (const MotionPoint& p : motion.integrate(i)) {
      EXPECT_NEAR(p.position.x(), 16 * p.time + p.time * p.time / 2, 1e-9);
      EXPECT_NEAR(p.position.z(), 3 * p.time, 1e-12);
    }
  const Certificate certificate = verify(plan_of(vehicle, trajectory));
  EXPECT_TRUE(certificate.feasible());
  // The most where it is slowest: (U a + g w) / V.
  EXPECT_NEAR(*certificate.find("excess_thrust_max")->worst,
              (16 + kGravity * 3) / std::hypot(16, 3), 1e-9);
}

TEST(TurnIntegrator, FindsWhatAWingCannotDo) {
  const auto fails = [](const Plan& plan, const std::string& name) {
    for (const Check& check : verify(plan).failures())
      if (check.name == name) return true;
    return false;
  };
  const auto with = [](const std::function<void(Wing&)>& change) {
    Vehicle vehicle = winged();
    change(*vehicle.wing);
    Plan plan = circle();
    plan.vehicle = to_value(vehicle);
    return plan;
  };
  EXPECT_TRUE(fails(with([](Wing& w) { w.stall_speed = 19; }), "stall_speed"));
  EXPECT_TRUE(fails(with([](Wing& w) { w.bank_max = radians(25); }), "bank"));
  Plan plan = circle();
  plan.trajectory.samples[9].columns.set("lateral_acceleration", 4.0);
  EXPECT_TRUE(fails(plan, "defect_state"));
  plan = circle();
  plan.trajectory.samples[9].columns.set("forward_acceleration", 4.0);
  EXPECT_TRUE(fails(plan, "excess_thrust_max"));
  plan = circle();
  plan.trajectory.samples[9].columns.set("lateral_jerk", 20.0);
  EXPECT_TRUE(fails(plan, "bank_rate"));
  plan = circle();
  for (Sample& s : plan.trajectory.samples) s.yaw += 0.1;
  EXPECT_TRUE(fails(plan, "sideslip"));
}

// A ramp of the acceleration to 2 m/s^2 and back, with 4 m/s^3.
Trajectory ramp() {
  Trajectory trajectory;
  trajectory.motion = velocity_motion();
  Sample s;
  s.position = {1, 2, 3};
  for (const double jerk : {4.0, -4.0, 0.0}) {
    s.columns.set("jerk", Vector3d(jerk, 0, 0));
    s.yaw_rate = 0.1 * jerk;
    trajectory.samples.push_back(s);
    const double h = 0.5;
    s.position.x() += h * s.velocity.x() + h * h * s.acceleration.x() / 2 + h * h * h * jerk / 6;
    s.velocity.x() += h * s.acceleration.x() + h * h * jerk / 2;
    s.acceleration.x() += h * jerk;
    s.yaw += h * s.yaw_rate;
    s.time += h;
  }
  return trajectory;
}

TEST(VelocityIntegrator, FollowsAJerkLimitedRamp) {
  const Trajectory trajectory = ramp();
  Vehicle vehicle = reference_vehicle();
  vehicle.jerk_max = 4;
  vehicle.gimbal.reset();
  Motion motion(trajectory, vehicle);
  const MotionPoint top = motion.integrate(0).back();
  EXPECT_NEAR(top.acceleration.x(), 2, 1e-12);
  EXPECT_NEAR(top.velocity.x(), 0.5, 1e-12);
  EXPECT_NEAR(top.position.x(), 1 + 1.0 / 12, 1e-12);
  const MotionPoint end = motion.integrate(1).back();
  EXPECT_NEAR(end.acceleration.x(), 0, 1e-12);
  EXPECT_NEAR(end.velocity.x(), 1, 1e-12);
  EXPECT_NEAR(end.position.x(), 1.5, 1e-12);
  const Certificate certificate = verify(plan_of(vehicle, trajectory));
  EXPECT_TRUE(certificate.find("jerk")->pass);
  EXPECT_TRUE(certificate.find("defect_state")->pass);
  EXPECT_THAT(certificate.find("thrust_max")->skipped, HasSubstr("the thrust is not known"));

  Plan jumps = plan_of(vehicle, trajectory);
  jumps.trajectory.samples[1].acceleration.x() += 0.05;
  EXPECT_FALSE(verify(jumps).find("defect_state")->pass);
  vehicle.jerk_max = 3.9;
  EXPECT_FALSE(verify(plan_of(vehicle, trajectory)).find("jerk")->pass);
}

TEST(VelocityIntegrator, VehicleWithoutRotorsIsNotSimulated) {
  Vehicle vehicle = winged();
  vehicle.wing.reset();
  const Certificate certificate = verify(plan_of(vehicle, ramp()));
  EXPECT_THAT(certificate.find("closed_loop")->skipped, HasSubstr("states no rotors"));
  EXPECT_TRUE(certificate.find("document")->pass);
}

// x'' = -x as a table: a spring along x, and a heading that turns ever faster.
MotionTable spring() {
  MotionRecorder motion;
  motion.rate("acceleration", 0, -motion.input("position", 0));
  motion.rate("acceleration", 1, motion.constant(0));
  motion.rate("acceleration", 2, motion.constant(0));
  motion.rate("yaw_rate", 0, motion.input("spin"));
  motion.rate("spin", 0, 0.5 * (motion.input("push") + motion.input("push")));
  return motion.table();
}

TEST(TableIntegrator, SwingsAsTheStatedDerivativesSay) {
  Trajectory trajectory;
  trajectory.motion = {.name = "swing",
                       .columns = {{"spin", "rad/s", 1, false}, {"push", "rad/s^2", 1, true}},
                       .table = spring()};
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.1 * i;
    Sample s;
    s.time = t;
    s.position = {std::cos(t), 0, 2};
    s.velocity = {-std::sin(t), 0, 0};
    s.acceleration = {-std::cos(t), 0, 0};
    s.yaw = 0.1 * t * t;
    s.yaw_rate = 0.2 * t;
    s.columns.set("spin", 0.2 * t);
    s.columns.set("push", 0.2);
    trajectory.samples.push_back(s);
  }
  Vehicle vehicle = winged();
  Motion motion(trajectory, vehicle);
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const MotionPoint end = motion.integrate(i).back();
    EXPECT_NEAR(end.position.x(), std::cos(end.time), 1e-12);
    EXPECT_NEAR(end.yaw, 0.1 * end.time * end.time, 1e-12);
  }
  const Plan plan = plan_of(vehicle, trajectory);
  const Certificate certificate = verify(plan);
  EXPECT_TRUE(certificate.feasible());
  EXPECT_THAT(certificate.find("defect_position")->detail,
              HasSubstr("'swing' is integrated from the derivatives that the plan states"));
  // The document carries the table.
  const Plan back = plan_from_value(to_value(plan));
  EXPECT_EQ(plan_text(back), plan_text(plan));
  EXPECT_TRUE(verify(back).feasible());

  Plan other = plan;
  other.trajectory.motion.table->operations[1].op = ConstraintOp::exp;
  EXPECT_FALSE(verify(other).feasible());
  other = plan;
  other.trajectory.motion.table.reset();
  EXPECT_THAT(verify(other).find("document")->detail, HasSubstr("'swing' has no integrator"));
}

}  // namespace
}  // namespace lapwing
