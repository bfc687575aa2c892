// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/differences.h"
#include "framework/core/random.h"
#include "tests/plugins/plugin_setting.h"

namespace lapwing {
namespace {

Vehicle winged() {
  Vehicle vehicle = camera_drone();
  vehicle.has_rotors = false;
  vehicle.speed_across_max = 30;
  vehicle.acceleration_across_max = 8;
  vehicle.acceleration_up_max = vehicle.acceleration_down_max = 3;
  vehicle.wing = Wing{12, 0.6, 1.5, -3, 3};
  return vehicle;
}

std::unique_ptr<VehicleModel> bound_wing() {
  auto model = plugins().create<VehicleModel>("fixed_wing");
  model->bind(winged());
  return model;
}

// position[3] velocity[3] yaw lateral forward up lateral_jerk step
Eigen::VectorXd flown(const VehicleModel& model, Eigen::VectorXd x, int steps) {
  Workspace workspace;
  for (int i = 0; i < steps; ++i) {
    Eigen::VectorXd next(8);
    model.flow({0, 1}, x.data(), next.data(), nullptr, workspace);
    x.head<8>() = next;
  }
  return x;
}

TEST(FixedWing, TurnsACircleAtConstantBank) {
  const auto model = bound_wing();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(12);
  x(3) = 20;
  x(7) = 5;                                // m/s^2: 80 m of radius
  x(11) = 2 * std::numbers::pi * 4 / 100;  // a hundredth of the circle
  const Eigen::VectorXd quarter = flown(*model, x, 25);
  EXPECT_NEAR(quarter(0), 80, 1e-5);
  EXPECT_NEAR(quarter(1), 80, 1e-5);
  EXPECT_NEAR(quarter(4), 20, 1e-6);
  EXPECT_NEAR(quarter(6), std::numbers::pi / 2, 1e-6);
  const Eigen::VectorXd whole = flown(*model, x, 100);
  EXPECT_NEAR(whole.head<3>().norm(), 0, 1e-4);
}

TEST(FixedWing, ClimbsStraight) {
  const auto model = bound_wing();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(12);
  x(3) = 16, x(5) = 4, x(8) = 1, x(11) = 0.5;
  const Eigen::VectorXd end = flown(*model, x, 8);
  EXPECT_NEAR(end(0), 16 * 4 + 8, 1e-12);
  EXPECT_NEAR(end(2), 16, 1e-12);
  EXPECT_NEAR(end(3), 20, 1e-12);
}

// Derivatives at flying speeds, of the flow and of the model's own conditions.
TEST(FixedWing, DerivativesEqualDifferences) {
  const auto model = bound_wing();
  Random random(7);
  Workspace workspace;
  for (int turn = 0; turn < 20; ++turn) {
    std::vector<double> x;
    for (int i = 0; i < 12; ++i) x.push_back(random.uniform(-3, 3));
    x[3] += 15, x[11] = 0.2;
    RowMajorMatrix stated(8, 12);
    std::vector<double> next(8);
    model->flow({0, 1}, x.data(), next.data(), stated.data(), workspace);
    const WorstEntry worst = compare_derivatives(
        [&](const double* at, double* y) {
          model->flow({0, 1}, at, y, nullptr, workspace);
        },
        x, stated, 1e-6);
    EXPECT_LE(worst.excess, 1) << worst.row << " by " << worst.column;
  }
}

TEST(FixedWing, ConditionsSayStallThrustAndCourse) {
  const auto model = bound_wing();
  StageLayout layout;
  for (const BlockSpec& block : model->blocks()) layout.add(block);
  const Vehicle vehicle = winged();
  const Environment environment;
  const Horizon horizon{.stages = 4, .step = 0.2};
  auto conditions = model->conditions();
  ASSERT_EQ(conditions.size(), 3u);
  Workspace workspace;
  Random random(3);
  for (auto& [name, constraint] : conditions) {
    const FunctionShape shape = constraint->bind({layout, horizon, vehicle, environment});
    const std::size_t width = name == "limits" ? 6 : name == "course" ? 4 : 10;
    std::vector<double> x{15, 4, 2, 1, 0.5, 14, 5, 1, 0.2, 0.3};
    x.resize(width);
    for (double& value : x) value += random.uniform(-1, 1);
    RowMajorMatrix stated(shape.rows, width);
    std::vector<double> values(static_cast<std::size_t>(shape.rows));
    constraint->evaluate({0, 1}, x.data(), values.data(), stated.data(), workspace);
    const WorstEntry worst = compare_derivatives(
        [&](const double* at, double* y) {
          constraint->evaluate({0, 1}, at, y, nullptr, workspace);
        },
        x, stated, 1e-6);
    EXPECT_LE(worst.excess, 1) << name;
  }
  // At 5 % above the stall in straight flight, exactly the limit.
  std::vector<double> slow{12 * 1.05, 0, 0, 0, 0, 0}, rows(2);
  conditions[0].second->evaluate({0, 1}, slow.data(), rows.data(), nullptr, workspace);
  EXPECT_NEAR(rows[0], 0, 1e-12);
  EXPECT_NEAR(rows[1], 0, 1e-12);
  std::vector<double> climbing{16, 0, 4, 0, 1, 0};
  conditions[0].second->evaluate({0, 1}, climbing.data(), rows.data(), nullptr, workspace);
  EXPECT_NEAR(rows[1], (16 + kGravity * 4) / std::hypot(16, 4), 1e-12);
  // The inputs of a step at the velocity of its end.
  std::vector<double> step{16, 0, 0, 1, 0, 16, 0, 4, -9, -9};
  EXPECT_EQ(conditions[1].first, "thrust_at_ends");
  conditions[1].second->evaluate({0, 1}, step.data(), rows.data(), nullptr, workspace);
  EXPECT_NEAR(rows[0], (16 + kGravity * 4) / std::hypot(16, 4), 1e-12);
}

TEST(FixedWing, NeedsAWingAndCannotRest) {
  const auto model = plugins().create<VehicleModel>("fixed_wing");
  EXPECT_THROW(model->bind(camera_drone()), InputError);
  EXPECT_FALSE(bound_wing()->rests());
}

}  // namespace
}  // namespace lapwing
