// SPDX-License-Identifier: Apache-2.0
// What every tour solver must pass.
#include <chrono>
#include <cmath>

#include "framework/conformance/differences.h"
#include "framework/conformance/every_case.h"
#include "framework/conformance/tour_worlds.h"

namespace lapwing {
namespace {

constexpr double kEqual = 1e-6;  // of a score

// Asks a solver's own search, before the kernel looks at what comes back and mends it.
class OwnTour : public TourSolver {
 public:
  using Answer = Search;
  static Answer of(const TourSolver& solver, const TourProblem& problem, TourWork& work) {
    return (solver.*(&OwnTour::search))(problem, work);
  }
};

// Cancels at the first report, and counts them.
class Listener final : public Progress {
 public:
  void report(double, const std::string&) override {
    ++reports;
    if (token) token->cancel();
  }
  int reports = 0;
  CancellationToken* token = nullptr;
};

// What is wrong with the walks of a team, by the definitions alone; "" for nothing.
std::string fault_of_walks(const TeamWorld& world, const Walks& walks) {
  if (walks.size() != world.tours.size()) return "are not as many as the tours";
  for (std::size_t t = 0; t < walks.size(); ++t) {
    const std::string fault = fault_of_walk(world.tours[t], walks[t]);
    if (!fault.empty()) return "of tour " + std::to_string(t + 1) + " " + fault;
  }
  return "";
}

// What a solver with the extension `takes_teams` makes of teams, and one without it.
class TeamCheck {
 public:
  TeamCheck(const TourSolver& solver, bool declares, Findings& findings)
      : solver_(solver), declares_(declares), findings_(findings) {}

  void run(const std::vector<TeamWorld>& worlds) {
    for (const TeamWorld& world : worlds) {
      if (findings_.settled()) return;
      const TeamProblem problem = team_of(world);
      const TeamResult result = solver_.solve(problem);
      if (world.best >= 0 && !declares_) {
        findings_.expect("teams", result.report.status == TourStatus::unsupported, [&] {
          return world.name + ": it does not declare 'takes_teams', yet says " +
                 to_string(result.report.status);
        });
        continue;
      }
      answers(world, result);
      if (world.best > 0) {
        repeats(world, problem, result);
        begins(world, problem, result);
        stops(world, problem);
      }
    }
  }

 private:
  void answers(const TeamWorld& world, const TeamResult& result) {
    const TeamReport& report = result.report;
    const auto expect = [&](bool holds, const std::string& what) {
      findings_.expect("teams", holds, [&] { return world.name + ": " + what; });
    };
    expect(!report.message.empty(), "gives no reason");
    expect(report.status != TourStatus::failed, report.message);
    if (world.best < 0) {
      expect(report.status == TourStatus::infeasible,
             std::string("no tours exist, says ") + to_string(report.status));
      return;
    }
    expect(!result.walks.empty(), "declares 'takes_teams' and finds no tours: " + report.message);
    if (result.walks.empty()) return;
    const std::string fault = fault_of_walks(world, result.walks);
    expect(fault.empty(), "its walks " + fault);
    if (!fault.empty()) return;
    const double slack = kEqual * (1 + world.best);
    const double score = score_of_walks(world.tours.front(), result.walks);
    expect(std::abs(score - report.score) <= slack,
           "reports a score of " + text_of(report.score) + ", its walks have " + text_of(score));
    expect(
        report.upper_bound >= world.best - slack,
        "bound " + text_of(report.upper_bound) + " below the best tours' " + text_of(world.best));
    expect(report.status != TourStatus::optimal || score >= world.best - slack,
           "says optimal, and is not");
    expect(report.evaluations > 0, "reports no evaluation");
  }

  void repeats(const TeamWorld& world, const TeamProblem& problem, const TeamResult& first) {
    const TeamResult again = solver_.solve(problem), fresh = solver_.solve(team_of(world));
    findings_.expect("teams", again.walks == first.walks && fresh.walks == first.walks,
                     [&] { return world.name + ": another answer the second time"; });
  }

  // From its own answer it must not come to a worse one.
  void begins(const TeamWorld& world, const TeamProblem& problem, const TeamResult& first) {
    TeamRequest request;
    request.initial = first.walks;
    const TeamResult result = solver_.solve(problem, request);
    findings_.expect("teams", result.report.score >= first.report.score - kEqual, [&] {
      return world.name + ": begun with tours of " + text_of(first.report.score) + " it ends at " +
             text_of(result.report.score);
    });
  }

  void stops(const TeamWorld& world, const TeamProblem& problem) {
    CancellationToken token;
    token.cancel();
    TeamRequest request;
    request.limits.bound = false;
    request.limits.cancellation = &token;
    const TourStatus status = solver_.solve(problem, request).report.status;
    findings_.expect("teams", status == TourStatus::cancelled, [&] {
      return world.name + ": cancelled before it began, says " + to_string(status);
    });
  }

  const TourSolver& solver_;
  bool declares_;
  Findings& findings_;
};

class TourCheck {
 public:
  TourCheck(const TourSolver& solver, const CheckOptions& options, Findings& findings)
      : solver_(solver), options_(options), findings_(findings) {}

