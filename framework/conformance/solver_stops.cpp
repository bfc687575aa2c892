// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/solver_stops.h"

#include <chrono>

#include "framework/conformance/solver_shelf.h"

namespace lapwing {
namespace {

constexpr int kToStop = 12;       // evaluations that a solver may still make once it is to stop
constexpr int kOfIteration = 20;  // evaluations that one iteration may take
constexpr double kPause = 0.01;   // s, of one evaluation
constexpr double kGuard = 0.05;   // s

class CancelAtReport final : public Progress {
 public:
  explicit CancelAtReport(SolverWatch& watch) : watch_(watch) {}
  void report(double, const std::string&) override {
    if (++reports_ != 2) return;
    watch_.token.cancel();
    at_ = watch_.calls;
  }
  int at() const { return at_; }

 private:
  SolverWatch& watch_;
  int reports_ = 0, at_ = -1;
};

class SolverStops {
 public:
  SolverStops(const TrajectorySolver& solver, Findings& findings)
      : solver_(solver), findings_(findings) {}

  void run() {
    SolverWatch watch;
    const SolveResult whole = solve(watch, {});
    if (whole.report.status == SolveStatus::unsupported && !quadratic_) {
      quadratic_ = true;
      return run();
    }
    if (whole.report.status == SolveStatus::unsupported) return;
    all_ = watch.calls;
    findings_.expect("work limit", all_ <= kOfIteration * (whole.report.iterations + 1), [&] {
      return "it reports " + std::to_string(whole.report.iterations) +
             " iterations of a solve with " + std::to_string(all_) + " evaluations of a term";
    });
    limited();
    cancelled_in_a_term();
    cancelled_by_progress();
    out_of_time();
  }

 private:
  SolveResult solve(SolverWatch& watch, SolveRequest request) const {
    const TrajectoryProblem problem =
        quadratic_ ? watched_quadratic_problem(watch) : watched_problem(watch);
    watch.calls = 0;
    request.cancellation = &watch.token;
    return solver_.solve(problem, request);
  }

  void limited() {
    SolverWatch watch;
    SolveRequest request;
    request.iteration_limit = 1;
    solve(watch, request);
    findings_.expect("work limit", watch.calls <= 2 * kOfIteration, [&] {
      return "one iteration was allowed, and a term is evaluated " + std::to_string(watch.calls) +
             " times";
    });
  }

  void cancelled_in_a_term() {
    SolverWatch watch;
    watch.cancel_after = 3;
    const SolveResult result = solve(watch, {});
    stopped("cancellation", "cancelled after 3 evaluations", watch.cancel_after, watch, result,
            SolveStatus::cancelled);
  }

  void cancelled_by_progress() {
    SolverWatch watch;
    CancelAtReport progress(watch);
    SolveRequest request;
    request.progress = &progress;
    const SolveResult result = solve(watch, request);
    if (progress.at() < 0) return;  // it tells of none, or ended before
    stopped("cancellation", "cancelled when it told of its progress", progress.at(), watch, result,
            SolveStatus::cancelled);
  }

  // Every evaluation sleeps, so that the guard passes after five of them.
  void out_of_time() {
    for (const double guard : {0.0, kGuard}) {
      if (findings_.failed("wall clock")) return;
      SolverWatch watch;
      watch.pause = kPause;
      SolveRequest request;
      request.wall_clock_guard = guard;
      const SolveResult result = solve(watch, request);
      stopped("wall clock",
              guard == 0 ? "without any time" : "with 0.05 s for evaluations of 0.01 s",
              static_cast<int>(guard / kPause), watch, result, SolveStatus::time_limit);
    }
  }

  // It must make no more than some evaluations after `begun`, and say why it ended, unless it would
  // have come to its end by then.
  void stopped(const char* check, const std::string& how, int begun, const SolverWatch& watch,
               const SolveResult& result, SolveStatus expected) {
    const int after = watch.calls - begun;
    findings_.expect(check, after <= kToStop, [&] {
      return how + ", it makes " + std::to_string(after) + " more evaluations";
    });
    if (all_ <= begun + kToStop && begun > 0) return;
    findings_.expect(check, result.report.status == expected,
                     [&] { return how + ", it says " + to_string(result.report.status); });
  }

  const TrajectorySolver& solver_;
  Findings& findings_;
  bool quadratic_ = false;
  int all_ = 0;
};

}  // namespace

void check_solver_stops(const TrajectorySolver& solver, Findings& findings) {
  SolverStops(solver, findings).run();
}

}  // namespace lapwing
