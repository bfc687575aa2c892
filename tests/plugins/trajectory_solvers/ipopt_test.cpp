// SPDX-License-Identifier: Apache-2.0
// ipopt on films.
#include "framework/core/log.h"
#include "tests/plugins/trajectory_solvers/solver_expectations.h"

namespace lapwing {
namespace {

constexpr const char* kIpopt = "ipopt";

TEST(Ipopt, FindsTheOptimumOfConvexFilms) {
  Film hard = crossing();
  hard.hard = true;
  for (const Film& film : {crossing(), hard}) expect_the_optimum(kIpopt, film, 1e-4);
}

TEST(Ipopt, FindsTheOptimumAmongCurvedLimits) {
  for (const bool hard : {false, true}) expect_the_optimum(kIpopt, hurried(hard), 1e-4);
}

TEST(Ipopt, AllKindsOfSecondDerivativesAgree) {
  const TrajectoryProblem problem = problem_of(hurried());
  const SolveResult exact = solve(kIpopt, problem);
  const SolveResult first = solve(kIpopt, problem, {}, table({{"hessian", "gauss_newton"}}));
  EXPECT_EQ(first.report.status, SolveStatus::optimal);
  EXPECT_NEAR(first.report.cost, exact.report.cost, 1e-5 * exact.report.cost);
  const SolveResult monotone = solve(kIpopt, problem, {}, table({{"mu_strategy", "monotone"}}));
  EXPECT_EQ(monotone.report.status, SolveStatus::optimal);
  EXPECT_NEAR(monotone.report.cost, exact.report.cost, 1e-5 * exact.report.cost);
}

TEST(Ipopt, NamesWhatAnImpossibleFilmMisses) {
  expect_infeasible(kIpopt);
}

TEST(Ipopt, StopsWhenTold) {
  expect_it_stops(kIpopt);
}

TEST(Ipopt, WarmStartsHelp) {
  expect_warm_starts_to_help(kIpopt);
}

TEST(Ipopt, EqualProblemsGiveEqualBytes) {
  expect_equal_bytes(kIpopt);
}

TEST(Ipopt, PrintsIntoTheLogAlone) {
  expect_silence(kIpopt);
  const logging::Capture capture;
  solve(kIpopt, problem_of(crossing()));
  const std::string text = capture.text();
  EXPECT_NE(text.find("debug: ipopt: Number of Iterations"), std::string::npos) << text;
  EXPECT_EQ(text.find("CPU secs"), std::string::npos) << "equal runs must give equal logs";
}

TEST(Ipopt, NamesBoundsThatContradictEachOther) {
  expect_crossed_bounds_to_be_named(kIpopt);
}

// Costs of 1e6: the answer is as good relative to the cost, and called optimal.
TEST(Ipopt, LargeCostsAreSolvedToo) {
  const Film film{
      .keyframes = {keyframe(0, {0, 0, 2}), keyframe(1, {40, 0, 2}), keyframe(2, {0, 0, 2})},
      .duration = 2,
      .step = 0.05};
  const TrajectoryProblem problem = problem_of(film);
  const SolveResult result = solve(kIpopt, problem);
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  EXPECT_NEAR(result.report.cost, solve("iqp", problem).report.cost, 1e-6 * result.report.cost);
}

}  // namespace
}  // namespace lapwing
