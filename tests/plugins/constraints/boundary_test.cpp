// boundary_state and hard_keyframe: bounds by hand, and flights that keep them.
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
      {"start_velocity", "beyond", "10"});
  expect_message(
      [&] {
        create({{"start", "moving"}, {"start_velocity", list_of({0, 0, -3})}});
      },
      {"start_velocity", "down"});
}

TEST(HardKeyframe, TheBoxLiesInsideTheTolerance) {
  const BoundConstraint ball(
      "hard_keyframe",
      map_of({{"tolerance", 0.5}, {"keyframes", moments({{0.25, {1, 2, 3}}, {0.1, {0, 0, 0}}})}}),
      camera_drone());
  EXPECT_EQ(ball.shape.times, (std::vector<double>{0.25, 0.1}));
  const Eigen::Map<const Eigen::Vector3d> lower(ball.lower.data()), upper(ball.upper.data());
  EXPECT_NEAR(((upper - lower) / 2).norm(), 0.5, 1e-12) << "the corner is as far as allowed";
  EXPECT_NEAR(((upper + lower) / 2 - Eigen::Vector3d(1, 2, 3)).norm(), 0.0, 1e-12);
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
