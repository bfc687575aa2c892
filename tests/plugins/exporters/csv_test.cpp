// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "framework/export/exporter.h"
#include "framework/plugin/registry.h"

namespace lapwing {
namespace {

std::unique_ptr<Exporter> csv() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry.create<Exporter>("csv");
}

std::vector<std::vector<std::string>> cells(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

Plan two_samples(const MotionRecord& motion) {
  Plan plan;
  plan.trajectory.motion = motion;
  plan.trajectory.samples.resize(2);
  Sample& s = plan.trajectory.samples[1];
  s.time = 0.1;
  s.position = {1.0 / 3, -2e-17, 12345.678};
  s.columns.set("force", Eigen::Vector3d(0.1 + 0.2, 0, 14.7));
  s.target = {7, 8, 9};
  return plan;
}

TEST(Csv, HeaderNamesColumnsAndUnits) {
  const auto rows = cells(csv()->write(two_samples(force_motion())));
  const std::vector<std::string> header{"time [s]",
                                        "position_x [m]",
                                        "position_y [m]",
                                        "position_z [m]",
                                        "velocity_x [m/s]",
                                        "velocity_y [m/s]",
                                        "velocity_z [m/s]",
                                        "acceleration_x [m/s^2]",
                                        "acceleration_y [m/s^2]",
                                        "acceleration_z [m/s^2]",
                                        "yaw [rad]",
                                        "yaw_rate [rad/s]",
                                        "force_x [N]",
                                        "force_y [N]",
                                        "force_z [N]",
                                        "yaw_torque [N m]"};
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0], header);
  EXPECT_EQ(rows[2].size(), header.size());
}

TEST(Csv, NumbersReadBackExactly) {
  const auto rows = cells(csv()->write(two_samples(force_motion())));
  EXPECT_EQ(std::stod(rows[2][1]), 1.0 / 3);
  EXPECT_EQ(std::stod(rows[2][2]), -2e-17);
  EXPECT_EQ(std::stod(rows[2][3]), 12345.678);
  EXPECT_EQ(std::stod(rows[2][12]), 0.1 + 0.2);
}

TEST(Csv, OnlyColumnsThatThePlanHas) {
  const auto header = [](const Plan& plan) {
    const std::string text = csv()->write(plan);
    return text.substr(0, text.find('\n'));
  };
  Plan path = two_samples(path_motion());
  EXPECT_EQ(header(path), "time [s],position_x [m],position_y [m],position_z [m],yaw [rad]");
  path.trajectory.has_target = true;
  EXPECT_NE(header(path).find("target_z [m]"), std::string::npos);
  const std::string rotors = header(two_samples(rotors_motion()));
  EXPECT_NE(rotors.find("orientation_w [1]"), std::string::npos);
  EXPECT_NE(rotors.find("rotor_thrust_4 [N]"), std::string::npos);
  EXPECT_EQ(rotors.find("force_x"), std::string::npos);
  Plan gimbal = two_samples(force_motion());
  EXPECT_EQ(header(gimbal).find("gimbal"), std::string::npos);
  gimbal.trajectory.has_gimbal = true;
  EXPECT_NE(header(gimbal).find("gimbal_pitch_rate [rad/s]"), std::string::npos);
}

TEST(Csv, SaysItsExtensionAndRefusesParameters) {
  EXPECT_EQ(csv()->file_extension(), ".csv");
  const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  Value given = Value::map();
  given.set("separator", ";");
  EXPECT_THROW(registry.create<Exporter>("csv", given), InputError);
}

}  // namespace
}  // namespace lapwing
