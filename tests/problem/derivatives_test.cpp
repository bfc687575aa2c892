// SPDX-License-Identifier: Apache-2.0
// Gradients, Jacobians and Hessians of whole problems against differences.
#include "framework/plugin/registry.h"
#include "tests/problem/differences.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

using namespace laboratory;

const Registry& plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

Value derivative_of(const std::string& block, int order) {
  Value parameters = Value::map();
  parameters.set("block", block);
  parameters.set("order", order);
  return parameters;
}

TrajectoryProblem quadrotor_problem(bool step_free) {
  TrajectoryProblem problem(camera_drone(), {.stages = 7, .step = 0.5, .step_free = step_free});
  problem.add_model("quadrotor", plugins().create<VehicleModel>("quadrotor"));
  for (int order = 1; order <= 4; ++order)
    problem.add_cost("smooth_" + std::to_string(order), 0.3 * order,
                     plugins().create<CostTerm>("derivative", derivative_of("position", order)));
  problem.add_cost("smooth_yaw", 0.5,
                   plugins().create<CostTerm>("derivative", derivative_of("yaw", 2)));
  problem.set_path_guess({0, 3}, {{0, 0, 1}, {3, -1, 2}}, {0.0, 1.0});
  return problem;
}

TEST(Derivatives, OfALinearProblem) {
  TrajectoryProblem problem = quadrotor_problem(false);
  problem.finish();
  EXPECT_TRUE(problem.quadratic());
  EXPECT_EQ(problem.columns(), 7 * 12) << "time and step are constants";
  EXPECT_EQ(problem.rows(), 6 * 8 + 4);
  const Stages at = random_point(problem, 1);
  expect_gradient(problem, at);
  expect_row_jacobian(problem, at);
  expect_exact_hessian(problem, at, random_multipliers(problem, 2));

  // The local model of a quadratic problem is the problem.
  LocalModel model;
  problem.linearise(at, model);
  Random random(3);
  Eigen::VectorXd step(problem.columns());
  for (double& x : step) x = random.uniform(-1, 1);
  const Stages there = problem.retract(at, step);
  const double predicted =
      model.cost + model.gradient.dot(step) + 0.5 * step.dot(full(model.hessian) * step);
  EXPECT_NEAR(problem.cost(there), predicted, 1e-10 * problem.cost(there));
  EXPECT_TRUE(problem.row_values(there).isApprox(model.values + model.jacobian * step, 1e-11));
}

TEST(Derivatives, OfALinearProblemWithFreeStep) {
  TrajectoryProblem problem = quadrotor_problem(true);
  problem.finish();
  EXPECT_FALSE(problem.quadratic());
  EXPECT_EQ(problem.columns(), 7 * 14);
  EXPECT_EQ(problem.rows(), 6 * 8 + 4 + 2 * 6);
  const Stages at = random_point(problem, 1, 0.1);
  expect_gradient(problem, at);
  expect_row_jacobian(problem, at);
  expect_exact_hessian(problem, at, random_multipliers(problem, 2));
}

TrajectoryProblem pendulum_problem(bool step_free, bool times) {
  TrajectoryProblem problem(camera_drone(), {.stages = 6, .step = 0.6, .step_free = step_free});
  problem.add_model("pendulum", std::make_unique<Pendulum>());
  problem.add_block({.name = "target", .size = 3, .unit = "m"});
  for (int window = 1; window <= 3; ++window) {
    const std::string number = std::to_string(window);
    problem.add_cost("wavy_" + number, 0.4 * window,
                     wavy_cost({.blocks = {"rate", "target"}, .window = window}));
    problem.add_cost(
        "lasting_" + number, 0.3,
        wavy_cost({.blocks = {"place", "step", "push"}, .window = window, .integral = true}));
    problem.add_constraint("bent_" + number,
                           wavy_constraint({.blocks = {"target", "place"}, .window = window}));
  }
  problem.add_constraint("bent_sum", wavy_constraint({.blocks = {"push"}, .integral = true}));
  problem.add_constraint("ends", wavy_constraint({.blocks = {"time", "rate"}, .stages = {0, 5}}));
  if (times) {
    const std::vector<double> at{0.0, 0.6, 1.0, 1.75, 1.75, 3.0};
    problem.add_cost(
        "between", 0.7,
        wavy_cost({.blocks = {"target", "place", "push", "rate", "time"}, .times = at}));
    problem.add_constraint("bent_between",
                           wavy_constraint({.blocks = {"place", "target"}, .times = at}));
    problem.add_constraint(
        "straight_between",
        wavy_constraint({.blocks = {"rate", "push"}, .times = at, .linear = true}));
  }
  return problem;
}

