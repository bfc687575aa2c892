// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"
#include "tests/plugins/plugin_setting.h"

namespace lapwing {
namespace {

// velocity[3], yaw_rate, force[3], position[3] where the constraint reads it.
std::vector<double> flying(const Eigen::Vector3d& velocity, double yaw_rate,
                           const Eigen::Vector3d& acceleration) {
  const Eigen::Vector3d force = 1.5 * (acceleration + kGravity * Eigen::Vector3d::UnitZ());
  return {velocity.x(), velocity.y(), velocity.z(), yaw_rate, force.x(), force.y(), force.z()};
}

Eigen::Vector3d across(double length, double angle) {
  return {length * std::cos(angle), length * std::sin(angle), 0};
}

TEST(StateLimits, PolygonsLieInsideTheCircleAndLoseLittle) {
  Random random(1);
  for (const int sides : {4, 6, 16, 64}) {
    const BoundConstraint limits("state_limits", map_of({{"sides", sides}}), camera_drone());
    EXPECT_TRUE(limits.shape.affine);
    const double kept = std::cos(M_PI / sides);
    for (int k = 0; k < 500; ++k) {
      const double angle = random.uniform(0, 2 * M_PI);
      const Eigen::Vector3d none = Eigen::Vector3d::Zero();
      EXPECT_FALSE(limits.allows(flying(across(10.000001, angle), 0, none)));
      EXPECT_TRUE(limits.allows(flying(across(kept * 9.999999, angle), 0, none)));
      EXPECT_FALSE(limits.allows(flying(none, 0, across(4.000001, angle))));
      EXPECT_TRUE(limits.allows(flying(none, 0, across(kept * 3.999999, angle))));
    }
  }
}

TEST(StateLimits, HoldsClimbDescentYawRateAndVerticalAcceleration) {
  Vehicle vehicle = camera_drone();
  vehicle.acceleration_up_max = 3;
  vehicle.acceleration_down_max = 2;
  const BoundConstraint limits("state_limits", map_of({}), vehicle);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero(), up = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(limits.allows(flying(2.49 * up, 1.49, 2.99 * up)));
  EXPECT_TRUE(limits.allows(flying(-1.99 * up, -1.49, -1.99 * up)));
  EXPECT_FALSE(limits.allows(flying(2.51 * up, 0, none)));
  EXPECT_FALSE(limits.allows(flying(-2.01 * up, 0, none)));
  EXPECT_FALSE(limits.allows(flying(none, 1.51, none)));
  EXPECT_FALSE(limits.allows(flying(none, -1.51, none)));
  EXPECT_FALSE(limits.allows(flying(none, 0, 3.01 * up)));
  EXPECT_FALSE(limits.allows(flying(none, 0, -2.01 * up)));
}

TEST(StateLimits, ParametersTightenAndNeverLoosen) {
  const BoundConstraint slow("state_limits",
                             map_of({{"speed_across", 3.0},
                                     {"climb_speed", 1.0},
                                     {"descent_speed", 0.5},
                                     {"yaw_rate", 0.2},
                                     {"acceleration_across", 1.0}}),
                             camera_drone());
  const Eigen::Vector3d none = Eigen::Vector3d::Zero(), up = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(slow.allows(flying(across(2.9, 0.1), 0.19, across(0.97, 1))));
  EXPECT_FALSE(slow.allows(flying(across(3.01, 0.1), 0, none)));
  EXPECT_FALSE(slow.allows(flying(1.01 * up, 0, none)));
  EXPECT_FALSE(slow.allows(flying(-0.51 * up, 0, none)));
  EXPECT_FALSE(slow.allows(flying(none, 0.21, none)));
  EXPECT_FALSE(slow.allows(flying(none, 0, across(1.01, 1))));
  for (const char* name :
       {"speed_across", "climb_speed", "descent_speed", "yaw_rate", "acceleration_across"})
    expect_message(
        [&] {
          BoundConstraint("state_limits", map_of({{name, 20.0}}), camera_drone());
        },
        {name, "20", "exceeds the limit of the vehicle"});
  const Value in_other_units = map_of({{"speed_across", "18 km/h"}});
  const BoundConstraint kilometres("state_limits", in_other_units, camera_drone());
  EXPECT_NEAR(kilometres.upper[0], 5 * std::cos(M_PI / 16), 1e-12);
}

TEST(StateLimits, KeepsInsideABox) {
  const BoundConstraint boxed("state_limits", map_of({{"lower", list_of({-5, -5, 0})}}),
                              camera_drone());
  std::vector<double> state = flying(Eigen::Vector3d::Zero(), 0, Eigen::Vector3d::Zero());
  state.insert(state.end(), {100, 0, 0.1});
  EXPECT_TRUE(boxed.allows(state)) << "no upper corner was given";
  state.back() = -0.1;
  EXPECT_FALSE(boxed.allows(state));
  EXPECT_EQ(boxed.shape.row_names.back(), "position.z");
  expect_message(
      [] {
        BoundConstraint("state_limits",
                        map_of({{"lower", list_of({0, 0, 5})}, {"upper", list_of({9, 9, 4})}}),
                        camera_drone());
      },
      {"lower and upper", "in z"});
  expect_message(
      [] {
        BoundConstraint("state_limits", map_of({{"sides", 7}}), camera_drone());
      },
      {"sides", "even", "7"});
  expect_message(
      [] {
        BoundConstraint("state_limits", map_of({{"sides", 2}}), camera_drone());
      },
      {"sides", "between 4 and 64"});
}

}  // namespace
}  // namespace lapwing
