// SPDX-License-Identifier: Apache-2.0
// iqp on films: optimal and certified, honest about what cannot be, and stoppable.
#include "tests/plugins/trajectory_solvers/film_problem.h"

namespace lapwing {
namespace {

std::unique_ptr<TrajectorySolver> iqp() {
  return built_plugins().create<TrajectorySolver>("iqp");
}

std::string failures(const Certificate& certificate) {
  std::string text;
  for (const Check& check : certificate.failures()) text += check.name + " ";
  return text;
}

TEST(Iqp, SolvesAQuadraticFilmInOneProgramAndIsCertified) {
  const TrajectoryProblem problem = problem_of(crossing());
  ASSERT_TRUE(problem.quadratic());
  const SolveResult result = iqp()->solve(problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  EXPECT_EQ(result.report.iterations, 1);
  ASSERT_FALSE(result.report.violations.empty());
  EXPECT_LT(result.report.violations.front().amount, 1e-6) << result.report.violations.front().row;
  const Certificate certificate = certify(crossing(), problem, result);
  EXPECT_TRUE(certificate.feasible()) << failures(certificate);
}

TEST(Iqp, MeetsHardKeyframesBetweenStagesExactly) {
  Film film = crossing();
  film.hard = true;
  for (KeyframeTask& k : film.keyframes) k.tolerance = 1e-4;
  film.keyframes[1].time = 3.3371;  // between two stages
  for (KeyframeTask& k : film.keyframes) k.time_tolerance = 1e-6;
  const TrajectoryProblem problem = problem_of(film);
  const SolveResult result = iqp()->solve(problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  const Certificate certificate = certify(film, problem, result);
  EXPECT_TRUE(certificate.feasible()) << failures(certificate);
}

// The optimum of a quadratic film is stationary: no feasible direction lowers its cost.
TEST(Iqp, NoSmallFeasibleChangeIsBetter) {
  const TrajectoryProblem problem = problem_of(crossing());
  const SolveResult best = iqp()->solve(problem, {});
  for (const double pull : {-0.3, 0.3}) {
    Film other = crossing();
    other.keyframes[1].position.y() += pull;
    const SolveResult elsewhere = iqp()->solve(problem_of(other), {});
    for (const double share : {1e-3, 1e-2, 1e-1}) {  // the feasible set is convex
      const Stages between = (1 - share) * best.point.stages + share * elsewhere.point.stages;
      EXPECT_GT(problem.cost(between), best.report.cost);
    }
  }
}

TEST(Iqp, CurvedConstraintsConvergeInsideTheLimits) {
  Film film = crossing();
  film.norm = true;
  film.duration = film.keyframes.back().time = 7;  // fast enough for the limits to matter
  const TrajectoryProblem problem = problem_of(film);
  ASSERT_FALSE(problem.quadratic());
  const SolveResult result = iqp()->solve(problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  EXPECT_LE(result.report.iterations, 20);
  EXPECT_LT(result.report.violations.front().amount, 1e-5) << result.report.violations.front().row;
  for (std::size_t k = 2; k < result.report.history.size(); ++k)
    EXPECT_LE(result.report.history[k].violation,
              std::max(1e-6, result.report.history[1].violation));
}

// Limits on norms are convex. Without their curvature the first of these takes 16 programs and the
// others do not end within 50.
TEST(Iqp, TheCurvatureOfTightLimitsSavesPrograms) {
  for (const auto& [duration, most] : {std::pair{6.0, 12}, {5.0, 12}, {4.0, 12}}) {
    Film film = crossing();
    film.norm = true;
    film.duration = film.keyframes.back().time = duration;
    const SolveResult result = iqp()->solve(problem_of(film), {});
    EXPECT_EQ(result.report.status, SolveStatus::optimal) << duration << result.report.message;
    EXPECT_LE(result.report.iterations, most) << duration;
  }
}

TEST(Iqp, NamesWhatAnImpossibleFilmMissesAndWhatStandsInTheWay) {
  Film film = crossing();
  film.hard = true;
  film.keyframes[1] = keyframe(3.33, {60, 0, 5});  // 60 m in 3.33 s at 10 m/s
  const TrajectoryProblem problem = problem_of(film);
  const SolveResult result = iqp()->solve(problem, {});
  EXPECT_EQ(result.report.status, SolveStatus::infeasible);
  EXPECT_NE(result.report.message.find("hard_keyframe"), std::string::npos)
      << result.report.message;
  EXPECT_NE(result.report.message.find("limited by "), std::string::npos) << result.report.message;
  EXPECT_EQ(result.report.violations.front().name, "hard_keyframe");
  EXPECT_NEAR(result.report.violations.front().time, 3.33, 1e-9);
  // The trajectory is as near as the limits allow: all else holds.
  const Certificate certificate = certify(film, problem, result);
  EXPECT_FALSE(certificate.feasible());
  EXPECT_EQ(failures(certificate), "keyframe_miss ");
}

// Soft keyframes beyond the vehicle: bounds hold nearly everywhere, and the answer comes near.
TEST(Iqp, FlownToTheLimitsEverywhere) {
  for (const double reach : {2.0, 4.0, 40.0, 400.0})
    for (const double step : {0.05, 0.1}) {
      const Film film{
          .keyframes = {keyframe(0, {0, 0, 2}), keyframe(1, {reach, 0, 2}), keyframe(2, {0, 0, 2})},
          .duration = 2,
          .step = step};
      const TrajectoryProblem problem = problem_of(film);
      const SolveResult result = iqp()->solve(problem, {});
      EXPECT_EQ(result.report.status, SolveStatus::optimal)
          << reach << " m, step " << step << ": " << result.report.message;
      EXPECT_EQ(failures(certify(film, problem, result)), "keyframe_miss ") << reach;
    }
}

TEST(Iqp, WarmStartFromTheAnswerKeepsIt) {
  const TrajectoryProblem problem = problem_of(crossing());
  const SolveResult first = iqp()->solve(problem, {});
  SolveRequest request;
  request.warm_start = first.point;
  const SolveResult second = iqp()->solve(problem, request);
  EXPECT_EQ(second.report.status, SolveStatus::optimal);
  EXPECT_NEAR(second.report.cost, first.report.cost, 1e-6 * (1 + first.report.cost));
}

TEST(Iqp, StopsWhenCancelledOutOfIterationsOrOutOfTime) {
  Film film = crossing();
  film.norm = true;
  const TrajectoryProblem problem = problem_of(film);
  CancellationToken token;
  token.cancel();
  SolveRequest cancelled;
  cancelled.cancellation = &token;
  EXPECT_EQ(iqp()->solve(problem, cancelled).report.status, SolveStatus::cancelled);
  SolveRequest none;
  none.iteration_limit = 0;
  const SolveResult guess = iqp()->solve(problem, none);
  EXPECT_EQ(guess.report.status, SolveStatus::iteration_limit);
  // The guess, but for the ends, which are moved to rest.
  const Eigen::Index inner = guess.point.stages.cols() - 2;
  EXPECT_EQ(guess.point.stages.middleCols(1, inner), problem.initial_guess().middleCols(1, inner));
  SolveRequest late;
  late.wall_clock_guard = 0.0;
  EXPECT_EQ(iqp()->solve(problem, late).report.status, SolveStatus::time_limit);
}

TEST(Iqp, EqualProblemsGiveEqualBytes) {
  const SolveResult a = iqp()->solve(problem_of(crossing()), {});
  const SolveResult b = iqp()->solve(problem_of(crossing()), {});
  EXPECT_EQ(a.point.stages, b.point.stages);
}

// Awkward keyframes: one alone, a pause, collinear ones, two 0.05 s apart.
TEST(Iqp, AwkwardKeyframesWork) {
  const std::vector<Film> films = {
      {.keyframes = {keyframe(5, {1, 2, 3})}},
      {.keyframes = {keyframe(0, {0, 0, 2}), keyframe(4, {3, 0, 2}), keyframe(7, {3, 0, 2}),
                     keyframe(10, {6, 0, 2})}},
      {.keyframes = {keyframe(0, {0, 0, 2}), keyframe(5, {4, 4, 4}), keyframe(10, {8, 8, 6})}},
      {.keyframes = {keyframe(0, {0, 0, 2}), keyframe(5, {4, 0, 2}), keyframe(5.05, {4.1, 0, 2}),
                     keyframe(10, {8, 0, 2})}}};
  for (std::size_t k = 0; k < films.size(); ++k) {
    const TrajectoryProblem problem = problem_of(films[k]);
    const SolveResult result = iqp()->solve(problem, {});
    EXPECT_EQ(result.report.status, SolveStatus::optimal) << "film " << k;
    const Certificate certificate = certify(films[k], problem, result);
    EXPECT_TRUE(certificate.feasible()) << "film " << k << ": " << failures(certificate);
  }
}

}  // namespace
}  // namespace lapwing
