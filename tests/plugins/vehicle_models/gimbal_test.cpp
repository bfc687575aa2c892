// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/trajectory_solver.h"
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

TrajectoryProblem filming(const Vehicle& vehicle, int stages = 21) {
  TrajectoryProblem problem = flight(stages, 0.1, vehicle);
  problem.add_model("gimbal", plugins().create<VehicleModel>("gimbal"));
  return problem;
}

void add(TrajectoryProblem& problem, const char* name, double weight, const Value& parameters) {
  problem.add_cost(name, weight, plugins().create<CostTerm>(name, parameters));
}

TEST(Gimbal, TurnsByItsRates) {
  const auto model = plugins().create<VehicleModel>("gimbal");
  model->bind(gimbal_drone());
  const double x[] = {0.3, -0.5, 1.0, -0.4, 0.25};  // yaw pitch rates step
  double next[2];
  Workspace workspace;
  model->flow({0, 1}, x, next, nullptr, workspace);
  EXPECT_NEAR(next[0], 0.3 + 0.25, 1e-15);
  EXPECT_NEAR(next[1], -0.5 - 0.1, 1e-15);
}

TEST(Gimbal, BoundsAreTheVehicles) {
  const auto model = plugins().create<VehicleModel>("gimbal");
  model->bind(gimbal_drone());
  std::vector<double> lower(4), upper(4);
  model->bounds(lower.data(), upper.data());
  EXPECT_EQ(lower, (std::vector{-3.0, -1.6, -2.0, -1.5}));
  EXPECT_EQ(upper, (std::vector{3.0, 0.5, 2.0, 1.5}));
}

TEST(Gimbal, RefusesAVehicleWithoutOne) {
  expect_message([] { filming(camera_drone()); }, {"vehicle 'drone' has no gimbal"});
}

TEST(Gimbal, FillsItsPartOfASampleAlone) {
  const TrajectoryProblem problem = [] {
    TrajectoryProblem p = filming(gimbal_drone(), 5);
    p.add_block({.name = "target", .size = 3});
    p.set_block_guess("gimbal_pitch", {0.0}, {Eigen::VectorXd::Constant(1, -0.7)});
    p.finish();
    return p;
  }();
  Stages at = problem.initial_guess();
  at.row(offset_of(problem, "gimbal_yaw")).setConstant(0.25);
  at.row(offset_of(problem, "gimbal_yaw_rate")).setConstant(0.5);
  at.row(offset_of(problem, "gimbal_pitch_rate")).setConstant(-0.125);
  at.row(offset_of(problem, "position")).setConstant(7.0);
  const Trajectory trajectory = problem.trajectory(at);
  EXPECT_TRUE(trajectory.has_gimbal);
  EXPECT_EQ(trajectory.motion.name, "force");
  const Sample& sample = trajectory.samples[2];
  EXPECT_EQ(sample.gimbal_yaw, 0.25);
  EXPECT_EQ(sample.gimbal_pitch, -0.7);
  EXPECT_EQ(sample.gimbal_yaw_rate, 0.5);
  EXPECT_EQ(sample.gimbal_pitch_rate, -0.125);
  EXPECT_EQ(sample.position.x(), 7.0);
}

// Asks for pitches beyond angle and rate, with keyframes on the gimbal's blocks.
std::vector<Sample> turned(const Vehicle& vehicle) {
  TrajectoryProblem problem = filming(vehicle);
  add(problem, "keyframe", 1, map_of({{"keyframes", moments({{0, {0, 0, 5}}})}}));
  problem.add_cost("pitch", 10,
                   plugins().create<CostTerm>(
                       "keyframe", map_of({{"block", "gimbal_pitch"},
                                           {"keyframes", moments({{0, {0.2}}, {2, {-3.0}}})}})));
  add(problem, "gimbal_derivative", 1e-3, map_of({}));
  problem.add_cost("snap", 1e-3, plugins().create<CostTerm>("derivative"));
  add(problem, "yaw_derivative", 1e-3, map_of({}));
  add(problem, "input_effort", 1e-2, map_of({}));
  problem.finish();
  EXPECT_TRUE(problem.quadratic());
  const auto solver = plugins().create<TrajectorySolver>("iqp");
  const SolveResult result = solver->solve(problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  return problem.trajectory(result.point.stages).samples;
}

TEST(Gimbal, ComposesWithTheQuadrotorAndKeepsItsLimits) {
  const std::vector<Sample> samples = turned(gimbal_drone());
  EXPECT_NEAR(samples.back().gimbal_pitch, -1.6, 1e-4) << "the limit, not -3";
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    EXPECT_LE(std::abs(samples[i].gimbal_pitch_rate), 1.5 * (1 + 1e-4));
    EXPECT_NEAR(samples[i + 1].gimbal_pitch,
                samples[i].gimbal_pitch + 0.1 * samples[i].gimbal_pitch_rate, 1e-7);
  }
}

TEST(Gimbal, AnAxisWithoutARangeStaysWhereItIs) {
  Vehicle vehicle = gimbal_drone();
  vehicle.gimbal = GimbalLimits{0.25, 0.25, -1.6, 0.5, 0.0, 1.5};
  for (const Sample& sample : turned(vehicle)) {
    EXPECT_NEAR(sample.gimbal_yaw, 0.25, 1e-6);
    EXPECT_NEAR(sample.gimbal_yaw_rate, 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace lapwing
