// SPDX-License-Identifier: Apache-2.0
// What a general solver must do on films, whatever its method: the tests of each solver call these.
#pragma once

#include "tests/plugins/trajectory_solvers/film_problem.h"

namespace lapwing {

inline SolveResult solve(const char* solver, const TrajectoryProblem& problem,
                         const SolveRequest& request = {}, const Value& parameters = Value::map()) {
  return built_plugins().create<TrajectorySolver>(solver, parameters)->solve(problem, request);
}

inline std::string failed_checks(const Film& film, const TrajectoryProblem& problem,
                                 const SolveResult& result) {
  std::string text;
  for (const Check& check : certify(film, problem, result).failures()) text += check.name + " ";
  return text;
}

// Five seconds, fast enough for the norm of the force to matter.
inline Film hurried(bool hard = false) {
  Film film = crossing();
  film.norm = true;
  film.hard = hard;
  film.duration = film.keyframes.back().time = 7;
  if (!hard) return film;
  for (KeyframeTask& k : film.keyframes) k.tolerance = 1e-4;
  return film;
}

// 60 m in 3.33 s at 10 m/s.
inline Film impossible() {
  Film film = crossing();
  film.hard = true;
  film.keyframes[1] = keyframe(3.33, {60, 0, 5});
  return film;
}

// The same optimum as iqp's, which ends within 1 % of it, or a better one; certified.
inline void expect_the_optimum(const char* solver, const Film& film, double relative) {
  const TrajectoryProblem problem = problem_of(film);
  const SolveResult ours = solve(solver, problem);
  const SolveResult other = solve("iqp", problem);
  EXPECT_EQ(ours.report.status, SolveStatus::optimal) << ours.report.message;
  ASSERT_EQ(other.report.status, SolveStatus::optimal) << other.report.message;
  EXPECT_LE(ours.report.cost, (1 + relative) * other.report.cost);
  EXPECT_GE(ours.report.cost, 0.99 * other.report.cost);
  EXPECT_LE(ours.report.violations.front().amount, 1e-6) << ours.report.violations.front().row;
  EXPECT_EQ(failed_checks(film, problem, ours), "");
  ASSERT_FALSE(ours.report.history.empty());
  EXPECT_EQ(ours.report.history.back().terms.size(), ours.report.terms.size());
}

// Says so, names what is missed and where, and keeps to everything else.
inline void expect_infeasible(const char* solver) {
  const TrajectoryProblem problem = problem_of(impossible());
  const SolveResult result = solve(solver, problem);
  EXPECT_EQ(result.report.status, SolveStatus::infeasible) << result.report.message;
  EXPECT_NE(result.report.message.find("hard_keyframe.position.x at "), std::string::npos)
      << result.report.message;
  EXPECT_NE(result.report.message.find("is violated by"), std::string::npos)
      << result.report.message;
  EXPECT_EQ(result.report.violations.front().name, "hard_keyframe");
  EXPECT_EQ(failed_checks(impossible(), problem, result), "keyframe_miss ");
}

// Ends the work at its nth report.
class Interruption final : public Progress {
 public:
  explicit Interruption(int at) : left_(at) {}
  void report(double, const std::string&) override {
    if (--left_ == 0) token.cancel();
    ++reports;
  }
  CancellationToken token;
  int reports = 0;

 private:
  int left_;
};

inline void expect_it_stops(const char* solver) {
  const TrajectoryProblem problem = problem_of(hurried());
  Interruption interruption(4);
  SolveRequest request;
  request.cancellation = &interruption.token;
  request.progress = &interruption;
  const SolveResult cancelled = solve(solver, problem, request);
  EXPECT_EQ(cancelled.report.status, SolveStatus::cancelled);
  EXPECT_LE(interruption.reports, 5) << "went on after it was told to stop";
  EXPECT_TRUE(cancelled.point.stages.allFinite());
  for (const int limit : {0, 1, 3}) {
    SolveRequest limited;
    limited.iteration_limit = limit;
    const SolveResult result = solve(solver, problem, limited);
    EXPECT_EQ(result.report.status, SolveStatus::iteration_limit) << limit;
    EXPECT_LE(result.report.iterations, limit);
    EXPECT_TRUE(result.point.stages.allFinite());
  }
  SolveRequest late;
  late.wall_clock_guard = 0.0;
  EXPECT_EQ(solve(solver, problem, late).report.status, SolveStatus::time_limit);
}

// From its own answer, and from that to a film of which one keyframe has moved.
inline void expect_warm_starts_to_help(const char* solver) {
  const TrajectoryProblem problem = problem_of(hurried());
  const SolveResult cold = solve(solver, problem);
  SolveRequest warm;
  warm.warm_start = cold.point;
  const SolveResult again = solve(solver, problem, warm);
  EXPECT_EQ(again.report.status, SolveStatus::optimal);
  EXPECT_LT(again.report.iterations, cold.report.iterations);
  EXPECT_NEAR(again.report.cost, cold.report.cost, 1e-5 * cold.report.cost);
  Film moved = hurried();
  moved.keyframes[1].position.y() += 0.1;
  const SolveResult near = solve(solver, problem_of(moved), warm);
  EXPECT_EQ(near.report.status, SolveStatus::optimal);
  EXPECT_LT(near.report.iterations, cold.report.iterations);
}

inline void expect_equal_bytes(const char* solver) {
  const SolveResult a = solve(solver, problem_of(hurried()));
  const SolveResult b = solve(solver, problem_of(hurried()));
  EXPECT_EQ(a.point.stages, b.point.stages);
  EXPECT_EQ(a.report.iterations, b.report.iterations);
}

inline void expect_silence(const char* solver) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  solve(solver, problem_of(crossing()));
  solve(solver, problem_of(impossible()));
  std::fflush(nullptr);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// A film whose ends contradict each other before anything is solved.
inline void expect_crossed_bounds_to_be_named(const char* solver) {
  TrajectoryProblem problem(solo(), {.stages = 20, .step = 0.1});
  problem.add_model("quadrotor", built_plugins().create<VehicleModel>("quadrotor"));
  for (const auto& [name, yaw] : {std::pair{"here", 0.0}, {"there", 1.0}})
    problem.add_constraint(
        name, built_plugins().create<Constraint>("boundary_state", table({{"start_yaw", yaw}})));
  problem.add_cost("snap", 1.0,
                   built_plugins().create<CostTerm>("derivative", table({{"order", 4}})));
  problem.set_path_guess({0}, {{0, 0, 2}}, {0});
  problem.finish();
  const SolveResult result = solve(solver, problem);
  EXPECT_EQ(result.report.status, SolveStatus::infeasible);
  EXPECT_NE(result.report.message.find("yaw at 0 s must be at least 1 and at most 0"),
            std::string::npos)
      << result.report.message;
}

}  // namespace lapwing
