// SPDX-License-Identifier: Apache-2.0
// Large neighbourhood search with simulated annealing: a tour is partly removed and repaired, again
// and again.
//
// How: each iteration starts from the current tour. `ruin` removes some views (a stretch of the
// walk, neighbours, or random ones), or `exchange` inserts a cluster of views beyond the budget and
// removes the views of least worth per second. The order is shortened by 2-opt and or-opt. Then
// views are inserted by gain per second, with random factors, until none fits (greedy_growth.h). A
// tour of higher value becomes the current one. One of lower value does so with the probability
// exp(change / heat), where the heat falls with the work done. The value is the score, and a part
// of the mean score per second for what is left of the budget.
//
// Gains are estimates between evaluations (KnownGains): the gain of a view rises only when a view
// that shares voxels with it leaves the tour. The result is the best tour of all, so it is at least
// as good as the first one: the initial tour, or that of recursive greedy (recursive_growth.h).
//
//   tour: {solver: local_search, iterations: 2000}
#include <algorithm>
#include <cmath>

#include "framework/plugin/plugin.h"
#include "framework/view/greedy_growth.h"
#include "framework/view/recursive_growth.h"
#include "plugins/tour_solvers/local_search/ruin.h"
#include "plugins/tour_solvers/local_search/team_annealing.h"

namespace lapwing {
namespace {

using Settings = AnnealingSettings;

constexpr int kMostOut = 30;
constexpr double kColdest = 0.02;   // of the warmth, at the end
constexpr double kRoomWorth = 0.3;  // of the tour's own score per second: what room is worth

class Annealing {
 public:
  Annealing(const TourProblem& problem, const Settings& settings, TourWork& work)
      : problem_(problem),
        settings_(settings),
        work_(work),
        random_(work.request().seed),
        overlaps_(problem.score()),
        known_{gains_alone(problem), &overlaps_},
        current_(problem),
        favour_(problem.views(), 1.0) {}

  void run() {
    if (work_.request().initial) {
      current_.become(*work_.request().initial);
      best_walk_ = *work_.request().initial;
      best_score_ = problem_.score_of(best_walk_);
    } else {
      RecursiveTour first = grow_recursively(problem_, work_);
      evaluations_ = first.evaluations;
      best_score_ = first.score;
      current_.become(first.walk);
      current_.state().set_evaluations(evaluations_);
      best_walk_ = std::move(first.walk);
    }
    work_.expect(settings_.iterations);
    fill(current_, {.by_ratio = true});
    keep(current_);
    WorkingTour trial = current_;
    while (iterations_ < settings_.iterations && !stop()) {
      ++iterations_;
      change(trial);
      if (accepted(trial)) {
        keep(trial);
        std::swap(current_, trial);
        current_.state().set_evaluations(evaluations_);
      }
      trial = current_;
      trial.state().set_evaluations(evaluations_);
    }
  }

  std::int64_t evaluations() const { return evaluations_; }
  std::int64_t iterations() const { return iterations_; }
  const std::vector<int>& best_walk() const { return best_walk_; }

 private:
  bool stop() { return work_.ended(evaluations_, iterations_); }

  double share_done() const {
    const double own = static_cast<double>(iterations_) / static_cast<double>(settings_.iterations);
    return std::max(own, work_.share_used(evaluations_, iterations_));
  }

  // Puts in what fits, shortens, and again.
  void fill(WorkingTour& tour, const GreedyGrowth& growth) {
    grow(tour, known_.gains, growth, work_, iterations_);
    while (tour.shorten()) {
      const int before = tour.images();
      grow(tour, known_.gains, growth, work_, iterations_);
      if (tour.images() == before) break;
    }
    evaluations_ = tour.state().evaluations();
  }

