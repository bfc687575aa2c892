// SPDX-License-Identifier: Apache-2.0
// boundary_state and hard_keyframe: bounds by hand, and flights that keep them.
#include "framework/core/random.h"
#include "framework/solve/trajectory_solver.h"
#include "tests/plugins/plugin_setting.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Order: position[3] yaw velocity[3] yaw_rate force[3] yaw_torque.
std::pair<std::vector<double>, std::vector<double>> bounds_at(const BoundConstraint& bound,
                                                              int instance) {
  std::vector<double> lower(bound.shape.rows), upper(bound.shape.rows);
  bound.constraint->bounds({instance, 1}, lower.data(), upper.data());
  return {lower, upper};
}

TEST(BoundaryState, RestsAtBothEndsByDefault) {
  const BoundConstraint bound("boundary_state", map_of({}), camera_drone());
  EXPECT_EQ(bound.shape.stages, (std::vector<int>{0, 5}));
  EXPECT_TRUE(bound.shape.identity);
  for (int end = 0; end < 2; ++end) {
    const auto [lower, upper] = bounds_at(bound, end);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(lower[i], -kInfinity) << "position and yaw are free";
    for (int i = 4; i < 12; ++i) {
      EXPECT_EQ(lower[i], i == 10 ? 1.5 * kGravity : 0.0);
      EXPECT_EQ(upper[i], lower[i]);
    }
  }
}

TEST(BoundaryState, MovesOrIsFree) {
  const BoundConstraint bound("boundary_state",
                              map_of({{"start", "moving"},
                                      {"start_velocity", list_of({1, 2, 0.5})},
                                      {"finish", "free"},
                                      {"finish_position", list_of({7, 8, 9})},
                                      {"finish_yaw", "90 deg"}}),
                              camera_drone());
  const auto [lower, upper] = bounds_at(bound, 0);
  EXPECT_EQ(lower[4], 1.0);
  EXPECT_EQ(upper[5], 2.0);
  EXPECT_EQ(lower[7], -kInfinity) << "the yaw rate is free while moving";
  EXPECT_EQ(upper[10], kInfinity);
  const auto [last_lower, last_upper] = bounds_at(bound, 1);
  EXPECT_EQ(last_lower[2], 9.0);
  EXPECT_EQ(last_upper[2], 9.0);
  EXPECT_NEAR(last_lower[3], M_PI / 2, 1e-15);
  EXPECT_EQ(last_upper[4], kInfinity);
}

TEST(BoundaryState, RefusesContradictions) {
  const auto create = [](std::vector<std::pair<std::string, Value>> given) {
    BoundConstraint("boundary_state", map_of(std::move(given)), camera_drone());
  };
  expect_message([&] { create({{"start", "moving"}}); }, {"start = 'moving'", "start_velocity"});
  expect_message(
      [&] {
        create({{"finish_velocity", list_of({1, 0, 0})}});
      },
      {"finish_velocity", "'moving'", "'rest'"});
  expect_message([&] { create({{"start", "flying"}}); }, {"start", "rest"});
  expect_message(
      [&] {
        create({{"start", "moving"}, {"start_velocity", list_of({8, 8, 0})}});
      },
      {"start_velocity", "exceeds", "10"});
  expect_message(
      [&] {
        create({{"start", "moving"}, {"start_velocity", list_of({0, 0, -3})}});
      },
      {"start_velocity", "down"});
}

TEST(HardKeyframe, ThePolytopeLiesInsideTheTolerance) {
  const BoundConstraint ball(
      "hard_keyframe",
      map_of({{"tolerance", 0.5}, {"keyframes", moments({{0.25, {1, 2, 3}}, {0.1, {0, 0, 0}}})}}),
      camera_drone());
  EXPECT_EQ(ball.shape.times, (std::vector<double>{0.25, 0.1}));
  ASSERT_EQ(ball.shape.rows, 13);
  // How far one can go from the keyframe in any direction.
  const Eigen::Vector3d middle(1, 2, 3);
  const auto reach = [&](const Eigen::Vector3d& direction) {
    std::vector<double> at(13), ahead(13);
    Workspace workspace;
    const Eigen::Vector3d moved = middle + direction.normalized();
    ball.constraint->evaluate({0, 1}, middle.data(), at.data(), nullptr, workspace);
    ball.constraint->evaluate({0, 1}, moved.data(), ahead.data(), nullptr, workspace);
    double least = kInfinity;
    for (int r = 0; r < 13; ++r) {
      const double slope = ahead[r] - at[r];
      if (std::abs(slope) < 1e-12) continue;
      least = std::min(least, ((slope > 0 ? ball.upper[r] : ball.lower[r]) - at[r]) / slope);
    }
    return least;
  };
  const double r2 = std::sqrt(2.0), r3 = std::sqrt(3.0);
  EXPECT_NEAR(reach({1, r2 - 1, r3 - r2}), 0.5, 1e-12) << "a corner is as far as allowed";
  EXPECT_NEAR(reach({r2 - 1, r2 - r3, -1}), 0.5, 1e-12);
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const double distance = reach({random.normal(), random.normal(), random.normal()});
    EXPECT_LE(distance, 0.5 + 1e-12);
    EXPECT_GE(distance, 0.886 * 0.5);
  }
  const BoundConstraint yaw(
      "hard_keyframe",
      map_of({{"block", "yaw"}, {"tolerance", 0.1}, {"keyframes", moments({{0.2, {2}}})}}),
      camera_drone());
  EXPECT_NEAR(yaw.upper[0], 2.1, 1e-15);
  EXPECT_EQ(yaw.shape.row_names, std::vector<std::string>{"yaw"});
  const BoundConstraint exact("hard_keyframe", map_of({{"keyframes", moments({{0.2, {2, 3, 4}}})}}),
                              camera_drone());
  EXPECT_EQ(exact.lower, exact.upper);
}

