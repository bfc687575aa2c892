// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/plugin_setting.h"

namespace lapwing {
namespace {

Vehicle consumer_drone() {
  Vehicle vehicle = camera_drone();
  vehicle.has_rotors = false;
  vehicle.jerk_max = 9;
  return vehicle;
}

TEST(Velocity, RampsAndTurnsByItsInputs) {
  const auto model = plugins().create<VehicleModel>("velocity");
  model->bind(consumer_drone());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(15), next(10);
  x(4) = 1;     // m/s
  x(7) = 0.5;   // m/s^2
  x(10) = 6;    // m/s^3
  x(13) = 0.3;  // rad/s
  x(14) = 0.5;  // s
  Workspace workspace;
  model->flow({0, 1}, x.data(), next.data(), nullptr, workspace);
  EXPECT_NEAR(next(0), 0.5 + 0.0625 + 0.125, 1e-15);
  EXPECT_NEAR(next(4), 1 + 0.25 + 0.75, 1e-15);
  EXPECT_NEAR(next(7), 0.5 + 3, 1e-15);
  EXPECT_NEAR(next(3), 0.15, 1e-15);
}

TEST(Velocity, AnyJerkWithinItsBoundsIsWithinTheLimit) {
  const auto model = plugins().create<VehicleModel>("velocity");
  model->bind(consumer_drone());
  std::vector<double> lower(14), upper(14);
  model->bounds(lower.data(), upper.data());
  EXPECT_LT(Eigen::Vector3d(upper[10], upper[11], upper[12]).norm(), 9);
  EXPECT_GT(Eigen::Vector3d(upper[10], upper[11], upper[12]).norm(), 8.8);
  EXPECT_EQ(lower[10], -upper[10]);
  EXPECT_NEAR(upper[13], 0.98 * camera_drone().yaw_rate_max, 1e-15);
}

TEST(Velocity, NamesItsMotion) {
  const auto model = plugins().create<VehicleModel>("velocity");
  model->bind(consumer_drone());
  Trajectory trajectory;
  model->describe(trajectory);
  EXPECT_EQ(trajectory.motion.name, "velocity");
  ASSERT_EQ(trajectory.motion.columns.size(), 1u);
  EXPECT_EQ(trajectory.motion.columns[0].name, "jerk");
  EXPECT_EQ(trajectory.motion.columns[0].unit, "m/s^3");
  EXPECT_EQ(trajectory.motion.tracked, Tracking::acceleration);
  EXPECT_TRUE(model->rests());
}

TEST(Velocity, QuadrotorRefusesAVehicleWithoutRotors) {
  const auto model = plugins().create<VehicleModel>("quadrotor");
  EXPECT_THROW(model->bind(consumer_drone()), InputError);
}

}  // namespace
}  // namespace lapwing
