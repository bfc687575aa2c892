// SPDX-License-Identifier: Apache-2.0
// The shipped racer has the figures that its file says were published; where LAPWING_DATA holds the
// publication's own file, another test compares with that.
#include <gtest/gtest.h>

#include "framework/config/yaml.h"
#include "tests/vehicle/vehicle_fixture.h"

namespace lapwing {
namespace {

TEST(RacerFigures, AreThoseOfTheSourceThatItNames) {
  const std::filesystem::path configs = LAPWING_SOURCE_DIR "/configs";
  const Parameters table = check(vehicle_table(), read_yaml(configs / "vehicles/racer.yaml"));
  const Value camera = read_yaml(configs / (table.text("camera") + ".yaml"));
  const Vehicle racer = vehicle_from(table, check(camera_table(), camera), "racer");
  EXPECT_EQ(racer.mass, 0.85);
  EXPECT_EQ(racer.inertia, Eigen::Vector3d(0.001, 0.001, 0.0017));
  EXPECT_EQ(racer.rotors.arm_length, 0.15);
  EXPECT_EQ(racer.rotors.torque_coefficient, 0.05);
  EXPECT_EQ(racer.rotors.thrust_min, 0);
  EXPECT_EQ(racer.rotors.thrust_max, 6.879);
  EXPECT_NEAR(racer.yaw_rate_max, 3, 1e-4);
}

}  // namespace
}  // namespace lapwing
