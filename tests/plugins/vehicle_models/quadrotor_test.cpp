// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/plugin_setting.h"

namespace lapwing {
namespace {

std::unique_ptr<VehicleModel> bound_quadrotor() {
  auto model = plugins().create<VehicleModel>("quadrotor");
  model->bind(camera_drone());
  return model;
}

// position[3] yaw velocity[3] yaw_rate force[3] yaw_torque step
Eigen::VectorXd next(const VehicleModel& model, const Eigen::VectorXd& arguments) {
  Eigen::VectorXd result(8);
  Workspace workspace;
  model.flow({0, 1}, arguments.data(), result.data(), nullptr, workspace);
  return result;
}

Eigen::VectorXd at_rest(double step) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(13);
  x(12) = step;
  return x;
}

TEST(Quadrotor, FallsHoversAndTurns) {
  const auto model = bound_quadrotor();
  const Eigen::VectorXd fall = next(*model, at_rest(0.5));
  EXPECT_NEAR(fall(2), -0.5 * kGravity * 0.25, 1e-15);
  EXPECT_NEAR(fall(6), -kGravity * 0.5, 1e-15);

  Eigen::VectorXd hover = at_rest(0.5);
  hover(10) = 1.5 * kGravity;
  EXPECT_NEAR(next(*model, hover).norm(), 0.0, 1e-15);

  Eigen::VectorXd turn = hover;
  turn(7) = 0.3;
  turn(11) = 0.05;  // N m on 0.025 kg m^2: 2 rad/s^2
  EXPECT_NEAR(next(*model, turn)(3), 0.3 * 0.5 + 0.25, 1e-15);
  EXPECT_NEAR(next(*model, turn)(7), 0.3 + 1.0, 1e-15);
}

TEST(Quadrotor, EqualsAFineIntegrationOfItsEquations) {
  const auto model = bound_quadrotor();
  Eigen::VectorXd x(13);
  x << 1, 2, 3, 0.4, 5, -6, 7, -0.8, 3, -4, 20, 0.03, 0.7;
  const Eigen::Vector4d acceleration(3 / 1.5, -4 / 1.5, 20 / 1.5 - kGravity, 0.03 / 0.025);
  Eigen::Vector4d place = x.head<4>(), rate = x.segment<4>(4);
  const int parts = 1000;
  for (int i = 0; i < parts; ++i) {  // the midpoint rule, exact for parabolas
    const double h = 0.7 / parts;
    place += h * (rate + 0.5 * h * acceleration);
    rate += h * acceleration;
  }
  const Eigen::VectorXd result = next(*model, x);
  EXPECT_NEAR((result.head<4>() - place).norm(), 0.0, 1e-12);
  EXPECT_NEAR((result.tail<4>() - rate).norm(), 0.0, 1e-12);
}

TEST(Quadrotor, TellsSamplesTheirAcceleration) {
  const auto model = bound_quadrotor();
  Eigen::VectorXd numbers(12);
  numbers << 1, 2, 3, 0.4, 5, -6, 7, -0.8, 3, -4, 20, 0.03;
  Sample sample;
  model->to_sample(numbers.data(), sample);
  EXPECT_NEAR(sample.acceleration.z(), 20 / 1.5 - kGravity, 1e-15);
  EXPECT_EQ(sample.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(sample.columns.scalar("yaw_torque"), 0.03);
  Trajectory trajectory;
  trajectory.inputs_held = false;
  model->describe(trajectory);
  EXPECT_TRUE(trajectory.inputs_held);
  EXPECT_EQ(trajectory.motion.name, "force");
}

}  // namespace
}  // namespace lapwing