  // Whether tours must be found: with a parameter at the end of its range they need not be, but
  // what is said must be true.
  void run(bool right, const std::vector<TourWorld>& worlds) {
    const bool answers =
        options_.wants_any({"answers", "honest", "messages", "tours", "upper bound"});
    if (!right && !answers) return;
    for (const TourWorld& world : worlds) {
      if (findings_.settled()) return;
      const TourProblem problem(world.definition);
      TourRequest request;
      if (!right) request.iteration_limit = 200;
      const TourResult result = solver_.solve(problem, request);
      if (result.report.status == TourStatus::unsupported) continue;
      honest(world, result);
      if (!right) continue;
      if (options_.wants_any({"tours", "work"})) own_tour(world, problem);
      finds(world, result);
      if (options_.wants("repeatable")) repeatable(world, problem, request, result);
      if (options_.wants_any({"cancellation", "wall clock"})) stops(world, problem);
    }
    if (right && options_.wants("work"))
      findings_.expect("work", asks_, [] {
        return "in none of its searches it asks whether the work has to end";
      });
  }

 private:
  void honest(const TourWorld& world, const TourResult& result) {
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
    tour(world, result);
  }

  void tour(const TourWorld& world, const TourResult& result) {
    const TourReport& report = result.report;
    const double score = score_of_walk(world.definition, result.walk);
    const double slack = kEqual * (1 + std::abs(world.best));
    findings_.expect("upper bound", report.upper_bound >= world.best - slack, [&] {
      return world.name + ": bound " + text_of(report.upper_bound) + " below the best tour's " +
             text_of(world.best);
    });
    const bool optimal = report.status == TourStatus::optimal;
    findings_.expect("upper bound", !optimal || score >= world.best - slack,
                     [&] { return world.name + ": says optimal, and is not"; });
  }

  // The walk that the search itself returns, judged by the definition alone.
  void own_tour(const TourWorld& world, const TourProblem& problem) {
    if (world.best <= 0) return;  // nothing is searched
    TourRequest request;
    request.bound = false;
    request.iteration_limit = 50;
    request.evaluation_limit = 5000;
    Listener listener;
    request.progress = &listener;
    TourWork work(request);
    const OwnTour::Answer answer = OwnTour::of(solver_, problem, work);
    asks_ |= listener.reports > 0;
    if (answer.walk.empty()) return;
    const std::string fault = fault_of_walk(world.definition, answer.walk);
    findings_.expect("tours", fault.empty(), [&] { return world.name + ": its walk " + fault; });
    if (!fault.empty()) return;
    findings_.expect("work", answer.evaluations > 0 || answer.walk.size() < 2, [&] {
      return world.name + ": reports no evaluation of a tour of " +
             std::to_string(answer.walk.size()) + " views";
    });
    const double score = score_of_walk(world.definition, answer.walk);
    findings_.expect("tours", score <= world.best + kEqual * (1 + world.best), [&] {
      return world.name + ": a walk of " + text_of(score) + ", but enumeration finds at most " +
             text_of(world.best);
    });
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

  void stops(const TourWorld& world, const TourProblem& problem) {
    if (world.best <= 0) return;
    CancellationToken token;
    token.cancel();
    TourRequest request;
    request.bound = false;
    request.cancellation = &token;
    const TourResult cancelled = solver_.solve(problem, request);
    findings_.expect("cancellation", cancelled.report.status == TourStatus::cancelled, [&] {
      return world.name + ": cancelled before it began, says " + to_string(cancelled.report.status);
    });
    honest(world, cancelled);
    if (options_.wants("cancellation")) cancelled_within(world, problem);
    if (options_.wants("wall clock")) out_of_time(world, problem);
  }

  // Cancelled by who is told of the progress, after the search has begun.
  void cancelled_within(const TourWorld& world, const TourProblem& problem) {
    CancellationToken token;
    Listener listener;
    listener.token = &token;
    TourRequest request;
    request.bound = false;
    request.cancellation = &token;
    request.progress = &listener;
    TourWork work(request);
    const OwnTour::Answer answer = OwnTour::of(solver_, problem, work);
    if (listener.reports == 0) return;  // "work" says so
    const bool says =
        answer.status == TourStatus::cancelled || work.ending() == TourStatus::cancelled;
    findings_.expect("cancellation", says, [&] {
      return world.name + ": cancelled within its search, says " + to_string(answer.status);
    });
  }

  // The quickest of some tries, since other work may hold one up.
  void out_of_time(const TourWorld& world, const TourProblem& problem) {
    constexpr double kLate = 0.2;  // s, after a guard of none at all
    TourRequest request;
    request.bound = false;
    request.wall_clock_guard = 0;
    double quickest = HUGE_VAL;
    for (int turn = 0; turn < 4 && quickest > kLate; ++turn) {
      const auto began = std::chrono::steady_clock::now();
      const TourStatus status = solver_.solve(problem, request).report.status;
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
      quickest = std::min(quickest, took.count());
      findings_.expect("wall clock",
                       status == TourStatus::time_limit || status == TourStatus::optimal,
                       [&] { return world.name + ": out of time, says " + to_string(status); });
    }
    findings_.expect("wall clock", quickest <= kLate, [&] {
      return world.name + ": without any time it takes " + text_of(quickest) + " s";
    });
  }

  const TourSolver& solver_;
  const CheckOptions& options_;
  Findings& findings_;
  bool asks_ = false;  // whether the work has to end, in any search
};

}  // namespace

std::vector<CheckResult> check_tour_solver(const Specimen<TourSolver>& subject,
                                           const CheckOptions& options) {
  const std::vector<TourWorld> worlds = tour_worlds();
  const std::vector<TeamWorld> teams = team_worlds();
  return check_every_case(subject, options, "a search",
                          [&](const TourSolver& solver, Findings& findings, bool first) {
                            TourCheck(solver, options, findings).run(first, worlds);
                            if (first && options.wants("teams"))
                              TeamCheck(solver, subject.says(kTakesTeams), findings).run(teams);
                          });
}

}  // namespace lapwing
