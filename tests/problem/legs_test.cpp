// SPDX-License-Identifier: Apache-2.0
// Legs with steps of their own, and flights that close onto their beginning.
#include <numbers>

#include "framework/plugin/registry.h"
#include "tests/problem/differences.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

using namespace laboratory;

const Registry& leg_plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

const std::vector<Leg> kThree = {{.intervals = 2, .step = 0.4},
                                 {.intervals = 3, .step = 0.2, .free = false},
                                 {.intervals = 2, .step = 0.5, .shortest = 0.6, .longest = 2}};

Value leg_derivative(const std::string& block, int order) {
  Value parameters = Value::map();
  parameters.set("block", block);
  parameters.set("order", order);
  return parameters;
}

TrajectoryProblem quadrotor(const Horizon& horizon) {
  TrajectoryProblem problem(camera_drone(), horizon);
  problem.add_model("quadrotor", leg_plugins().create<VehicleModel>("quadrotor"));
  for (int order = 1; order <= 4; ++order)
    problem.add_cost(
        "smooth_" + std::to_string(order), 0.3 * order,
        leg_plugins().create<CostTerm>("derivative", leg_derivative("position", order)));
  problem.add_cost("even_force", 0.1,
                   leg_plugins().create<CostTerm>("derivative", leg_derivative("force", 2)));
  problem.add_cost("flight_time", 2, leg_plugins().create<CostTerm>("flight_time"));
  return problem;
}

TEST(Legs, AHorizonKnowsItsTimes) {
  const Horizon horizon = Horizon::of_legs(kThree);
  EXPECT_EQ(horizon.stages, 8);
  EXPECT_TRUE(horizon.step_free);
  EXPECT_DOUBLE_EQ(horizon.duration(), 2.4);
  EXPECT_DOUBLE_EQ(horizon.time(3), 1.0);
  EXPECT_DOUBLE_EQ(horizon.step_after(2), 0.2);
  EXPECT_DOUBLE_EQ(horizon.step_after(7), 0.5);
  EXPECT_EQ(horizon.end_of_leg(0), 0);
  EXPECT_EQ(horizon.end_of_leg(2), 5);
  EXPECT_EQ(horizon.stage_at(1.05), 3);
  EXPECT_EQ(horizon.stage_at(2.5), 7);
  EXPECT_THROW(horizon.end_of_leg(4), InputError);
  EXPECT_THROW(Horizon::of_legs({}), InputError);
  EXPECT_THROW(Horizon::of_legs({{.intervals = 0, .step = 1}}), InputError);
  EXPECT_THROW(Horizon::of_legs({{.step = 1, .shortest = 3, .longest = 2}}), InputError);
}

TEST(Legs, OnlyStepsOfOneFreeLegAreChained) {
  TrajectoryProblem problem = quadrotor(Horizon::of_legs(kThree));
  problem.finish();
  // Flow, held inputs, seven of time, and of steps one in the first leg and two in the last.
  EXPECT_EQ(problem.rows(), 7 * 8 + 4 + 7 + 3);
  EXPECT_EQ(problem.row_name(7 * 8 + 4), "clock.time at 0 s");
  EXPECT_EQ(problem.row_name(7 * 8 + 5), "clock.step at 0 s");
  EXPECT_EQ(problem.row_name(7 * 8 + 7), "clock.time at 0.8 s");
  const int step = problem.layout().tangent_offset(problem.layout().index("step"));
  const int per_stage = problem.columns() / 8;
  EXPECT_EQ(problem.bounds(3 * per_stage + step), (std::pair{0.2, 0.2}));
  EXPECT_EQ(problem.bounds(6 * per_stage + step), (std::pair{0.3, 1.0}));
  EXPECT_EQ(problem.bounds(0 * per_stage + step).first, 1e-3);
}

TEST(Legs, DerivativesAreExact) {
  TrajectoryProblem problem = quadrotor(Horizon::of_legs(kThree));
  problem.finish();
  expect_derivatives(problem, 0.05);
}

TEST(Legs, DerivativesOfAPeriodicFlightAreExact) {
  Horizon horizon = Horizon::of_legs(kThree);
  horizon.periodic = true;
  TrajectoryProblem problem(camera_drone(), horizon);
  problem.add_model("tumbler", std::make_unique<Tumbler>());
  problem.finish();
  EXPECT_EQ(problem.row_name(problem.rows() - 1).substr(0, 8), "closure.");
  expect_derivatives(problem, 0.05);
}