TEST(Derivatives, OfANonlinearProblemWithWindows) {
  TrajectoryProblem problem = pendulum_problem(false, false);
  problem.finish();
  EXPECT_FALSE(problem.quadratic());
  expect_derivatives(problem, 0.4);
}

TEST(Derivatives, BetweenStagesThroughTheFlow) {
  TrajectoryProblem problem = pendulum_problem(false, true);
  problem.finish();
  expect_derivatives(problem, 0.4);
}

TEST(Derivatives, WithFreeStepAndIntegrals) {
  TrajectoryProblem problem = pendulum_problem(true, false);
  problem.finish();
  expect_derivatives(problem, 0.15);
}

TrajectoryProblem tumbler_problem(bool step_free, bool times) {
  TrajectoryProblem problem(camera_drone(), {.stages = 4, .step = 0.5, .step_free = step_free});
  problem.add_model("tumbler", std::make_unique<Tumbler>());
  problem.add_block({.name = "look", .size = 4, .topology = Topology::quaternion});
  for (int window = 1; window <= 3; ++window) {
    const std::string number = std::to_string(window);
    problem.add_cost(
        "wavy_" + number, 0.4,
        wavy_cost(
            {.blocks = {"attitude", "height", "look"}, .window = window, .integral = window == 2}));
    problem.add_constraint(
        "bent_" + number,
        wavy_constraint({.blocks = {"look", "attitude"}, .window = window, .linear = window == 2}));
  }
  if (times)
    problem.add_cost("between", 0.7,
                     wavy_cost({.blocks = {"attitude", "spin", "height"}, .times = {0.2, 1, 1.4}}));
  return problem;
}

TEST(Derivatives, WithOrientations) {
  TrajectoryProblem problem = tumbler_problem(false, false);
  problem.finish();
  expect_derivatives(problem, 0.6);
}

TEST(Derivatives, WithOrientationsAndFreeStep) {
  TrajectoryProblem problem = tumbler_problem(true, false);
  problem.finish();
  expect_derivatives(problem, 0.15);
}

TEST(Derivatives, WithOrientationsBetweenStages) {
  TrajectoryProblem problem = tumbler_problem(false, true);
  problem.finish();
  expect_derivatives(problem, 0.6);
}

TEST(Derivatives, GaussNewtonIsTwiceTheWeightedSquareOfTheJacobian) {
  // The same function as a cost and as a constraint: the latter's rows give the Jacobian.
  const Reading reading{.blocks = {"attitude", "height", "height"}, .window = 2};
  TrajectoryProblem problem(camera_drone(), {.stages = 5, .step = 0.5});
  problem.add_model("tumbler", std::make_unique<Tumbler>());
  problem.add_cost("wavy", 0.7, wavy_cost(reading));
  problem.add_constraint("bent", wavy_constraint(reading));
  problem.finish();
  LocalModel model;
  problem.linearise(random_point(problem, 5), model, Curvature::gauss_newton);
  const Eigen::MatrixXd j = model.jacobian.toDense().bottomRows(2 * 4);
  EXPECT_TRUE(full(model.hessian).isApprox(2 * 0.7 * j.transpose() * j, 1e-12));
  EXPECT_EQ(problem.row_name(problem.rows() - 1), "bent.1 at 1.5 s");
}

TEST(Derivatives, CachedJacobianOfAStraightTermEqualsTheEvaluatedOne) {
  // Declared straight: computed once. Declared curved: computed anew. Both see the same numbers.
  const auto build = [](bool cached) {
    TrajectoryProblem problem(camera_drone(), {.stages = 6, .step = 0.5});
    problem.add_model("quadrotor", plugins().create<VehicleModel>("quadrotor"));
    problem.add_cost("straight", 0.3,
                     wavy_cost({.blocks = {"position", "yaw_torque"},
                                .times = {0.1, 1.3, 2.5},
                                .linear = true,
                                .unsaid = !cached}));
    problem.finish();
    return problem;
  };
  const TrajectoryProblem cached = build(true), evaluated = build(false);
  EXPECT_TRUE(cached.quadratic());
  EXPECT_FALSE(evaluated.quadratic());
  const Stages at = random_point(cached, 4);
  LocalModel a, b;
  cached.linearise(at, a);
  evaluated.linearise(at, b);
  EXPECT_TRUE(full(a.hessian).isApprox(full(b.hessian), 1e-14));
  EXPECT_TRUE(a.gradient.isApprox(b.gradient, 1e-14));
  EXPECT_DOUBLE_EQ(a.cost, b.cost);
}

}  // namespace
}  // namespace lapwing
