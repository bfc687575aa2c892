// SPDX-License-Identifier: Apache-2.0
// A team orienteering problem as a mixed-integer linear program: the columns and rows of every tour
// (tour_program.h), joined by what a view counts.
//
// Per view z, whether any tour takes it, with y of tour t:
//
//   maximise  sum reward z       subject to  z <= sum of y_t,  z <= 1
//
// Where no best team needs a view on two tours, or y only counts it, also sum of y_t = z. So it is
// in a problem of legs that keep the triangle inequality, and in one of motions without a limit of
// images.
//
// Tours are alike that have the same ways, ends, budget and limit of images: any of them could fly
// what another one flies. In a problem of legs that keep the triangle inequality, without a limit
// of images, alike tours share their columns (`flights` of tour_program.h; the compact formulation
// of Bianchessi, Mansini and Speranza, "A branch-and-cut algorithm for the team orienteering
// problem", ITOR 2018). Elsewhere they are put in order: by the first view that each of them
// counts, in order of rewards, or by their seconds.
#pragma once

#include <memory>
#include <vector>

#include "framework/view/team_problem.h"
#include "plugins/tour_solvers/milp/tour_program.h"

namespace lapwing {

// Whether one tour can fly whatever the other one can, by the same ways.
bool alike(const TourProblem& a, const TourProblem& b);

class TeamProgram {
 public:
  // `chosen`: views, ascending, with the start and the end of every tour. `neighbours` as of
  // TourProgram. The arcs of `walks`, tours of the problem, are always there. `rewards` has an
  // entry for each view of the problem; it and the problem outlive this object.
  TeamProgram(const TeamProblem& problem, const std::vector<double>& rewards,
              const std::vector<int>& chosen, int neighbours, const Walks& walks);

  // Of the whole program, known before it is written.
  std::int64_t columns() const;
  void write();
  const IntegerProgram& program() const { return program_; }
  // Whether every motion of the problem between chosen views is an arc.
  bool has_all_arcs() const;
  bool has_all_shortcuts() const;  // tour_program.h
  // A point for tours of the problem whose arcs are there; empty where one is not.
  std::vector<double> point_of(const Walks& walks) const;
  Walks walks_of(const std::vector<double>& point) const;

 private:
  struct Part {
    std::vector<int> tours;
    std::unique_ptr<TourProgram> program;
  };
  bool shares() const { return parts_.size() > 1; }
  bool is_end(int view) const { return ends_[view] != 0; }
  void write_shared_score();
  void write_order();
  void order_by_views(const TourProgram& first, const TourProgram& second);
  void order_by_words(const TourProgram& first, const TourProgram& second);
  std::vector<int> letters(const TourProgram& part) const;
  Walks without_repeats(Walks walks) const;

  const TeamProblem& problem_;
  const std::vector<double>& rewards_;
  std::vector<int> chosen_;   // ascending
  std::vector<int> by_rank_;  // chosen views that are no end, by falling reward
  std::vector<char> ends_;    // per view: of some tour
  std::vector<Part> parts_;
  // alike_[p]: whether part p and the one before are of alike tours, and so in order.
  std::vector<char> alike_;
  bool visits_once_ = false;  // no view but ends is on two tours
  bool counts_once_ = false;  // nor counted by two
  std::vector<int> z_;        // per chosen view, its column; none where one part has all tours
  IntegerProgram program_;
};

}  // namespace lapwing