TEST(Legs, APeriodicFlightMayTurn) {
  Horizon horizon{.stages = 3, .step = 0.5};
  horizon.periodic = true;
  horizon.turns = 1;
  TrajectoryProblem problem(camera_drone(), horizon);
  problem.add_model("quadrotor", leg_plugins().create<VehicleModel>("quadrotor"));
  problem.set_path_guess({0, 1}, {{0, 0, 1}, {0, 0, 1}}, {0.0, 2 * std::numbers::pi});
  problem.finish();
  EXPECT_EQ(problem.row_name(problem.rows() - 8), "closure.position.x");
  EXPECT_EQ(problem.row_name(problem.rows() - 5), "closure.yaw");
  const Eigen::VectorXd rows = problem.row_values(problem.initial_guess());
  EXPECT_NEAR(rows.tail(8).head(4).norm(), 0, 1e-12) << "a whole turn is not a difference";
}

// x(t) = t^q has q! as its q-th derivative, whatever the steps are.
TEST(Legs, DividedDifferencesOfPowersAreFactorials) {
  TrajectoryProblem problem(camera_drone(),
                            Horizon::of_legs({{.intervals = 3, .step = 0.1, .free = false},
                                              {.intervals = 3, .step = 0.35, .free = false}}));
  problem.add_model("quadrotor", leg_plugins().create<VehicleModel>("quadrotor"));
  for (int order = 1; order <= 4; ++order)
    problem.add_cost(
        "order_" + std::to_string(order), 1,
        leg_plugins().create<CostTerm>("derivative", leg_derivative("position", order)));
  problem.finish();
  double factorial = 1;
  for (int order = 1; order <= 4; ++order) {
    factorial *= order;
    Stages at = problem.initial_guess();
    double covered = 0;  // s, weight of the windows
    for (int i = 0; i < 7; ++i) {
      at(0, i) = std::pow(problem.horizon().time(i), order);
      if (i + order < 7) covered += problem.horizon().step_after(i);
    }
    EXPECT_NEAR(problem.term_costs(at)[order - 1].cost, factorial * factorial * covered,
                1e-8 * factorial * factorial)
        << order;
  }
}

TEST(Legs, FlightTimeIsTheSumOfTheSteps) {
  TrajectoryProblem problem = quadrotor(Horizon::of_legs(kThree));
  problem.finish();
  EXPECT_NEAR(problem.term_costs(problem.initial_guess()).back().cost, 2 * 2.4, 1e-12);
}

TEST(Legs, AGivenTimeNamesTheEndOfALeg) {
  TrajectoryProblem problem = quadrotor(Horizon::of_legs(kThree));
  problem.add_constraint("there", wavy_constraint({.blocks = {"position"}, .times = {0.8, 2.4}}));
  problem.finish();
  EXPECT_EQ(problem.row_name(problem.rows() - 1).substr(0, 7), "there.1");
  EXPECT_NE(problem.row_name(problem.rows() - 1).find(" at 2.4 s"), std::string::npos);
  TrajectoryProblem other = quadrotor(Horizon::of_legs(kThree));
  other.add_constraint("there", wavy_constraint({.blocks = {"position"}, .times = {1.0}}));
  EXPECT_THROW(other.finish(), InputError);
}

TEST(Legs, AMotionIsTakenOverByShareOfItsLeg) {
  TrajectoryProblem coarse = quadrotor(Horizon::of_legs(kThree));
  coarse.set_path_guess({0, 2.4}, {{0, 0, 0}, {2.4, 0, 0}}, {0, 0});
  coarse.finish();
  const Trajectory motion = coarse.trajectory(coarse.initial_guess());
  std::vector<Leg> finer = kThree;
  finer[0].intervals = 4;
  TrajectoryProblem fine = quadrotor(Horizon::of_legs(finer));
  fine.set_motion_guess(motion, coarse.horizon());
  fine.finish();
  const Stages at = fine.initial_guess();
  EXPECT_NEAR(at(0, 4), motion.samples[2].position.x(), 1e-9);
  EXPECT_NEAR(at(0, 9), motion.samples[7].position.x(), 1e-9);
  EXPECT_NEAR(at(0, 1), 0.2, 1e-2);
  EXPECT_THROW(fine.set_motion_guess(motion, Horizon{.stages = 8, .step = 1}), Error);
}

}  // namespace
}  // namespace lapwing
