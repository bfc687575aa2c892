// SPDX-License-Identifier: Apache-2.0
// Known values of the shipped cost terms.
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

// r = (t^2, -t, 3), yaw = t/2: constant acceleration, exact between stages.
Stages parabola(const TrajectoryProblem& problem) {
  Stages at = problem.initial_guess();
  const double mass = problem.vehicle().mass;
  for (int i = 0; i < problem.horizon().stages; ++i) {
    const double t = i * problem.horizon().step;
    at.col(i).segment<3>(offset_of(problem, "position")) << t * t, -t, 3;
    at.col(i).segment<3>(offset_of(problem, "velocity")) << 2 * t, -1, 0;
    at.col(i).segment<3>(offset_of(problem, "force")) << 2 * mass, 0, mass * kGravity;
    at(offset_of(problem, "yaw"), i) = 0.5 * t;
    at(offset_of(problem, "yaw_rate"), i) = 0.5;
  }
  return at;
}

double keyframe_cost(const Value& parameters) {
  TrajectoryProblem problem = flight(11, 0.2);
  problem.add_cost("keyframe", 2.0, plugins().create<CostTerm>("keyframe", parameters));
  problem.finish();
  EXPECT_TRUE(problem.quadratic());
  return problem.cost(parabola(problem));
}

TEST(Keyframe, IsReadAtItsExactTime) {
  // On the parabola at 0.73 s: (0.5329, -0.73, 3); 0.73 s lies between two stages.
  EXPECT_NEAR(keyframe_cost(map_of({{"keyframes", moments({{0.73, {0.5329, -0.73, 3}}})}})), 0.0,
              1e-24);
  EXPECT_NEAR(keyframe_cost(map_of({{"keyframes", moments({{0.73, {0.5329, -0.73, 1}}})}})), 8.0,
              1e-12);
  EXPECT_NEAR(keyframe_cost(map_of({{"keyframes", moments({{2.0, {4, -2, 2.5}}})}})), 0.5, 1e-12);
}

TEST(Keyframe, WeighsAndRepeats) {
  const auto cost = keyframe_cost(
      map_of({{"keyframes",
               moments({{1.0, {1, -1, 1}, 0.25}, {1.0, {1, -1, 4}}, {0.5, {0.25, -0.5, 0}, 0}})}}));
  EXPECT_NEAR(cost, 2.0 * (0.25 * 4 + 1 + 0), 1e-12);
}

TEST(Keyframe, ServesYawAndFreeBlocks) {
  EXPECT_NEAR(keyframe_cost(map_of({{"block", "yaw"}, {"keyframes", moments({{1.5, {0}}})}})),
              2 * 0.75 * 0.75, 1e-12);
  TrajectoryProblem problem = flight(3, 1.0);
  problem.add_block({.name = "target", .size = 3});
  problem.set_block_guess("target", {0, 2}, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4, 0, 0)});
  problem.add_cost(
      "keyframe", 1.0,
      plugins().create<CostTerm>(
          "keyframe", map_of({{"block", "target"}, {"keyframes", moments({{1.25, {2, 0, 0}}})}})));
  problem.finish();
  EXPECT_NEAR(problem.cost(problem.initial_guess()), 0.25, 1e-12) << "linear between stages";
}

TEST(Keyframe, RefusesWhatDoesNotFit) {
  const auto create = [](const Value& parameters) {
    plugins().create<CostTerm>("keyframe", parameters);
  };
  expect_message([&] { create(map_of({})); }, {"keyframes"});
  expect_message(
      [&] {
        create(map_of({{"keyframes", Value::list()}}));
      },
      {"keyframes", "at least one"});
  expect_message(
      [&] {
        create(map_of({{"keyframes", moments({{-1, {0, 0, 0}}})}}));
      },
      {"keyframes", "time", "at least 0"});
  expect_message(
      [&] {
        create(map_of({{"keyframes", moments({{1, {0, 0, std::nan("")}}})}}));
      },
      {"keyframes"});
  expect_message(
      [&] {
        create(map_of({{"keyframes", moments({{1, {0, 0, 0}, 1}})}, {"blok", "yaw"}}));
      },
      {"blok", "block"});
  expect_message(
      [&] {
        keyframe_cost(map_of({{"keyframes", moments({{1, {0, 0, 0}}, {1, {0, 0}}})}}));
      },
      {"keyframe: keyframe 2 has 2 numbers, block 'position' has 3"});
  expect_message(
      [&] {
        keyframe_cost(map_of({{"keyframes", moments({{2.5, {0, 0, 0}}})}}));
      },
      {"keyframe: time 2.5 s lies outside the duration of 2 s"});
  expect_message(
      [&] {
        keyframe_cost(map_of({{"block", "heading"}, {"keyframes", moments({{1, {0}}})}}));
      },
      {"keyframe: no block 'heading'"});
}

double effort(const TrajectoryProblem& problem, double force_x, double torque) {
  Stages at = problem.initial_guess();
  at.row(offset_of(problem, "force")).array() += force_x;
  at.row(offset_of(problem, "yaw_torque")).setConstant(torque);
  return problem.cost(at);
}

TrajectoryProblem effort_problem(const Vehicle& vehicle, int stages = 11, double step = 0.2) {
  TrajectoryProblem problem = flight(stages, step, vehicle);
  problem.add_cost("input_effort", 1.0, plugins().create<CostTerm>("input_effort"));
  problem.finish();
  return problem;
}