  void change(WorkingTour& tour) {
    const int most = std::clamp(static_cast<int>(settings_.share * tour.images()), 2, kMostOut);
    const int count = static_cast<int>(random_.integer(1, most));
    if (random_.uniform() >= settings_.exchanges || !exchange(tour, count, known_, random_)) {
      ruin(tour, count, known_, random_);
    }
    tour.shorten();
    for (double& factor : favour_) factor = std::exp(settings_.chance * random_.uniform(-1, 1));
    fill(tour, {.by_ratio = true, .favour = favour_, .patience = settings_.patience});
  }

  // Room is worth something: views may come in for it later.
  double value(const WorkingTour& tour) const {
    const double per_second = best_score_ / std::max(1e-9, problem_.budget());
    return tour.score() + kRoomWorth * per_second * tour.room();
  }

  bool accepted(const WorkingTour& trial) {
    if (trial.room() < 0) return false;
    const double change = value(trial) - value(current_);
    const double unit = best_score_ / std::max(1, current_.images());
    const double heat = settings_.warmth * unit * std::pow(kColdest, share_done());
    return change >= 0 || random_.uniform() < std::exp(change / heat);
  }

  void keep(const WorkingTour& tour) {
    const bool allowed = !problem_.image_limit() || tour.images() <= *problem_.image_limit();
    if (tour.score() <= best_score_ || tour.room() < 0 || !allowed) return;
    best_score_ = tour.score();
    best_walk_ = tour.finished();
  }

  const TourProblem& problem_;
  const Settings& settings_;
  TourWork& work_;
  Random random_;
  Overlaps overlaps_;
  KnownGains known_;
  WorkingTour current_;
  std::vector<double> favour_;
  std::vector<int> best_walk_;
  double best_score_ = -1;
  std::int64_t evaluations_ = 0, iterations_ = 0;
};

class LocalSearch final : public TourSolver {
 public:
  static constexpr PluginText kText{"local_search", "1.0.0",
                                    "large neighbourhood search with simulated annealing", ""};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("iterations", 2000, "number of removals and repairs", between(1, 100'000'000))
        .number("share", 0.25, "", "largest fraction of the views that is removed at once",
                between(0.01, 1))
        .number("warmth", 1.0, "", "initial temperature, in mean gains of a view",
                between(1e-3, 100))
        .number("exchanges", 0.3, "",
                "fraction of iterations that first insert views beyond the budget", between(0, 1))
        .number("chance", 0.5, "", "random spread of estimated gains; 0: always the best",
                between(0, 5))
        .integer("patience", 12, "largest number of evaluations per choice", between(1, 100'000));
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kTakesTeams, nullptr}};
    return all;
  }
  explicit LocalSearch(const Parameters& parameters)
      : settings_{
            parameters.integer("iterations"), parameters.number("share"),
            parameters.number("warmth"),      parameters.number("exchanges"),
            parameters.number("chance"),      static_cast<int>(parameters.integer("patience"))} {}

 protected:
  Search search(const TourProblem& problem, TourWork& work) const override {
    Annealing annealing(problem, settings_, work);
    annealing.run();
    Search result;
    result.walk = annealing.best_walk();
    result.status = work.ending().value_or(TourStatus::feasible);
    result.message = "the best of " + std::to_string(annealing.iterations()) + " repaired tours";
    if (work.ending()) result.message = "ended early, " + result.message;
    result.evaluations = annealing.evaluations();
    result.iterations = annealing.iterations();
    return result;
  }

  TeamSearch search_team(const TeamProblem& problem, TourWork& work,
                         const Walks* initial) const override {
    AnnealedTeam found = anneal_team(problem, settings_, work, initial);
    TeamSearch result;
    result.walks = std::move(found.walks);
    result.status = work.ending().value_or(TourStatus::feasible);
    result.message = "the best of " + std::to_string(found.iterations) + " repaired sets of tours";
    if (work.ending()) result.message = "ended early, " + result.message;
    result.evaluations = found.evaluations;
    result.iterations = found.iterations;
    return result;
  }

 private:
  Settings settings_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::LocalSearch)
