// SPDX-License-Identifier: Apache-2.0
// The better of greedy and cost-benefit (thesis 4.4.3; reading 4.8).
//
// Cost-benefit takes the view with the most gain per second that it adds to the tour. Alone it may
// end in a cluster of cheap views, as greedy may spend the budget on a few far ones; the guarantee
// that the literature gives belongs to the better of both, which is what comes out here.
//
//   tour: {solver: cost_benefit}
#include "framework/plugin/plugin.h"
#include "framework/view/greedy_growth.h"
#include "framework/view/working_team.h"

namespace lapwing {
namespace {

class CostBenefit final : public TourSolver {
 public:
  static constexpr PluginText kText{"cost_benefit", "1.0.0",
                                    "the better of greedy by gain and greedy by gain per second",
                                    "thesis 4.4.3, reading 4.8"};
  static ParameterTable parameters() {
    return ParameterTable{}.boolean("lazy", true,
                                    "skip evaluations that cannot change the choice; same tour");
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kTakesTeams, nullptr}};
    return all;
  }
  explicit CostBenefit(const Parameters& parameters) : lazy_(parameters.boolean("lazy")) {}

 protected:
  Search search(const TourProblem& problem, TourWork& work) const override {
    Search best;
    std::int64_t evaluations = 0;
    double best_score = -1;
    for (const bool by_ratio : {true, false}) {
      WorkingTour tour(problem);
      if (work.request().initial) tour.become(*work.request().initial);
      tour.state().set_evaluations(tour.state().evaluations() + evaluations);
      std::vector<double> known = gains_alone(problem);
      grow(tour, known, {.by_ratio = by_ratio, .lazy = lazy_}, work);
      evaluations = tour.state().evaluations();
      best.iterations += tour.images();
      if (tour.score() <= best_score) continue;
      best_score = tour.score();
      best.walk = tour.finished();
      best.message = by_ratio ? "cost-benefit was the better" : "greedy was the better";
    }
    best.status = work.ending().value_or(TourStatus::feasible);
    if (work.ending()) best.message = "ended early, the best so far";
    best.evaluations = evaluations;
    return best;
  }

  TeamSearch search_team(const TeamProblem& problem, TourWork& work,
                         const Walks* initial) const override {
    TeamSearch best;
    double best_score = -1;
    for (const bool by_ratio : {true, false}) {
      WorkingTeam team(problem);
      if (initial) team.become(*initial);
      team.state().set_evaluations(team.state().evaluations() + best.evaluations);
      std::vector<double> known = gains_alone(problem.tour(0));
      team.grow_all(known, {.by_ratio = by_ratio, .lazy = lazy_}, work);
      best.evaluations = team.state().evaluations();
      best.iterations += team.images();
      if (team.score() <= best_score) continue;
      best_score = team.score();
      best.walks = team.finished();
      best.message = by_ratio ? "cost-benefit was the better" : "greedy was the better";
    }
    best.status = work.ending().value_or(TourStatus::feasible);
    if (work.ending()) best.message = "ended early, the best so far";
    return best;
  }

 private:
  bool lazy_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::CostBenefit)
