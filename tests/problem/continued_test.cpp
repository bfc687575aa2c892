// SPDX-License-Identifier: Apache-2.0
// Problems that begin later than at 0, and problems that continue the solution of another.
#include "framework/plugin/registry.h"
#include "framework/solve/trajectory_solver.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

const Registry& continued_plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

Value keyframe(double time, double x) {
  Value entry = Value::map();
  entry.set("time", time);
  entry.set("value", Value(Value::List{x, 0.0, 2.0}));
  return entry;
}

// A smooth flight past places along x, from stage times `begin` on.
TrajectoryProblem flight(double begin, int stages, Value::List keyframes) {
  TrajectoryProblem problem(camera_drone(), {.stages = stages, .step = 0.1, .begin = begin});
  problem.add_model("quadrotor", continued_plugins().create<VehicleModel>("quadrotor"));
  Value derivative = Value::map();
  derivative.set("block", "force");
  derivative.set("order", 2);
  problem.add_cost("smooth", 1e-3, continued_plugins().create<CostTerm>("derivative", derivative));
  Value places = Value::map();
  places.set("keyframes", Value(std::move(keyframes)));
  problem.add_cost("places", 10, continued_plugins().create<CostTerm>("keyframe", places));
  problem.add_constraint("limits", continued_plugins().create<Constraint>("input_limits"));
  return problem;
}

Stages solved(const TrajectoryProblem& problem) {
  const auto solver = continued_plugins().create<TrajectorySolver>("iqp");
  const SolveResult result = solve_by(*solver, problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  return result.point.stages;
}

TEST(Continued, TimesAreThoseOfTheWholeFlight) {
  const Horizon horizon{.stages = 11, .step = 0.1, .begin = 4};
  EXPECT_DOUBLE_EQ(horizon.time(0), 4);
  EXPECT_DOUBLE_EQ(horizon.end(), 5);
  EXPECT_NEAR(horizon.duration(), 1, 1e-12);
  EXPECT_EQ(horizon.stage_at(4.55), 5);
  EXPECT_EQ(horizon.stage_at(0), 0);
  TrajectoryProblem late = flight(4, 11, {keyframe(4.5, 1)});
  late.finish();
  const Stages guess = late.initial_guess();
  EXPECT_DOUBLE_EQ(late.time(guess, 0), 4);
  EXPECT_DOUBLE_EQ(late.trajectory(guess).samples.back().time, 5);
  TrajectoryProblem before = flight(4, 11, {keyframe(3.5, 1)});
  EXPECT_THROW(before.finish(), InputError);
  TrajectoryProblem after = flight(4, 11, {keyframe(5.5, 1)});
  EXPECT_THROW(after.finish(), InputError);
}

// The rest of an optimal flight is optimal: continued from its own beginning it is found again.
TEST(Continued, TheRestOfAnOptimalFlightIsOptimal) {
  const Value::List all = {keyframe(0, 0), keyframe(1.5, 2), keyframe(3, -1), keyframe(4, 3)};
  TrajectoryProblem whole = flight(0, 41, all);
  whole.finish();
  const Stages optimal = solved(whole);
  constexpr int kFrom = 13, kHeld = 4;
  TrajectoryProblem rest = flight(1.3, 41 - kFrom, {all[1], all[2], all[3]});
  rest.continue_from(optimal.middleCols(kFrom, kHeld), kHeld);
  rest.finish();
  const Stages found = solved(rest);
  const int position = rest.layout().offset(rest.layout().index("position"));
  for (int i = 0; i < found.cols(); ++i)
    EXPECT_LT((found.col(i) - optimal.col(kFrom + i)).segment<3>(position).norm(), 1e-5) << i;
}

TEST(Continued, WhatIsHeldDoesNotChange) {
  TrajectoryProblem first = flight(0, 21, {keyframe(0, 0), keyframe(2, 4)});
  first.finish();
  const Stages before = solved(first);
  constexpr int kFrom = 8, kHeld = 4;
  // Now to the other side.
  TrajectoryProblem next = flight(0.8, 21, {keyframe(2.8, -6)});
  next.continue_from(before.middleCols(kFrom, 13), kHeld);
  next.finish();
  const Stages guess = next.initial_guess(), found = solved(next);
  const StageLayout& layout = next.layout();
  const auto block = [&](const Stages& at, const char* name, int stage) {
    return at.col(stage).segment<3>(layout.offset(layout.index(name))).eval();
  };
  for (int i = 0; i < kHeld; ++i) {
    EXPECT_LT((block(found, "position", i) - block(before, "position", kFrom + i)).norm(), 1e-8);
    EXPECT_LT((block(found, "velocity", i) - block(before, "velocity", kFrom + i)).norm(), 1e-8);
    if (i + 1 < kHeld) {
      EXPECT_EQ(block(found, "force", i), block(before, "force", kFrom + i)) << i;
    }
  }
  EXPECT_GT((block(found, "force", kHeld) - block(before, "force", kFrom + kHeld)).norm(), 0.1);
  EXPECT_EQ(block(guess, "position", 12), block(before, "position", 20)) << "a guess beyond it";
}

// What was decided may break a limit that is new: it is not asked for, what follows is.
TEST(Continued, LimitsHoldForWhatIsNotDecided) {
  TrajectoryProblem first = flight(0, 21, {keyframe(0, 0), keyframe(2, 12)});
  first.finish();
  const Stages before = solved(first);
  TrajectoryProblem next = flight(1.0, 31, {keyframe(4, 12)});
  Value slow = Value::map();
  slow.set("type", "state_limits");
  next.add_constraint("slow", continued_plugins().create<Constraint>("state_limits"));
  next.continue_from(before.middleCols(10, 4), 4);
  next.finish();
  const SolveResult result =
      solve_by(*continued_plugins().create<TrajectorySolver>("iqp"), next, {});
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
}

TEST(Continued, WhatDoesNotFitIsRefused) {
  TrajectoryProblem problem = flight(0, 11, {keyframe(1, 1)});
  EXPECT_THROW(problem.continue_from(Stages::Zero(20, 3), 4), InputError) << "fewer than held";
  EXPECT_THROW(problem.continue_from(Stages::Zero(20, 12), 4), InputError) << "more than there are";
  EXPECT_THROW(problem.continue_from(Stages::Zero(20, 4), 0), InputError);
  problem.continue_from(Stages::Zero(3, 4), 2);
  EXPECT_THROW(problem.finish(), InputError) << "another layout";
  TrajectoryProblem free(camera_drone(), {.stages = 11, .step = 0.1, .step_free = true});
  free.add_model("quadrotor", continued_plugins().create<VehicleModel>("quadrotor"));
  EXPECT_THROW(free.continue_from(Stages::Zero(20, 4), 2), InputError) << "free steps";
  TrajectoryProblem turning(camera_drone(), {.stages = 11, .step = 0.1});
  turning.add_model("tumbler", std::make_unique<laboratory::Tumbler>());
  turning.continue_from(Stages::Zero(11, 4), 2);
  EXPECT_THROW(turning.finish(), InputError) << "an orientation";
}

}  // namespace
}  // namespace lapwing
