// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

// position[3] yaw gimbal_yaw gimbal_pitch target[3]
Eigen::VectorXd seen(const Eigen::Vector3d& position, double yaw, double gimbal_yaw, double pitch,
                     const Eigen::Vector3d& target) {
  Eigen::VectorXd x(9);
  x << position, yaw, gimbal_yaw, pitch, target;
  return x;
}

BoundCost camera_angle() {
  return BoundCost("camera_angle", map_of({}));
}

TEST(CameraAngle, IsTheAngleOfTheThesis) {
  const BoundCost term = camera_angle();
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  // Looking east: a target in the north-east at 45 degrees to the left, one below at 30 degrees.
  EXPECT_NEAR(term.values(seen(origin, 0, 0, 0, {5, 5, 0})).norm(), M_PI / 4, 1e-14);
  const Eigen::VectorXd left = term.values(seen(origin, 0, 0, 0, {5, 5, 0}));
  EXPECT_NEAR(left(0), -M_PI / 4, 1e-14) << "to the right is positive";
  const Eigen::VectorXd below = term.values(seen(origin, 0, 0, 0, {std::sqrt(3.0), 0, -1}));
  EXPECT_NEAR(below(1), M_PI / 6, 1e-14) << "downwards is positive";
  // Yaw and gimbal add up; pitch turns down by 30 degrees.
  EXPECT_NEAR(term.values(seen(origin, 0.5, -0.5, -M_PI / 6, {std::sqrt(3.0), 0, -1})).norm(), 0,
              1e-14);
  // Straight down from above, and the opposite.
  EXPECT_NEAR(term.values(seen({0, 0, 9}, 1.3, 0.2, -M_PI / 2, origin)).norm(), 0, 1e-14);
  EXPECT_NEAR(term.values(seen({0, 0, 9}, 1.3, 0.2, 0, origin)).norm(), M_PI / 2, 1e-14);
  EXPECT_NEAR(term.values(seen(origin, 0, 0, 0, {-5, 0.5, 0})).norm(), M_PI - std::atan(0.1),
              1e-13);
}

TEST(CameraAngle, EqualsTheFormulaEverywhereButNearTheTarget) {
  const BoundCost term = camera_angle();
  Random random(3);
  const auto draw = [&](double s) { return random.uniform(-s, s); };
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d p(draw(20), draw(20), draw(20)), t(draw(20), draw(20), draw(20));
    const double yaw = draw(7), gimbal = draw(3), pitch = draw(1.5);
    const Eigen::Vector3d p1(std::cos(pitch) * std::cos(yaw + gimbal),
                             std::cos(pitch) * std::sin(yaw + gimbal), std::sin(pitch));
    const double angle = std::atan2((t - p).cross(p1).norm(), (t - p).dot(p1));
    EXPECT_NEAR(term.values(seen(p, yaw, gimbal, pitch, t)).norm(), angle,
                angle > M_PI - 0.01 ? 0.01 : 1e-12);
  }
}

TEST(CameraAngle, DerivativesHoldWhereverTheCameraLooks) {
  const BoundCost term = camera_angle();
  const Eigen::Vector3d o = Eigen::Vector3d::Zero();
  const double down = -M_PI / 2;
  term.expect_derivatives(seen({1, 2, 3}, 0.4, -0.2, -0.7, {6, -4, 0}), "somewhere");
  term.expect_derivatives(seen(o, 0, 0, 0, {7, 0, 0}), "no error");
  term.expect_derivatives(seen(o, 0.3, 0.4, 0, {7 * std::cos(0.709), 7 * std::sin(0.709), 0}),
                          "where the series ends");
  term.expect_derivatives(seen({0, 0, 12}, 0.4, 0, down, o), "straight above, looking down");
  term.expect_derivatives(seen({0, 0, 12}, 0.4, 0, 0, o), "straight above, looking ahead");
  term.expect_derivatives(seen({0.3, 0, 12}, 0.4, 0, -0.4, o), "nearly above");
  term.expect_derivatives(seen(o, 3.1, 0.1, -0.2, {-8, -0.2, -1}), "yaw across pi");
  term.expect_derivatives(seen(o, -9.5, 0.1, -0.2, {-8, -0.2, -1}), "yaw turned many times");
  term.expect_derivatives(seen(o, 0, 0, 0, {-5, 1, 0.5}), "behind");
  term.expect_derivatives(seen(o, 0, 0, 0, {-5, 0.2, -0.1}), "nearly straight behind", 0, 1e-6,
                          1e-5);
  term.expect_derivatives(seen(o, 0.2, 0, -0.3, {0.15, 0, 0}), "near", 0, 1e-6, 1e-5);
  term.expect_derivatives(seen(o, 0.2, 0, -0.3, {0.04, 0.02, 0}), "too near", 0, 1e-6, 1e-5);
}

