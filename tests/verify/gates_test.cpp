// SPDX-License-Identifier: Apache-2.0
// Gates and rotors: a vehicle that glides along x at 2 m/s, its rotors just carrying it.
#include <gtest/gtest.h>

#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

Plan gliding() {
  Vehicle vehicle = reference_vehicle();
  vehicle.gimbal.reset();
  Plan plan;
  plan.mission = "glide";
  plan.kind = "race";
  plan.vehicle = to_value(vehicle);
  plan.trajectory.motion = rotors_motion();
  plan.trajectory.inputs_held = false;
  for (int i = 0; i <= 10; ++i) {
    Sample s;
    s.time = 0.5 * i;
    s.position = {2 * s.time, 0, 3};
    s.velocity = {2, 0, 0};
    s.columns.set("orientation", Eigen::Quaterniond::Identity());
    s.columns.set("body_rates", Eigen::Vector3d(0, 0, 0));
    s.columns.set("rotor_thrusts",
                  Eigen::Vector4d(Eigen::Vector4d::Constant(vehicle.mass * kGravity / 4)));
    plan.trajectory.samples.push_back(s);
  }
  plan.task.closed_loop_required = false;
  return plan;
}

GateTask window(double x, double yaw = 0, double tunnel = 0) {
  GateTask gate;
  gate.name = "window";
  gate.position = {x, 0.3, 3};
  gate.corners = gate_corners({"rectangle", 1, 1});
  gate.tunnel_length = tunnel;
  set_direction(gate, {std::cos(yaw), std::sin(yaw), 0}, Eigen::Vector3d::UnitZ());
  return gate;
}

GateTask ball(double x, double radius) {
  GateTask gate;
  gate.name = "ball";
  gate.position = {x, 0.3, 3};
  gate.radius = radius;
  return gate;
}

Check gates_of(Plan plan, std::vector<GateTask> gates) {
  plan.task.gates = std::move(gates);
  for (const Check& check : verify(plan).checks)
    if (check.name == "gates") return check;
  return {};
}

// The glide ends at x = 10, or a rounding before it.
TEST(Gates, AreReachedByAPathThatEndsInThem) {
  EXPECT_TRUE(gates_of(gliding(), {window(10)}).pass);
  EXPECT_TRUE(gates_of(gliding(), {window(10 + 1e-9)}).pass);
  EXPECT_TRUE(gates_of(gliding(), {window(9 + 1e-9, 0, 2)}).pass);
  EXPECT_FALSE(gates_of(gliding(), {window(10.01)}).pass);
  EXPECT_FALSE(gates_of(gliding(), {window(9.01, 0, 2)}).pass);
}

TEST(Gates, AreJudgedOnThePath) {
  const Check check = gates_of(gliding(), {window(3), window(6.1)});
  EXPECT_TRUE(check.pass);
  EXPECT_NEAR(check.worst.value(), -0.2, 1e-6) << "0.5 m half width, 0.3 m beside the middle";
  EXPECT_TRUE(gates_of(gliding(), {ball(3, 0.31), ball(6, 0.4)}).pass);
  EXPECT_NEAR(gates_of(gliding(), {ball(3, 0.31)}).worst.value(), -0.01, 1e-6);
  EXPECT_FALSE(gates_of(gliding(), {ball(3, 0.29)}).pass);
}

TEST(Gates, HaveAnOrderAndADirection) {
  EXPECT_FALSE(gates_of(gliding(), {window(6), window(3)}).pass) << "the wrong way round";
  EXPECT_FALSE(gates_of(gliding(), {window(3, std::numbers::pi)}).pass) << "from behind";
  EXPECT_FALSE(gates_of(gliding(), {window(20)}).pass) << "never reached";
  EXPECT_NE(gates_of(gliding(), {window(6), window(3)}).detail.find("gate 2 (window)"),
            std::string::npos);
}

TEST(Gates, OnePassageIsOneGate) {
  EXPECT_FALSE(gates_of(gliding(), {window(3.3), window(3.3)}).pass);
  EXPECT_FALSE(gates_of(gliding(), {window(4), window(4)}).pass) << "at the end of a chord";
  EXPECT_TRUE(gates_of(gliding(), {window(3.3), window(3.301)}).pass) << "two within one chord";
}

TEST(Gates, TunnelsAreHeldFromEndToEnd) {
  EXPECT_TRUE(gates_of(gliding(), {window(5, 0, 8)}).pass);
  // Half a degree more and the tunnel is left before its end: 4 m * tan(4 degrees) is 0.28 m.
  EXPECT_FALSE(gates_of(gliding(), {window(5, radians(4), 8)}).pass);
  EXPECT_TRUE(gates_of(gliding(), {window(5, radians(4), 2)}).pass);
  EXPECT_FALSE(gates_of(gliding(), {window(5, 0, 12)}).pass) << "longer than the flight";
}

TEST(Gates, OfNoSenseFailTheDocument) {
  const auto refused = [](GateTask gate) {
    Plan plan = gliding();
    plan.task.gates = {gate};
    return !verify(plan).checks.front().pass;
  };
  GateTask bent = window(3);
  bent.direction = {1, 1, 0};
  GateTask few = window(3);
  few.corners.resize(2);
  GateTask turned = window(3);
  std::reverse(turned.corners.begin(), turned.corners.end());
  EXPECT_TRUE(refused(bent));
  EXPECT_TRUE(refused(few));
  EXPECT_TRUE(refused(turned)) << "corners run counter-clockwise";
  EXPECT_TRUE(refused(ball(3, 0.0)));
  EXPECT_TRUE(refused(window(std::nan(""))));
  EXPECT_FALSE(refused(window(3)));
}

TEST(Gates, SurviveTheDocument) {
  Plan plan = gliding();
  plan.task.gates = {window(3, 0.3, 2), ball(6, 0.4)};
  const Plan reread = plan_from_value(to_value(plan));
  EXPECT_EQ(plan_text(reread), plan_text(plan));
  EXPECT_FALSE(reread.task.closed_loop_required);
}

TEST(Rotors, AreJudgedOneByOne) {
  const auto fails = [](const Plan& plan, const std::string& name) {
    const std::vector<Check> failures = verify(plan).failures();
    return std::any_of(failures.begin(), failures.end(),
                       [&](const Check& check) { return check.name == name; });
  };
  EXPECT_TRUE(verify(gliding()).feasible());
  Plan plan = gliding();
  SampleColumns* columns = &plan.trajectory.samples[4].columns;
  columns->set("orientation",
               Eigen::Quaterniond(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitZ())));
  EXPECT_TRUE(fails(plan, "defect_yaw"));
  plan = gliding();
  columns = &plan.trajectory.samples[4].columns;
  columns->set("orientation", Eigen::Vector4d(1.1, 0, 0, 0));
  EXPECT_TRUE(fails(plan, "document"));
  plan = gliding();
  columns = &plan.trajectory.samples[4].columns;
  columns->set("body_rates", Eigen::Vector3d(0.1, 0, 0));
  EXPECT_TRUE(fails(plan, "defect_yaw"));
  plan = gliding();
  columns = &plan.trajectory.samples[4].columns;
  Eigen::Vector4d thrusts = columns->vector<4>("rotor_thrusts");
  thrusts[2] = 9;
  columns->set("rotor_thrusts", thrusts);
  EXPECT_TRUE(fails(plan, "rotor_thrust"));
}

}  // namespace
}  // namespace lapwing
