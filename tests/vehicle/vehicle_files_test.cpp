// SPDX-License-Identifier: Apache-2.0
// The vehicles that come with the project, read as a user's would be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/config/yaml.h"
#include "framework/core/files.h"
#include "framework/core/units.h"
#include "tests/vehicle/vehicle_fixture.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const fs::path kConfigs = fs::path(LAPWING_SOURCE_DIR) / "configs";

Vehicle shipped(const std::string& name) {
  const Parameters vehicle =
      check(vehicle_table(), read_yaml(kConfigs / "vehicles" / (name + ".yaml")));
  const Value camera = read_yaml(kConfigs / (vehicle.text("camera") + ".yaml"));
  return vehicle_from(vehicle, check(camera_table(), camera), name);
}

TEST(VehicleFiles, AllOfThemReadAndHoverAndNameACameraThatExists) {
  int count = 0, hovering = 0;
  for (const auto& entry : fs::directory_iterator(kConfigs / "vehicles")) {
    const Vehicle v = shipped(entry.path().stem().string());
    if (v.has_rotors) {
      const double weight = v.mass * kGravity;
      EXPECT_GT(weight, v.thrust_min()) << v.name;
      EXPECT_LT(weight, v.thrust_max()) << v.name;
      ++hovering;
    }
    EXPECT_FALSE(v.camera.name.empty());
    ++count;
  }
  EXPECT_GE(count, 4);
  EXPECT_GE(hovering, 2);
}

TEST(VehicleFiles, EveryCameraReads) {
  for (const auto& entry : fs::directory_iterator(kConfigs / "cameras")) {
    EXPECT_NO_THROW(check(camera_table(), read_yaml(entry.path()))) << entry.path();
  }
}

TEST(VehicleFiles, SoloHasItsStatedLimits) {
  const Vehicle v = shipped("solo");
  EXPECT_EQ(v.mass, 1.5);
  EXPECT_EQ(v.speed_across_max, 10);
  EXPECT_EQ(v.climb_speed_max, 2.5);
  EXPECT_EQ(v.descent_speed_max, 2);
  EXPECT_EQ(v.acceleration_across_max, 4);
  ASSERT_TRUE(v.gimbal);
  EXPECT_DOUBLE_EQ(degrees(v.gimbal->pitch_min), -90);
  EXPECT_DOUBLE_EQ(v.gimbal->pitch_max, 0);
  EXPECT_DOUBLE_EQ(degrees(v.gimbal->pitch_rate_max), 90);
  // The rotors allow what the limits promise: full acceleration across at a constant height.
  EXPECT_GT(v.thrust_max(), v.mass * std::hypot(kGravity, v.acceleration_across_max));
}

TEST(VehicleFiles, RacerHasThePublishedFigures) {
  const char* folder = std::getenv("LAPWING_DATA");
  const fs::path data =
      (folder ? fs::path(folder) : fs::path(LAPWING_SOURCE_DIR) / "../shared/data") /
      "tracks/race_quad.yaml";
  if (!fs::exists(data)) GTEST_SKIP() << "no data folder: " << data << " is absent";
  const Value published = read_yaml(data);
  const Vehicle v = shipped("racer");
  EXPECT_EQ(v.mass, published.at("mass").as_number());
  EXPECT_EQ(v.rotors.arm_length, published.at("arm_length").as_number());
  EXPECT_EQ(v.rotors.torque_coefficient, published.at("torque_coefficient").as_number());
  EXPECT_EQ(v.rotors.thrust_min, published.at("rotor_thrust").as_list()[0].as_number());
  EXPECT_EQ(v.rotors.thrust_max, published.at("rotor_thrust").as_list()[1].as_number());
  EXPECT_NEAR(v.yaw_rate_max, published.at("body_rate_limit").as_list()[2].as_number(), 1e-4);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(v.inertia[i],
              published.at("inertia").as_list()[static_cast<std::size_t>(i)].as_number());
  }
}

TEST(VehicleFiles, AContradictionNamesFileAndLine) {
  std::string text = read_file(kConfigs / "vehicles/solo.yaml");
  const std::string good = "thrust: [0.2, 8.0]";
  text.replace(text.find(good), good.size(), "thrust: [0.2, 3.0]");
  try {
    read_vehicle(from_yaml(text, "weak.yaml"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("cannot hover"));
    EXPECT_THAT(error.what(), testing::HasSubstr("weak.yaml:"));
  }
}

}  // namespace
}  // namespace lapwing