TEST(InputEffort, MeasuresInWeightsAndUsableTorques) {
  const Vehicle vehicle = camera_drone();
  const TrajectoryProblem problem = effort_problem(vehicle);
  EXPECT_TRUE(problem.quadratic());
  EXPECT_NEAR(effort(problem, 0, 0), 0.0, 1e-24) << "hovering is free";
  const double weight = vehicle.mass * kGravity;
  EXPECT_NEAR(effort(problem, 0.3 * weight, 0), 11 * 0.2 * 0.09, 1e-12);
  EXPECT_NEAR(effort(problem, 0, 0.5 * vehicle.yaw_torque_max()), 11 * 0.2 * 0.25, 1e-12);

  Vehicle heavy = vehicle;
  heavy.mass = 3.0;
  EXPECT_NEAR(effort(effort_problem(heavy), 0.3 * 2 * weight, 0), 11 * 0.2 * 0.09, 1e-12);

  Vehicle stiff = vehicle;
  stiff.yaw_share = 0;
  EXPECT_NEAR(effort(effort_problem(stiff), 0, 0.01), 0.0, 1e-24) << "no usable torque to compare";
}

TEST(InputEffort, DoesNotDependOnTheNumberOfStages) {
  const double weight = camera_drone().mass * kGravity;
  const double coarse = effort(effort_problem(camera_drone(), 101, 0.1), weight, 0);
  const double fine = effort(effort_problem(camera_drone(), 1001, 0.01), weight, 0);
  EXPECT_NEAR(coarse, 10.0, 0.11);
  EXPECT_NEAR(fine, 10.0, 0.011);
}

TEST(Derivative, IsExactOnPolynomials) {
  // The q-th derivative of a polynomial of degree q, integrated over the windows that fit.
  const double factorial[] = {1, 1, 2, 6, 24};
  for (int order = 1; order <= 4; ++order) {
    TrajectoryProblem problem = flight(21, 0.1);
    problem.add_cost("derivative", 3.0,
                     plugins().create<CostTerm>("derivative", map_of({{"order", order}})));
    problem.finish();
    Stages at = problem.initial_guess();
    for (int i = 0; i < 21; ++i) at(1, i) = 0.5 * std::pow(0.1 * i - 1, order);
    const double expected = std::pow(0.5 * factorial[order], 2);
    EXPECT_NEAR(problem.cost(at), 3.0 * expected * 0.1 * (21 - order), 1e-6 * expected) << order;
  }
}

TEST(Derivative, ReadsSeveralBlocksAtOnce) {
  const auto cost = [](const char* block) {
    TrajectoryProblem problem = flight(21, 0.1);
    const Value given = map_of({{"block", block}, {"order", 2}});
    problem.add_cost("derivative", 1.0, plugins().create<CostTerm>("derivative", given));
    problem.finish();
    Stages at = problem.initial_guess();
    for (int i = 0; i < 21; ++i) {
      at.col(i).segment<3>(offset_of(problem, "position")) << std::sin(0.4 * i), 0, 0.02 * i * i;
      at(offset_of(problem, "yaw"), i) = std::cos(0.3 * i);
    }
    return problem.cost(at);
  };
  EXPECT_GT(cost("yaw"), 1.0);
  EXPECT_NEAR(cost("yaw  position"), cost("yaw") + cost("position"), 1e-9);
}

TEST(Derivative, TouchesNoCut) {
  // A corner at 1 s: the second difference over stages 9, 10, 11 is all there is.
  const auto cost = [](const Value& spans) {
    TrajectoryProblem problem = flight(21, 0.1);
    const Value given = map_of({{"order", 2}, {"except", spans}});
    problem.add_cost("derivative", 1.0, plugins().create<CostTerm>("derivative", given));
    problem.finish();
    Stages at = problem.initial_guess();
    for (int i = 0; i < 21; ++i) at(0, i) = 0.1 * std::abs(i - 10);
    return problem.cost(at);
  };
  EXPECT_NEAR(cost(Value::list()), 0.1 * 20 * 20, 1e-9);
  EXPECT_NEAR(cost(spans_of({{1.05, 1.06}})), 0.0, 1e-20);
  EXPECT_NEAR(cost(spans_of({{1.1, 2}})), 0.0, 1e-20);
  EXPECT_NEAR(cost(spans_of({{0, 0.85}, {1.15, 2}})), 40, 1e-9);
}

TEST(Derivative, RefusesWhatDoesNotFit) {
  for (const char* block : {"", "  "})
    expect_message(
        [&] {
          plugins().create<CostTerm>("derivative", map_of({{"block", block}}));
        },
        {"block", "expected the name of a block"});
  expect_message(
      [] {
        plugins().create<CostTerm>("derivative", map_of({{"block", "yaw position yaw"}}));
      },
      {"block", "'yaw' is given twice"});
  expect_message(
      [] {
        plugins().create<CostTerm>("derivative", map_of({{"order", 5}}));
      },
      {"order", "between 1 and 4"});
  TrajectoryProblem problem = flight(3, 0.1);
  problem.add_cost("snap", 1.0, plugins().create<CostTerm>("derivative"));
  expect_message([&] { problem.finish(); }, {"snap: ", "5 neighbouring stages", "has 3"});
  TrajectoryProblem other = flight(9, 0.1);
  other.add_cost("steady", 1.0, plugins().create<CostTerm>("gimbal_derivative"));
  expect_message([&] { other.finish(); }, {"steady: no block 'gimbal_yaw'"});
}

}  // namespace
}  // namespace lapwing
