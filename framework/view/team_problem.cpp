// SPDX-License-Identifier: Apache-2.0
#include "framework/view/team_problem.h"

#include <algorithm>
#include <set>

#include "framework/core/error.h"

namespace lapwing {

TeamProblem::TeamProblem(std::vector<TeamTour> tours) : tours_(std::move(tours)) {
  if (tours_.empty()) throw InputError("a team has no tour: it needs at least one");
  std::set<std::string> names;
  for (const TeamTour& tour : tours_) {
    if (!names.insert(tour.name).second)
      throw InputError("two tours of a team are named '" + tour.name +
                       "'; each needs its own name");
    if (&tour.problem.score() != &score())
      throw InputError("tour '" + tour.name + "' has another score than tour '" + name(0) +
                       "'; the tours of a team share one");
    if (tour.problem.each_once() != this->tour(0).each_once())
      throw InputError("tour '" + tour.name + "' and tour '" + name(0) +
                       "' must both have legs, or both have motions");
  }
}

double TeamProblem::score_of(const Walks& walks) const {
  ScoreState state(score());
  for (const std::vector<int>& walk : walks)
    for (const int view : walk) state.add(view);
  return state.score();
}

std::string TeamProblem::problem_of(const Walks& walks) const {
  if (walks.size() != tours_.size())
    return "there are " + std::to_string(walks.size()) + " walks of " +
           std::to_string(tours_.size()) + " tours";
  for (int t = 0; t < size(); ++t) {
    const std::string wrong = tour(t).problem_of(walks[t]);
    if (!wrong.empty()) return "tour '" + name(t) + "': " + wrong;
  }
  return "";
}

std::vector<int> TeamProblem::reachable() const {
  std::set<int> all;
  for (const TeamTour& tour : tours_) {
    const std::vector<int> some = tour.problem.reachable();
    all.insert(some.begin(), some.end());
  }
  return {all.begin(), all.end()};
}

std::string TeamProblem::why_infeasible() const {
  for (const TeamTour& tour : tours_) {
    const std::string why = tour.problem.why_infeasible();
    if (!why.empty()) return "tour '" + tour.name + "': " + why;
  }
  return "";
}

TeamProblem equal_tours(TourDefinition definition, int count) {
  if (count < 1) throw InputError("a team has at least one tour, not " + std::to_string(count));
  const double budget = definition.budget;
  const std::optional<int> image_limit = definition.image_limit;
  std::vector<TeamTour> tours;
  tours.push_back({"1", TourProblem(std::move(definition))});
  while (static_cast<int>(tours.size()) < count)
    tours.push_back(
        {std::to_string(tours.size() + 1), tours.front().problem.with_limits(budget, image_limit)});
  return TeamProblem(std::move(tours));
}

}  // namespace lapwing