TEST(HardKeyframe, RefusesWhatDoesNotFit) {
  expect_message(
      [] {
        BoundConstraint("hard_keyframe", map_of({{"keyframes", Value::list()}}), camera_drone());
      },
      {"keyframes", "at least one"});
  expect_message(
      [] {
        BoundConstraint("hard_keyframe",
                        map_of({{"tolerance", -1.0}, {"keyframes", moments({{0, {0, 0, 0}}})}}),
                        camera_drone());
      },
      {"tolerance", "at least 0"});
  expect_message(
      [] {
        BoundConstraint("hard_keyframe",
                        map_of({{"block", "yaw"}, {"keyframes", moments({{0, {0, 0, 0}}})}}),
                        camera_drone());
      },
      {"keyframe 1 has 3 numbers, block 'yaw' has 1"});
}

TrajectoryProblem shot(double tolerance, const std::vector<Moment>& keyframes, int stages) {
  TrajectoryProblem problem = flight(stages, 0.1);
  problem.add_cost("snap", 1e-3, plugins().create<CostTerm>("derivative"));
  problem.add_cost("effort", 0.1, plugins().create<CostTerm>("input_effort"));
  problem.add_constraint("input_limits", plugins().create<Constraint>("input_limits"));
  problem.add_constraint("state_limits", plugins().create<Constraint>("state_limits"));
  problem.add_constraint("boundary_state", plugins().create<Constraint>("boundary_state"));
  problem.add_constraint(
      "hard_keyframe",
      plugins().create<Constraint>(
          "hard_keyframe", map_of({{"tolerance", tolerance}, {"keyframes", moments(keyframes)}})));
  problem.set_path_guess({0}, {{0, 0, 2}}, {0});
  problem.finish();
  return problem;
}

TEST(Flight, KeepsItsHardKeyframesAndLimits) {
  const std::vector<Moment> keyframes{{0, {0, 0, 2}}, {3.33, {9, 2, 4}}, {8, {18, -3, 3}}};
  const TrajectoryProblem problem = shot(0.3, keyframes, 81);
  EXPECT_TRUE(problem.quadratic());
  const SolveResult result = plugins().create<TrajectorySolver>("iqp")->solve(problem, {});
  ASSERT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  // Between two stages, by the parabola of the held force.
  const Trajectory trajectory = problem.trajectory(result.point.stages);
  for (const Moment& keyframe : keyframes) {
    const int stage = std::min(static_cast<int>(keyframe.time / 0.1), 79);
    const Sample& sample = trajectory.samples[stage];
    const double h = keyframe.time - stage * 0.1;
    const Eigen::Vector3d there =
        sample.position + h * sample.velocity + 0.5 * h * h * sample.acceleration;
    EXPECT_LE((there - Eigen::Vector3d(keyframe.value.data())).norm(), 0.3 + 1e-6);
  }
  for (const Sample& sample : trajectory.samples) {
    EXPECT_LE(sample.velocity.head<2>().norm(), 10 + 1e-6);
    EXPECT_LE(sample.acceleration.head<2>().norm(), 4 + 1e-6);
  }
  EXPECT_NEAR(trajectory.samples.front().velocity.norm(), 0, 1e-6);
  EXPECT_NEAR(trajectory.samples.back().velocity.norm(), 0, 1e-6);
}

TEST(Flight, SaysWhatItCannotMeet) {
  const TrajectoryProblem problem = shot(0.1, {{0, {0, 0, 2}}, {1.0, {50, 0, 2}}}, 11);
  const SolveResult result = plugins().create<TrajectorySolver>("iqp")->solve(problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::infeasible) << result.report.message;
  ASSERT_FALSE(result.report.violations.empty());
  EXPECT_GT(result.report.violations.front().amount, 0.1);
  EXPECT_NE(result.report.violations.front().row.find(" at "), std::string::npos);
}

}  // namespace
}  // namespace lapwing