TEST(CameraAngle, IsFiniteAtTheTargetAndStraightBehind) {
  const BoundCost term = camera_angle();
  const Eigen::Vector3d o(1, 2, 3);
  const Eigen::VectorXd at_target = seen(o, 0.2, 0, -0.3, o);
  term.expect_finite(at_target, "at the target");
  EXPECT_EQ(term.values(at_target).norm(), 0);
  EXPECT_EQ(term.jacobian(at_target).norm(), 0);
  for (const double distance : {1e-12, 1e-7, 1e-3, 0.05, 0.1})
    term.expect_finite(seen(o, 0.2, 0, -0.3, o + Eigen::Vector3d(distance, 0, 0)), "near");

  const Eigen::VectorXd behind = seen({0, 0, 0}, 0, 0, 0, {-5, 0, 0});
  term.expect_finite(behind, "straight behind");
  EXPECT_NEAR(term.values(behind).norm(), M_PI, 1e-12);
  const Eigen::VectorXd gradient = term.jacobian(behind).transpose() * term.values(behind);
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 100);
  for (const int way : {3, 4, 5})  // yaw, gimbal_yaw, gimbal_pitch
    EXPECT_GT(std::abs(gradient(way)), 1.0) << "a step must lead out of it";
  const Eigen::VectorXd out = behind - 0.1 * gradient.normalized();
  EXPECT_LT(term.values(out).norm(), M_PI - 0.05);
}

TEST(CameraAngle, IsAnIntegralThatLeavesCutsOut) {
  const auto cost = [](int stages, const Value& parameters) {
    TrajectoryProblem problem = flight(stages, 2.0 / (stages - 1), gimbal_drone());
    problem.add_model("gimbal", plugins().create<VehicleModel>("gimbal"));
    problem.add_block({.name = "target", .size = 3});
    problem.set_block_guess("target", {0}, {Eigen::Vector3d(0, 4, 0)});
    problem.add_cost("camera_angle", 3.0, plugins().create<CostTerm>("camera_angle", parameters));
    problem.finish();
    return problem.cost(problem.initial_guess());
  };
  const double whole = 3.0 * 2.0 * std::pow(M_PI / 2, 2);
  EXPECT_NEAR(cost(2001, map_of({})), whole, 0.002 * whole);
  EXPECT_NEAR(cost(201, map_of({})), whole, 0.02 * whole);
  const Value cut = map_of({{"except", spans_of({{0.5, 1.0}})}});
  EXPECT_NEAR(cost(2001, cut), 0.75 * whole, 0.002 * whole);
  EXPECT_EQ(cost(201, map_of({{"except", spans_of({{0, 2}})}})), 0.0) << "nothing is left";
}

TEST(CameraAngle, RefusesWhatDoesNotFit) {
  const auto bound = [](const Value& parameters) { BoundCost("camera_angle", parameters); };
  expect_message(
      [&] {
        bound(map_of({{"except", spans_of({{2, 1}})}}));
      },
      {"except", "ends before it begins"});
  expect_message(
      [&] {
        bound(map_of({{"except", spans_of({{2, 3}})}}));
      },
      {"begins at 2", "after the end at 1"});
  TrajectoryProblem problem = flight(9, 0.1);
  problem.add_cost("camera_angle", 1.0, plugins().create<CostTerm>("camera_angle"));
  expect_message([&] { problem.finish(); }, {"camera_angle: no block 'gimbal_yaw'"});
}

}  // namespace
}  // namespace lapwing
