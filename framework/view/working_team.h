// SPDX-License-Identifier: Apache-2.0
// The tours of a team while a solver changes them. Copyable.
#pragma once

#include <vector>

#include "framework/view/greedy_growth.h"
#include "framework/view/team_problem.h"
#include "framework/view/working_tour.h"

namespace lapwing {

class WorkingTeam {
 public:
  // Each tour the shortest way from its start to its end; the problem outlives this object.
  explicit WorkingTeam(const TeamProblem& problem);
  WorkingTeam(const WorkingTeam& other);
  WorkingTeam& operator=(const WorkingTeam& other);

  // Nothing of the walks is checked but their number.
  void become(const Walks& walks);
  Walks finished() const;  // as TeamProblem::problem_of wants them

  int size() const { return static_cast<int>(tours_.size()); }
  WorkingTour& tour(int index) { return tours_[index]; }
  const WorkingTour& tour(int index) const { return tours_[index]; }
  const TeamProblem& problem() const { return *problem_; }
  double score() const { return views_.state().score(); }
  ScoreState& state() { return views_.state(); }
  int images() const { return views_.state().size(); }  // different views of all tours
  double room() const;                                  // s, of all tours together
  bool within_budgets() const;
  bool within_limits() const;  // of images

  // Puts in what fits anywhere, as `grow` of tours does.
  void grow_all(std::vector<double>& known, const GreedyGrowth& growth, TourWork& work,
                std::int64_t iterations = 0);
  // Each tour in a shorter order, and views and ends of tours from one to another where all tours
  // together become shorter and each stays within its budget and image limit: a view moved
  // (relocate), two exchanged (swap), the parts behind two legs exchanged (2-opt*; of tours with
  // the same ways). True where something became shorter.
  bool shorten();

 private:
  std::vector<WorkingTour*> pointers();
  bool relocate(int from, int to);
  bool swap(int a, int b);
  bool exchange_ends(int a, int b);
  bool take(int a, std::vector<int> walk_a, int b, std::vector<int> walk_b);

  const TeamProblem* problem_;
  SharedViews views_;
  std::vector<WorkingTour> tours_;
};

}  // namespace lapwing
