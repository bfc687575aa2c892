// SPDX-License-Identifier: Apache-2.0
// The rigid body: known motions, conservation, order of the integrator; and its rotors.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/core/units.h"
#include "framework/vehicle/rotor_allocation.h"
#include "framework/vehicle/rotor_body.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

TEST(RotorBody, MixesAsTheThesisWrites) {
  Eigen::Matrix4d expected;  // (3.11) over k_F, L = 0.3, k_M / k_F = 0.02
  expected << 1, 1, 1, 1, 0, 0.3, 0, -0.3, -0.3, 0, 0.3, 0, 0.02, -0.02, 0.02, -0.02;
  const Rotors rotors{.torque_coefficient = 0.02, .arm_length = 0.3};
  EXPECT_LT((mixer_of(rotors) - expected).norm(), 1e-15);
  // Diagonal arms: the same turned by 45 degrees; a front left rotor lifts left and front.
  const Rotors diagonal{.torque_coefficient = 0.02, .arm_length = 0.3, .diagonal = true};
  EXPECT_NEAR(mixer_of(diagonal)(1, 0), 0.3 * std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(mixer_of(diagonal)(2, 0), -0.3 * std::sqrt(0.5), 1e-15);
}

TEST(RotorBody, FallsFreely) {
  Vehicle vehicle = reference_vehicle();
  vehicle.rotors.thrust_min = 0;
  const RotorBody body(vehicle);
  BodyState state;
  state.velocity = {1, 2, 3};
  for (int k = 0; k < 100; ++k) state = body.after(state, Vector4d::Zero(), Vector3d::Zero(), 0.01);
  EXPECT_LT((state.position - Vector3d(1, 2, 3 - kGravity / 2)).norm(), 1e-12);
}

TEST(RotorBody, HoversInStillAirAndDriftsWithTheWind) {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.5;
  const RotorBody body(vehicle);
  const Vector4d hover = Vector4d::Constant(vehicle.mass * kGravity / 4);
  BodyState still, blown;
  still.rotor_thrusts = blown.rotor_thrusts = hover;
  for (int k = 0; k < 300; ++k) {
    still = body.after(still, hover, Vector3d::Zero(), 0.01);
    blown = body.after(blown, hover, {4, 0, 0}, 0.01);
  }
  EXPECT_LT(still.position.norm() + still.velocity.norm(), 1e-12);
  const double rate = vehicle.drag / vehicle.mass;  // v = w (1 - exp(-d t / m))
  EXPECT_NEAR(blown.velocity.x(), 4 * (1 - std::exp(-3 * rate)), 1e-9);
}

TEST(RotorBody, ThrustFollowsItsCommandWithTheLag) {
  Vehicle vehicle = reference_vehicle();
  vehicle.rotors.lag = 0.05;
  const RotorBody body(vehicle);
  BodyState state;
  for (int k = 0; k < 50; ++k)
    state = body.after(state, Vector4d::Constant(2), Vector3d::Zero(), 0.001);
  EXPECT_NEAR(state.rotor_thrusts(0), 2 * (1 - std::exp(-1)), 1e-9);
}

// However short the lag is against the step.
TEST(RotorBody, QuickMotorsAreNoTrouble) {
  Vehicle vehicle = reference_vehicle();
  const Vector4d hover = Vector4d::Constant(vehicle.mass * kGravity / 4);
  for (const double lag : {1e-12, 3e-4, 5e-4, 1e-3}) {
    vehicle.rotors.lag = lag;
    const RotorBody body(vehicle);
    BodyState state;
    for (int k = 0; k < 500; ++k) state = body.after(state, hover, Vector3d::Zero(), 0.002);
    EXPECT_LT((state.rotor_thrusts - hover).norm(), 1e-12) << lag;
    EXPECT_LT(state.position.norm(), 0.02) << lag;
  }
}

// Without moments a tumbling body keeps its angular momentum and its energy of rotation.
BodyState tumbled(const Vehicle& vehicle, int steps) {
  const RotorBody body(vehicle);
  BodyState state;
  state.body_rates = {3, 0.2, -2};
  for (int k = 0; k < steps; ++k)
    state = body.after(state, Vector4d::Zero(), Vector3d::Zero(), 2.0 / steps);
  return state;
}

TEST(RotorBody, TumblingKeepsMomentumAndEnergy) {
  Vehicle vehicle = reference_vehicle();
  vehicle.inertia = {0.01, 0.02, 0.025};
  BodyState start;
  start.body_rates = {3, 0.2, -2};
  const auto momentum = [&](const BodyState& s) -> Vector3d {
    return s.orientation * vehicle.inertia.cwiseProduct(s.body_rates);
  };
  const auto energy = [&](const BodyState& s) {
    return s.body_rates.dot(vehicle.inertia.cwiseProduct(s.body_rates)) / 2;
  };
  const BodyState end = tumbled(vehicle, 2000);
  EXPECT_LT((momentum(end) - momentum(start)).norm(), 1e-10 * momentum(start).norm());
  EXPECT_NEAR(energy(end), energy(start), 1e-10 * energy(start));
  EXPECT_GT(end.orientation.angularDistance(start.orientation), 0.1);
}

TEST(RotorBody, ErrorsFallWithTheFourthPowerOfTheStep) {
  Vehicle vehicle = reference_vehicle();
  vehicle.inertia = {0.01, 0.02, 0.025};
  const BodyState exact = tumbled(vehicle, 4000);
  const double coarse = tumbled(vehicle, 40).orientation.angularDistance(exact.orientation);
  const double fine = tumbled(vehicle, 80).orientation.angularDistance(exact.orientation);
  EXPECT_GT(coarse, 1e-7);
  EXPECT_GT(coarse / fine, 12);
  EXPECT_LT(coarse / fine, 22);
}

TEST(RotorAllocation, GivesWhatIsAskedWhereRotorsCan) {
  const Vehicle vehicle = reference_vehicle();
  const RotorAllocation allocate(vehicle);
  const Eigen::Matrix4d mixer = mixer_of(vehicle.rotors);
  Random random(3);
  for (int n = 0; n < 1000; ++n) {
    Vector4d thrusts;
    for (int i = 0; i < 4; ++i)
      thrusts(i) = random.uniform(vehicle.rotors.thrust_min, vehicle.rotors.thrust_max);
    const RotorCommand command = allocate(mixer * thrusts);
    EXPECT_LT((command.thrusts - thrusts).norm(), 1e-9);
    EXPECT_FALSE(command.saturated);
  }
}

TEST(RotorAllocation, KeepsTheDirectionOfThrustFirst) {
  const Vehicle vehicle = reference_vehicle();
  const RotorAllocation allocate(vehicle);
  const Eigen::Matrix4d mixer = mixer_of(vehicle.rotors);
  Random random(4);
  for (int n = 0; n < 1000; ++n) {
    const Vector4d wish(random.uniform(-10, 60), random.uniform(-3, 3), random.uniform(-3, 3),
                        random.uniform(-1, 1));
    const RotorCommand command = allocate(wish);
    EXPECT_GE(command.thrusts.minCoeff(), vehicle.rotors.thrust_min);
    EXPECT_LE(command.thrusts.maxCoeff(), vehicle.rotors.thrust_max);
    const Vector4d got = mixer * command.thrusts;
    if (!command.saturated) {
      EXPECT_LT((got - wish).norm(), 1e-9);
      continue;
    }
    // Roll and pitch in full, or in their proportion where rotors have no such difference.
    const double cross = got(1) * wish(2) - got(2) * wish(1);
    EXPECT_NEAR(cross, 0, 1e-9);
    const double spread = vehicle.rotors.thrust_max - vehicle.rotors.thrust_min;
    const double roll_pitch = (std::abs(wish(1)) + std::abs(wish(2))) / 2 /
                              (vehicle.rotors.arm_length);  // largest difference, arms on the axes
    if (roll_pitch < spread / 2) {
      EXPECT_NEAR(got(1), wish(1), 1e-9);
    }
    if (std::abs(got(3) - wish(3)) > 1e-9) {  // yaw gives way: no rotor has room for more of it
      const double side = wish(3) > got(3) ? 1 : -1;
      double room = 1e9;
      for (int i = 0; i < 4; ++i) {
        const bool faster = (i % 2 == 0) == (side > 0);
        room = std::min(room, faster ? vehicle.rotors.thrust_max - command.thrusts(i)
                                     : command.thrusts(i) - vehicle.rotors.thrust_min);
      }
      EXPECT_NEAR(room, 0, 1e-9);
    }
  }
}

}  // namespace
}  // namespace lapwing
