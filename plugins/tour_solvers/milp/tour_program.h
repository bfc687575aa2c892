// SPDX-License-Identifier: Apache-2.0
// An orienteering problem on the motion graph as a mixed-integer linear program.
//
// Per arc (a motion one way, or the shortest way between chosen views past others) whether the tour
// takes it, x, and what is left of the budget at its end, g; per view whether it is taken, y (the
// formulation by time of Letchford, Nasiri and Theis, "Compact formulations of the Steiner
// traveling salesman problem and related problems", EJOR 2013). Views may be passed more than once;
// no best tour takes an arc twice. With d the seconds of the shortest way:
//
//   maximise  sum reward y       subject to  in(x) - out(x) = [end] - [start]  at every view
//   y_v <= in(x_v)               d(to, end) x <= g <= (budget - d(start, from) - leg) x
//   in(g) = out(g + leg x)       at every view but the start, where budget + in(g) >= out(g + leg
//   x)
#pragma once

#include <utility>
#include <vector>

#include "framework/view/tour_problem.h"
#include "plugins/tour_solvers/milp/integer_program.h"

namespace lapwing {

struct TourArc {
  int from = 0, to = 0;  // positions in the list of chosen views
  double seconds = 0;
  int passed = 0;  // views between, which are not chosen
};

class TourProgram {
 public:
  // `chosen`: ascending, with start and end. `neighbours`: arcs that leave each chosen view, the
  // quickest; 0 for all. The arcs of `walk`, a tour of the problem, are always there. `rewards` has
  // an entry for each view of the problem.
  TourProgram(const TourProblem& problem, const std::vector<double>& rewards,
              std::vector<int> chosen, int neighbours, const std::vector<int>& walk);

  const IntegerProgram& program() const { return program_; }
  const std::vector<TourArc>& arcs() const { return arcs_; }
  // Whether every motion of the problem between chosen views is an arc.
  bool complete() const { return complete_; }
  // A point of the program for a tour of the problem whose arcs are there: that of the constructor,
  // or one that passes the same views.
  std::vector<double> point_of(const std::vector<int>& walk) const;
  // The tour that a point stands for, as TourProblem::problem_of wants it.
  std::vector<int> walk_of(const std::vector<double>& x) const;

 private:
  void add_arcs(int neighbours);
  void add_arc(int from, int to);
  std::vector<int> chosen_on(const std::vector<int>& walk) const;
  void write_program();
  void forbid_turning_back(int view);
  int x(int arc) const { return arc; }
  int g(int arc) const { return static_cast<int>(arcs_.size()) + arc; }
  int y(int view) const { return 2 * static_cast<int>(arcs_.size()) + view; }
  int count() const { return static_cast<int>(chosen_.size()); }

  const TourProblem& problem_;
  const std::vector<double>& rewards_;
  std::vector<int> chosen_;
  std::vector<int> position_;  // per view of the problem; -1 for one that is not chosen
  int start_ = 0, end_ = 0;
  std::vector<TourArc> arcs_;
  std::vector<std::vector<std::pair<int, int>>> leaving_;  // per position: (to, arc), ascending
  bool complete_ = true;
  IntegerProgram program_;
};

}  // namespace lapwing
