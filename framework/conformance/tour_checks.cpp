// What every tour solver must pass.
#include <cmath>

#include "framework/conformance/every_case.h"
#include "framework/conformance/tour_worlds.h"

namespace lapwing {
namespace {

constexpr double kEqual = 1e-6;  // of a score

class TourCheck {
 public:
  TourCheck(const TourSolver& solver, const CheckOptions& options, Findings& findings)
      : solver_(solver), options_(options), findings_(findings) {}

  // Whether tours must be found: with a parameter at the end of its range they need not be, but
  // what is said must be true.
  void run(bool right, const std::vector<TourWorld>& worlds) {
    const bool answers = options_.wants_any({"answers", "honest", "messages", "tours",
                                             "reported score", "reported seconds", "upper bound"});
    if (!right && !answers) return;
    for (const TourWorld& world : worlds) {
      const TourProblem problem(world.definition);
      TourRequest request;
      if (!right) request.iteration_limit = 200;
      const TourResult result = solver_.solve(problem, request);
      if (result.report.status == TourStatus::unsupported) continue;
      honest(world, problem, result);
      if (!right) continue;
      finds(world, result);
      if (options_.wants("repeatable")) repeatable(world, problem, request, result);
      if (options_.wants("initial tour")) never_worse(world, problem);
      if (options_.wants_any({"cancellation", "wall clock"})) stops(world, problem);
    }
  }

 private:
  void honest(const TourWorld& world, const TourProblem& problem, const TourResult& result) {
    const TourReport& report = result.report;
    findings_.expect("messages", !report.message.empty(),
                     [&] { return world.name + ": gives no reason"; });
    findings_.expect("honest", report.status != TourStatus::failed,
                     [&] { return world.name + ": " + report.message; });
    const bool claims =
        report.status == TourStatus::optimal || report.status == TourStatus::feasible;
    findings_.expect("honest", !claims || !result.walk.empty(), [&] {
      return world.name + ": says " + to_string(report.status) + " and has no tour";
    });
    findings_.expect("honest", world.best >= 0 || report.status == TourStatus::infeasible, [&] {
      return world.name + ": there is no tour, says " + to_string(report.status);
    });
    if (result.walk.empty()) return;
    tour(world, problem, result);
  }

  void tour(const TourWorld& world, const TourProblem& problem, const TourResult& result) {
    const TourReport& report = result.report;
    const std::string wrong = problem.problem_of(result.walk);
    findings_.expect("tours", wrong.empty(), [&] { return world.name + ": " + wrong; });
    if (!wrong.empty()) return;
    const double score = problem.score_of(result.walk), seconds = problem.seconds_of(result.walk);
    findings_.expect("reported score", report.score == score, [&] {
      return world.name + ": reports " + std::to_string(report.score) + " of a tour of " +
             std::to_string(score);
    });
    findings_.expect("reported seconds", report.seconds_used == seconds, [&] {
      return world.name + ": reports " + std::to_string(report.seconds_used) + " s of a tour of " +
             std::to_string(seconds) + " s";
    });
    const double slack = kEqual * (1 + std::abs(world.best));
    findings_.expect("tours", score <= world.best + slack, [&] {
      return world.name + ": scores " + std::to_string(score) + " where the best is " +
             std::to_string(world.best);
    });
    findings_.expect("upper bound", report.upper_bound >= world.best - slack, [&] {
      return world.name + ": bound " + std::to_string(report.upper_bound) +
             " below the best tour's " + std::to_string(world.best);
    });
    const bool optimal = report.status == TourStatus::optimal;
    findings_.expect("upper bound", !optimal || score >= world.best - slack,
                     [&] { return world.name + ": says optimal, and is not"; });
  }

  void finds(const TourWorld& world, const TourResult& result) {
    if (world.best <= 0) return;
    findings_.expect("answers", !result.walk.empty(),
                     [&] { return world.name + ": finds no tour: " + result.report.message; });
  }

  void repeatable(const TourWorld& world, const TourProblem& problem, const TourRequest& request,
                  const TourResult& first) {
    const TourResult again = solver_.solve(problem, request);
    const bool same = again.walk == first.walk && again.report.status == first.report.status &&
                      again.report.evaluations == first.report.evaluations;
    findings_.expect("repeatable", same,
                     [&] { return world.name + ": another answer the second time"; });
    // Ways that were searched before change nothing.
    const TourProblem fresh(world.definition);
    findings_.expect("repeatable", solver_.solve(fresh, request).walk == first.walk,
                     [&] { return world.name + ": another answer for a fresh problem"; });
  }

  void never_worse(const TourWorld& world, const TourProblem& problem) {
    // The best pair of views there and back, by trying: as an initial tour not nothing.
    std::vector<int> initial;
    double best = -1;
    for (int v = 0; v < problem.views() && world.best > 0; ++v) {
      std::vector<int> walk{problem.start()};
      if (!std::isfinite(problem.leg(problem.start(), v))) continue;
      problem.append_way(problem.start(), v, walk);
      problem.append_way(v, problem.end(), walk);
      if (!problem.problem_of(walk).empty() || problem.score_of(walk) <= best) continue;
      best = problem.score_of(walk);
      initial = walk;
    }
    if (initial.empty()) return;
    for (const std::int64_t limit : {1, 5, 1'000'000}) {
      TourRequest request;
      request.initial = initial;
      request.evaluation_limit = limit;
      if (limit > 5) request.iteration_limit = 50;
      const TourResult result = solver_.solve(problem, request);
      findings_.expect("initial tour", result.report.score >= best, [&] {
        return world.name + ": from a tour of " + std::to_string(best) + " to one of " +
               std::to_string(result.report.score) + " (" + result.report.message + ")";
      });
    }
  }

  void stops(const TourWorld& world, const TourProblem& problem) {
    if (world.best <= 0) return;
    CancellationToken token;
    token.cancel();
    TourRequest request;
    request.cancellation = &token;
    const TourResult cancelled = solver_.solve(problem, request);
    findings_.expect("cancellation", cancelled.report.status == TourStatus::cancelled, [&] {
      return world.name + ": cancelled before it began, says " + to_string(cancelled.report.status);
    });
    honest(world, problem, cancelled);
    request.cancellation = nullptr;
    request.wall_clock_guard = 0;
    const TourResult late = solver_.solve(problem, request);
    const TourStatus status = late.report.status;
    findings_.expect("wall clock",
                     status == TourStatus::time_limit || status == TourStatus::optimal,
                     [&] { return world.name + ": out of time, says " + to_string(status); });
  }

  const TourSolver& solver_;
  const CheckOptions& options_;
  Findings& findings_;
};

}  // namespace

std::vector<CheckResult> check_tour_solver(const Specimen<TourSolver>& subject,
                                           const CheckOptions& options) {
  const std::vector<TourWorld> worlds = tour_worlds();
  return check_every_case(subject, options, "a search",
                          [&](const TourSolver& solver, Findings& findings, bool first) {
                            TourCheck(solver, options, findings).run(first, worlds);
                          });
}

}  // namespace lapwing
