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

// Whether going past one of the views is never quicker than leaving it out, but for rounding. So it
// is over motions; legs are as stated.
bool keeps_triangle_inequality(const TourProblem& problem, const std::vector<int>& views);
// Whether no best tour goes past a view that is not chosen and brings nothing, though it could.
// `chosen` ascending.
bool holds_shortcuts(const TourProblem& problem, const std::vector<int>& chosen);

struct TourArc {
  int from = 0, to = 0;  // positions in the list of chosen views
  double seconds = 0;
  int passed = 0;  // views between, which are not chosen
};

// The columns and rows of one tour, or of several flights of one kind, in a program that may hold
// those of others too.
//
// Several flights have the same columns, in a problem of legs in which no best team visits a view
// twice: arcs that are taken then are disjoint walks from start to end, and g holds on each of them
// by itself. So flights are not told apart, and the program has no symmetry.
class TourProgram {
 public:
  // `chosen`: ascending, with start and end. `neighbours`: arcs that leave each chosen view, the
  // quickest; 0 for all. The arcs of `walks`, tours of the problem, are always there. More than one
  // of `flights` only as said above.
  TourProgram(const TourProblem& problem, std::vector<int> chosen, int neighbours,
              const std::vector<std::vector<int>>& walks, int flights = 1);

  // Appends columns and rows. `rewards` has an entry for each view of the problem; without, nothing
  // is gained here.
  void write(IntegerProgram& program, const std::vector<double>* rewards);

  const TourProblem& problem() const { return problem_; }
  const std::vector<TourArc>& arcs() const { return arcs_; }
  const std::vector<int>& chosen() const { return chosen_; }
  int flights() const { return flights_; }
  // Whether every motion of the problem between chosen views is an arc.
  bool complete() const { return complete_; }
  // Of columns that `write` appends.
  int columns() const { return 2 * static_cast<int>(arcs_.size()) + count(); }
  // Of the program, for a view of the problem; -1 for one that is not chosen.
  int column_of(int view) const { return position_[view] < 0 ? -1 : y(position_[view]); }
  int column_of_arc(int arc) const { return x(arc); }

  // Adds a tour of the problem to a point of the program. False where one of its arcs is not there:
  // they are for the tours of the constructor, and ones that pass the same views.
  bool put(const std::vector<int>& walk, std::vector<double>& point) const;
  // The tours that a point stands for, as TourProblem::problem_of wants them: one per flight.
  std::vector<std::vector<int>> walks_of(const std::vector<double>& point) const;

 private:
  void add_arcs(int neighbours);
  void add_arc(int from, int to);
  std::vector<int> chosen_on(const std::vector<int>& walk) const;
  double slack() const;
  void forbid_turning_back(IntegerProgram& program, int view) const;
  std::vector<int> one_walk_of(const std::vector<double>& point) const;
  int x(int arc) const { return first_ + arc; }
  int g(int arc) const { return first_ + static_cast<int>(arcs_.size()) + arc; }
  int y(int view) const { return first_ + 2 * static_cast<int>(arcs_.size()) + view; }
  int count() const { return static_cast<int>(chosen_.size()); }

  const TourProblem& problem_;
  std::vector<int> chosen_;
  std::vector<int> position_;  // per view of the problem; -1 for one that is not chosen
  int start_ = 0, end_ = 0;
  std::vector<TourArc> arcs_;
  std::vector<std::vector<std::pair<int, int>>> leaving_;  // per position: (to, arc), ascending
  bool complete_ = true;
  int flights_ = 1, first_ = 0;  // column
};

}  // namespace lapwing
