// SPDX-License-Identifier: Apache-2.0
// The next best view, again and again (thesis 2.4, 4.4.3).
//
// Of all views that can still be put into the tour within the budget, the one with the largest gain
// goes to where it lengthens the tour least. Under a limit of images alone this is the greedy
// selection of (2.14), within (1 - 1/e) of the optimum (reading 2.5); under a travel budget there
// is no such promise. Of a team, the view goes to the tour that it lengthens least.
//
//   tour: {solver: greedy}
#include "framework/plugin/plugin.h"
#include "framework/view/greedy_growth.h"
#include "framework/view/working_team.h"

namespace lapwing {
namespace {

class Greedy final : public TourSolver {
 public:
  static constexpr PluginText kText{
      "greedy", "1.0.0", "adds the view with the largest gain, one at a time", "thesis 2.4, 4.4.3"};
  static ParameterTable parameters() {
    return ParameterTable{}.boolean("lazy", true,
                                    "skip evaluations that cannot change the choice; same tour");
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kTakesTeams, nullptr}};
    return all;
  }
  explicit Greedy(const Parameters& parameters) : lazy_(parameters.boolean("lazy")) {}

 protected:
  Search search(const TourProblem& problem, TourWork& work) const override {
    WorkingTour tour(problem);
    if (work.request().initial) tour.become(*work.request().initial);
    std::vector<double> known = gains_alone(problem);
    grow(tour, known, {.by_ratio = false, .lazy = lazy_}, work);
    Search result;
    result.walk = tour.finished();
    result.status = work.ending().value_or(TourStatus::feasible);
    result.message = "no further view with a gain fits into the budget";
    if (work.ending()) result.message = "ended early, the best so far";
    result.evaluations = tour.state().evaluations();
    result.iterations = tour.images();
    return result;
  }

  TeamSearch search_team(const TeamProblem& problem, TourWork& work,
                         const Walks* initial) const override {
    WorkingTeam team(problem);
    if (initial) team.become(*initial);
    std::vector<double> known = gains_alone(problem.tour(0));
    team.grow_all(known, {.by_ratio = false, .lazy = lazy_}, work);
    TeamSearch result;
    result.walks = team.finished();
    result.status = work.ending().value_or(TourStatus::feasible);
    result.message = "no further view with a gain fits into any budget";
    if (work.ending()) result.message = "ended early, the best so far";
    result.evaluations = team.state().evaluations();
    result.iterations = team.images();
    return result;
  }

 private:
  bool lazy_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Greedy)
