// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"
#include "tests/plugins/plugin_setting.h"

namespace lapwing {
namespace {

Vehicle random_vehicle(Random& random) {
  Vehicle vehicle = camera_drone();
  vehicle.mass = random.uniform(0.3, 5);
  const double hover = vehicle.mass * kGravity;
  vehicle.rotors.thrust_max = hover / 4 * random.uniform(1.4, 6);
  vehicle.rotors.thrust_min = hover / 4 * random.uniform(0, 0.2);
  vehicle.yaw_share = random.uniform(0, 0.25);
  vehicle.acceleration_across_max = random.uniform(0.5, 60);
  if (random.uniform() < 0.5) vehicle.acceleration_up_max = random.uniform(0.1, 30);
  if (random.uniform() < 0.5) vehicle.acceleration_down_max = random.uniform(0.1, 9);
  return vehicle;
}

// Every rotor within its limits for this force along the body's axis, with this yaw torque and no
// roll or pitch moment: the statement of 3.8.3, from the rotors themselves.
bool rotors_can(const Vehicle& vehicle, const Eigen::Vector3d& force, double torque) {
  const double share = std::abs(torque) / (4 * vehicle.rotors.torque_coefficient);
  const double high = force.norm() / 4 + share, low = force.norm() / 4 - share;
  return high <= vehicle.rotors.thrust_max * (1 + 1e-12) &&
         low >= vehicle.rotors.thrust_min - 1e-12 * vehicle.rotors.thrust_max;
}

void expect_within(const Vehicle& vehicle, const Eigen::Vector3d& force, double torque,
                   bool across) {
  EXPECT_TRUE(rotors_can(vehicle, force, torque)) << force.transpose() << ", " << torque;
  const double slack = 1 + 1e-12;
  if (across) {
    EXPECT_LE(force.head<2>().norm(), vehicle.mass * vehicle.acceleration_across_max * slack);
  }
  const double up = force.z() / vehicle.mass - kGravity;
  if (vehicle.acceleration_up_max) {
    EXPECT_LE(up, *vehicle.acceleration_up_max * slack);
  }
  if (vehicle.acceleration_down_max) {
    EXPECT_GE(up, -*vehicle.acceleration_down_max * slack);
  }
}

TEST(InputLimits, EveryCornerOfTheBoxIsWithinReach) {
  Random random(1);
  for (const char* across : {"inscribed", "extent"})
    for (int trial = 0; trial < 200; ++trial) {
      const Vehicle vehicle = random_vehicle(random);
      const BoundConstraint box("input_limits", map_of({{"across", across}, {"share", 1.0}}),
                                vehicle);
      EXPECT_TRUE(box.shape.identity && box.shape.affine);
      for (int corner = 0; corner < 16; ++corner) {
        double numbers[4];
        for (int i = 0; i < 4; ++i) numbers[i] = (corner >> i & 1 ? box.upper : box.lower)[i];
        expect_within(vehicle, Eigen::Vector3d(numbers), numbers[3],
                      std::string(across) == "inscribed");
      }
      EXPECT_TRUE(box.allows({0, 0, vehicle.mass * kGravity, 0})) << "hovering";
      EXPECT_GT(box.upper[0], 0);
    }
}

TEST(InputLimits, TheNormHoldsEverywhereAndReachesFurther) {
  Random random(2);
  int inside = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vehicle vehicle = random_vehicle(random);
    const BoundConstraint norm("input_limits", map_of({{"norm", true}, {"share", 1.0}}), vehicle);
    const BoundConstraint box("input_limits", map_of({{"share", 1.0}}), vehicle);
    for (int draw = 0; draw < 50; ++draw) {
      std::vector<double> inputs(4);
      for (int i = 0; i < 4; ++i) inputs[i] = random.uniform(norm.lower[i], norm.upper[i] + 1e-12);
      EXPECT_TRUE(norm.allows(inputs) || !box.allows(inputs)) << "the box lies inside";
      if (!norm.allows(inputs)) continue;
      ++inside;
      expect_within(vehicle, Eigen::Vector3d(inputs.data()), inputs[3], true);
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(InputLimits, IsTheBoxOfTheCameraDrone) {
  // By hand: u_max = 0.9 * 32, u_min = 0.1 * 32 + 0.8, torque = 0.2 * 2 * 0.016 * 8; along each
  // axis 1.5 * 4 / sqrt 2; upwards sqrt(28.8^2 - 2 * 4.2426^2).
  const BoundConstraint box("input_limits", map_of({{"share", 1.0}}), camera_drone());
  EXPECT_NEAR(box.upper[0], 4.242640687, 1e-8);
  EXPECT_NEAR(box.upper[2], std::sqrt(28.8 * 28.8 - 36), 1e-9);
  EXPECT_NEAR(box.lower[2], 4.0, 1e-12);
  EXPECT_NEAR(box.upper[3], 0.0512, 1e-12);
  EXPECT_EQ(box.shape.row_names[2], "force.z");
  const BoundConstraint extent("input_limits", map_of({{"share", 1.0}, {"across", "extent"}}),
                               camera_drone());
  EXPECT_NEAR(extent.upper[0], 6.0, 1e-12);
}

TEST(InputLimits, ShareShrinksTowardsHovering) {
  const double hover = 1.5 * kGravity;
  const BoundConstraint half("input_limits", map_of({{"share", 0.5}, {"norm", true}}),
                             camera_drone());
  EXPECT_NEAR(half.lower[2], hover + 0.5 * (4.0 - hover), 1e-12);
  EXPECT_NEAR(half.upper[2], hover + 0.5 * (28.8 - hover), 1e-12);
  EXPECT_NEAR(half.upper[0], 3.0, 1e-12);
  EXPECT_NEAR(half.upper[3], 0.0256, 1e-12);
}

TEST(InputLimits, SaysWhichFiguresConflict) {
  Vehicle weak = camera_drone();
  weak.rotors.thrust_max = 3.7;
  expect_message([&] { BoundConstraint("input_limits", map_of({}), weak); },
                 {"rotors.thrust", "yaw_share", "hovering", "mass 1.5"});
  Vehicle twisted = camera_drone();
  twisted.yaw_share = 1.0;
  expect_message([&] { BoundConstraint("input_limits", map_of({}), twisted); }, {"yaw_share"});
  expect_message(
      [] {
        BoundConstraint("input_limits", map_of({{"share", 0.0}}), camera_drone());
      },
      {"share", "above 0"});
  expect_message(
      [] {
        BoundConstraint("input_limits", map_of({{"share", 1.1}}), camera_drone());
      },
      {"share"});
}

}  // namespace
}  // namespace lapwing
