// SPDX-License-Identifier: Apache-2.0
// A tour solver: the most information within a budget (thesis 4.1, 4.4.3). The plugin kind
// `tour_solver`.
//
// A solver reports, it never throws for what happens inside a search. Its work limits count
// evaluations of the score (one view's gain, loss, adding or removing) and iterations, so that
// results repeat; the wall-clock guard is a guard. The same problem, parameters, seed and limits
// give the same tour.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/core/progress.h"
#include "framework/core/value.h"
#include "framework/view/team_problem.h"

namespace lapwing {

struct TourRequest {
  std::uint64_t seed = 1;
  // Where to begin: a tour of this problem. The answer is never worse.
  std::optional<std::vector<int>> initial = std::nullopt;
  std::optional<std::int64_t> evaluation_limit = std::nullopt;
  // Absent: the solver's own parameter, where it has one.
  std::optional<std::int64_t> iteration_limit = std::nullopt;
  std::optional<double> wall_clock_guard = std::nullopt;  // s
  bool bound = true;  // whether to compute the upper bound; it is no part of the work
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
};

enum class TourStatus {
  optimal,     // the upper bound is reached
  feasible,    // a tour within the budget; the solver came to its own end
  infeasible,  // there is no tour, or none with any information; `message` says what was reachable
  iteration_limit,  // the limit of the request ended it; the best so far, if there is one
  time_limit,       // likewise
  cancelled,        // likewise
  unsupported,      // the solver does not take problems of this kind or size
  failed,           // the solver broke its promise or threw; `message` says how
};
const char* to_string(TourStatus status);

struct TourReport {
  TourStatus status = TourStatus::failed;
  std::string message;  // one sentence
  double score = 0;
  double seconds_used = 0;     // of the budget
  int images = 0;              // different views
  int reachable = 0;           // views near enough for the budget
  double reachable_score = 0;  // of all of those together
  double upper_bound = 0;      // no tour scores more; infinite where it was not asked for
  double gap = 0;              // (upper bound - score) / upper bound
  std::int64_t evaluations = 0;
  std::int64_t iterations = 0;
  double wall_seconds = 0;  // never written into plan.json
};
// Without the wall-clock figure.
Value to_value(const TourReport& report, const std::string& solver_name);

struct TourResult {
  TourReport report;
  // Views from start to end, as TourProblem::problem_of wants it; empty where there is none.
  std::vector<int> walk;
};

struct TeamRequest {
  TourRequest limits = {};  // its `initial` is not looked at
  // Where to begin: walks of this problem. The answer is never worse.
  std::optional<Walks> initial = std::nullopt;
};

struct TeamTourReport {
  std::string name;
  double seconds_used = 0, budget = 0;  // s
  int images = 0;                       // different views on this tour
};

// As of one tour: seconds are those of all tours, images their different views.
struct TeamReport : TourReport {
  std::vector<TeamTourReport> tours;
};
Value to_value(const TeamReport& report, const std::string& solver_name);

struct TeamResult {
  TeamReport report;
  Walks walks;  // as TeamProblem::problem_of wants them; empty where there are none
};

// The extension (plugin/plugin.h) of a solver that takes team problems; it has no table.
inline constexpr const char* kTakesTeams = "takes_teams";

// What ends a search from outside, asked between units of work.
class TourWork {
 public:
  explicit TourWork(const TourRequest& request);

  // True once the search has to end; stays true. `evaluations` and `iterations` so far, which the
  // request's progress is told now and then.
  bool ended(std::int64_t evaluations, std::int64_t iterations = 0);
  std::optional<TourStatus> ending() const { return ending_; }
  // The iterations after which the solver ends by itself: for telling how far it has come.
  void expect(std::int64_t iterations) { expected_ = iterations; }
  // How much of its limits is used, in [0, 1]; 0 without limits.
  double share_used(std::int64_t evaluations, std::int64_t iterations) const;
  double seconds() const;  // since it was made
  const TourRequest& request() const { return *request_; }

 private:
  const TourRequest* request_;
  std::chrono::steady_clock::time_point began_;
  std::optional<TourStatus> ending_;
  std::int64_t expected_ = 0;
  int asked_ = 0;
};

class TourSolver : public PluginObject {
 public:
  using Interface = TourSolver;
  static constexpr const char* kKind = "tour_solver";
  virtual ~TourSolver() = default;

  // Says what cannot be met, searches, checks the walk that comes back, keeps the initial tour
  // where it is better, and adds the upper bound. Thread-safe.
  TourResult solve(const TourProblem& problem, const TourRequest& request = {}) const;
  // The same of a team; `unsupported` from a solver that does not declare kTakesTeams.
  TeamResult solve(const TeamProblem& problem, const TeamRequest& request = {}) const;

 protected:
  struct Search {
    std::vector<int> walk;  // empty: none found
    // `feasible` at the solver's own end, else what ended it, or `unsupported`.
    TourStatus status = TourStatus::feasible;
    std::string message;
    std::int64_t evaluations = 0;
    std::int64_t iterations = 0;
    std::optional<double> upper_bound = std::nullopt;  // a proof of its own
  };
  // There is a tour: start and end are joined within the budget. `initial` is sound.
  virtual Search search(const TourProblem& problem, TourWork& work) const = 0;

  struct TeamSearch {
    Walks walks;  // empty: none found
    TourStatus status = TourStatus::feasible;
    std::string message;
    std::int64_t evaluations = 0;
    std::int64_t iterations = 0;
    std::optional<double> upper_bound = std::nullopt;
  };
  // Every tour can be flown; `initial`, null for none, is sound.
  virtual TeamSearch search_team(const TeamProblem& problem, TourWork& work,
                                 const Walks* initial) const;
};

}  // namespace lapwing
