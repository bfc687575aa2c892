// SPDX-License-Identifier: Apache-2.0
// nlopt on films: as good as iqp within what is claimed, tight, and honest.
#include "tests/plugins/trajectory_solvers/solver_expectations.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

constexpr const char* kNlopt = "nlopt";

TEST(Nlopt, FindsTheOptimumOfConvexFilms) {
  Film hard = crossing();
  hard.hard = true;
  for (const Film& film : {crossing(), hard}) expect_the_optimum(kNlopt, film, 1e-3);
}

TEST(Nlopt, FindsTheOptimumAmongCurvedLimits) {
  for (const bool hard : {false, true}) expect_the_optimum(kNlopt, hurried(hard), 1e-3);
}

// The states follow from the inputs, and these keep their bounds to the last digit.
TEST(Nlopt, DynamicsAndInputBoundsHoldExactly) {
  const TrajectoryProblem problem = problem_of(crossing());
  const SolveResult result = solve(kNlopt, problem);
  EXPECT_LT(problem.row_values(result.point.stages).head(problem.dynamics_rows()).norm(), 1e-12);
  LocalModel model;
  problem.linearise(result.point.stages, model);
  const int force = problem.layout().tangent_offset(problem.layout().index("force"));
  const int per_stage = problem.columns() / problem.horizon().stages;
  for (int stage = 0; stage + 1 < problem.horizon().stages; ++stage)
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE(model.step_lower(stage * per_stage + force + i), 1e-15);
      EXPECT_GE(model.step_upper(stage * per_stage + force + i), -1e-15);
    }
}

TEST(Nlopt, EveryAlgorithmIsHonest) {
  const TrajectoryProblem problem = problem_of(hurried());
  const double best = solve("ipopt", problem).report.cost;
  for (const char* algorithm :
       {"LD_LBFGS", "LD_VAR1", "LD_VAR2", "LD_TNEWTON", "LD_TNEWTON_RESTART", "LD_TNEWTON_PRECOND",
        "LD_TNEWTON_PRECOND_RESTART", "LD_MMA", "LD_CCSAQ"}) {
    SolveRequest request;
    request.iteration_limit = 3000;
    const SolveResult result = solve(kNlopt, problem, request, table({{"algorithm", algorithm}}));
    const SolveStatus status = result.report.status;
    EXPECT_NE(status, SolveStatus::numerical_error) << algorithm;
    EXPECT_NE(status, SolveStatus::infeasible) << algorithm;
    if (status != SolveStatus::optimal) continue;
    EXPECT_NEAR(result.report.cost, best, 1e-3 * best) << algorithm;
    EXPECT_LE(result.report.violations.front().amount, 1e-6) << algorithm;
  }
}

// Plain bounds are NLopt's own there; slower, and the same answer.
TEST(Nlopt, DiagonalScalingFindsItToo) {
  Film film = crossing();
  film.duration = film.keyframes.back().time = 5;
  film.step = 0.25;
  const TrajectoryProblem problem = problem_of(film);
  const SolveResult whole = solve(kNlopt, problem);
  const SolveResult diagonal = solve(kNlopt, problem, {}, table({{"scaling", "diagonal"}}));
  ASSERT_EQ(whole.report.status, SolveStatus::optimal) << whole.report.message;
  EXPECT_NE(diagonal.report.status, SolveStatus::infeasible) << diagonal.report.message;
  EXPECT_NEAR(diagonal.report.cost, whole.report.cost, 0.05 * whole.report.cost);
}

TEST(Nlopt, NamesWhatAnImpossibleFilmMisses) {
  expect_infeasible(kNlopt);
}

TEST(Nlopt, StopsWhenTold) {
  expect_it_stops(kNlopt);
}

TEST(Nlopt, WarmStartsHelp) {
  expect_warm_starts_to_help(kNlopt);
}

TEST(Nlopt, EqualProblemsGiveEqualBytes) {
  expect_equal_bytes(kNlopt);
}

TEST(Nlopt, PrintsNothing) {
  expect_silence(kNlopt);
}

TEST(Nlopt, NamesBoundsThatContradictEachOther) {
  expect_crossed_bounds_to_be_named(kNlopt);
}

TEST(Nlopt, SaysWhatItDoesNotTake) {
  TrajectoryProblem tumbler(solo(), {.stages = 5, .step = 0.1});
  tumbler.add_model("tumbler", std::make_unique<laboratory::Tumbler>());
  tumbler.finish();
  const SolveResult turned = solve(kNlopt, tumbler);
  EXPECT_EQ(turned.report.status, SolveStatus::unsupported);
  EXPECT_NE(turned.report.message.find("attitude"), std::string::npos) << turned.report.message;
  EXPECT_EQ(turned.point.stages, tumbler.initial_guess());
  TrajectoryProblem stretched(solo(), {.stages = 5, .step = 0.1, .step_free = true});
  stretched.add_model("pendulum", std::make_unique<laboratory::Pendulum>());
  stretched.finish();
  const SolveResult freed = solve(kNlopt, stretched);
  EXPECT_EQ(freed.report.status, SolveStatus::unsupported);
  EXPECT_NE(freed.report.message.find("free steps"), std::string::npos) << freed.report.message;
}

}  // namespace
}  // namespace lapwing
