// SPDX-License-Identifier: Apache-2.0
// How: as for one tour (local_search.cpp), over all tours of a team. An iteration changes one or
// more tours: `ruin` or `exchange` in one of them, views near a random one taken out of all tours,
// or the ends of two tours exchanged at random places (a perturbation that 2-opt* may undo). What
// then is beyond a budget is taken out. Moves within and between tours shorten them
// (working_team.h). Then views are inserted into any tour by gain per second, with random factors.
// Room is worth something in all tours.
#include "plugins/tour_solvers/local_search/team_annealing.h"

#include <algorithm>
#include <cmath>

#include "framework/view/working_team.h"
#include "plugins/tour_solvers/local_search/ruin.h"

namespace lapwing {
namespace {

constexpr int kMostTeamViewsOut = 30;
constexpr double kColdestTeam = 0.02;    // of the warmth, at the end
constexpr double kTeamRoomWorth = 0.3;   // of the score per second: what room is worth
constexpr double kEndsExchanged = 0.15;  // share of the iterations
constexpr double kAcrossTours = 0.3;     // likewise, that take views near one another out of all

class TeamAnnealing {
 public:
  TeamAnnealing(const TeamProblem& problem, const AnnealingSettings& settings, TourWork& work)
      : problem_(problem),
        settings_(settings),
        work_(work),
        random_(work.request().seed),
        overlaps_(problem.score()),
        known_{gains_alone(problem.tour(0)), &overlaps_},
        current_(problem),
        favour_(problem.views(), 1.0) {
    for (int t = 0; t < problem.size(); ++t) budget_ += problem.tour(t).budget();
  }

  AnnealedTeam run(const Walks* initial) {
    if (initial) current_.become(*initial);
    keep(current_);
    work_.expect(settings_.iterations);
    fill(current_, {.by_ratio = true});
    keep(current_);
    WorkingTeam trial = current_;
    while (best_.iterations < settings_.iterations && !stop()) {
      ++best_.iterations;
      change(trial);
      if (accepted(trial)) {
        keep(trial);
        std::swap(current_, trial);
        current_.state().set_evaluations(best_.evaluations);
      }
      trial = current_;
      trial.state().set_evaluations(best_.evaluations);
    }
    return std::move(best_);
  }

 private:
  bool stop() { return work_.ended(best_.evaluations, best_.iterations); }

  double share_done() const {
    const double own =
        static_cast<double>(best_.iterations) / static_cast<double>(settings_.iterations);
    return std::max(own, work_.share_used(best_.evaluations, best_.iterations));
  }

  void fill(WorkingTeam& team, const GreedyGrowth& growth) {
    team.grow_all(known_.gains, growth, work_, best_.iterations);
    while (team.shorten()) {
      const int before = team.images();
      team.grow_all(known_.gains, growth, work_, best_.iterations);
      if (team.images() == before) break;
    }
    best_.evaluations = team.state().evaluations();
  }

  void change(WorkingTeam& team) {
    const int t = static_cast<int>(random_.integer(0, team.size() - 1));
    WorkingTour& tour = team.tour(t);
    const int most =
        std::clamp(static_cast<int>(settings_.share * tour.images()), 2, kMostTeamViewsOut);
    const int count = static_cast<int>(random_.integer(1, most));
    const double how = random_.uniform();
    const bool put_in =
        random_.uniform() < settings_.exchanges && exchange(tour, count, known_, random_);
    if (!put_in) {
      if (how < kEndsExchanged && team.size() > 1)
        exchange_any_ends(team, t);
      else if (how < kEndsExchanged + kAcrossTours)
        ruin_around(team, count);
      else
        ruin(tour, count, known_, random_);
    }
    team.shorten();
    for (double& factor : favour_) factor = std::exp(settings_.chance * random_.uniform(-1, 1));
    fill(team, {.by_ratio = true, .favour = favour_, .patience = settings_.patience});
  }

  // Views near a random one, whichever tour they are on.
  void ruin_around(WorkingTeam& team, int count) {
    const int middle = static_cast<int>(random_.integer(0, problem_.views() - 1));
    const auto legs = problem_.tour(0).legs_from(middle);
    std::vector<std::pair<double, int>> near;
    for (int view = 0; view < problem_.views(); ++view)
      if (team.tour(0).taken(view)) near.push_back({legs[view], view});
    const auto end = near.begin() + std::min<std::ptrdiff_t>(count + 1, std::ssize(near));
    std::partial_sort(near.begin(), end, near.end());
    for (auto place = near.begin(); place != end; ++place)
      for (int t = 0; t < team.size(); ++t) take_out_view(team.tour(t), place->second, known_);
  }

  // 2-opt* at random places; then the views of least worth go until all budgets hold.
  void exchange_any_ends(WorkingTeam& team, int a) {
    int b = static_cast<int>(random_.integer(0, team.size() - 2));
    if (b >= a) ++b;
    WorkingTour &first = team.tour(a), &second = team.tour(b);
    if (!first.problem().same_ways(second.problem())) return ruin(first, 2, known_, random_);
    const std::vector<int> wa = first.walk(), wb = second.walk();
    const auto i = random_.integer(0, std::ssize(wa) - 2);
    // Where the other tour comes nearest to that place.
    const auto legs = first.problem().legs_from(wa[i]);
    std::ptrdiff_t j = 0;
    for (std::ptrdiff_t k = 0; k + 1 < std::ssize(wb); ++k)
      if (legs[wb[k]] < legs[wb[j]]) j = k;
    std::vector<int> one(wa.begin(), wa.begin() + i + 1), other(wb.begin(), wb.begin() + j + 1);
    one.insert(one.end(), wb.begin() + j + 1, wb.end());
    other.insert(other.end(), wa.begin() + i + 1, wa.end());
    first.become(one);
    second.become(other);
    for (WorkingTour* tour : {&first, &second}) {
      tour->shorten();
      shrink_to_budget(*tour, {}, known_, random_);
    }
  }

  double value(const WorkingTeam& team) const {
    return team.score() + kTeamRoomWorth * best_score_ / std::max(1e-9, budget_) * team.room();
  }

  bool accepted(const WorkingTeam& trial) {
    if (!trial.within_budgets() || !trial.within_limits()) return false;
    const double change = value(trial) - value(current_);
    const double unit = best_score_ / std::max(1, current_.images());
    const double heat = settings_.warmth * unit * std::pow(kColdestTeam, share_done());
    return change >= 0 || random_.uniform() < std::exp(change / heat);
  }

  void keep(const WorkingTeam& team) {
    if (team.score() <= best_score_ || !team.within_budgets() || !team.within_limits()) return;
    best_score_ = team.score();
    best_.walks = team.finished();
  }

  const TeamProblem& problem_;
  const AnnealingSettings& settings_;
  TourWork& work_;
  Random random_;
  Overlaps overlaps_;
  KnownGains known_;
  WorkingTeam current_;
  std::vector<double> favour_;
  double best_score_ = -1, budget_ = 0;  // s, of all tours
  AnnealedTeam best_;
};

}  // namespace

AnnealedTeam anneal_team(const TeamProblem& problem, const AnnealingSettings& settings,
                         TourWork& work, const Walks* initial) {
  return TeamAnnealing(problem, settings, work).run(initial);
}

}  // namespace lapwing
