// SPDX-License-Identifier: Apache-2.0
// A tour while a solver changes it: its walk, its seconds, and the score of its views. Copyable.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "framework/view/tour_problem.h"

namespace lapwing {

// The views of all tours of a team: one counts as long as some tour has it. Copyable.
class SharedViews {
 public:
  explicit SharedViews(const ViewScore& score) : state_(score), tours_(score.views(), 0) {}
  void enter(int view) {
    if (tours_[view]++ == 0) state_.add(view);
  }
  void leave(int view) {
    if (--tours_[view] == 0) state_.remove(view);
  }
  int tours_with(int view) const { return tours_[view]; }
  ScoreState& state() { return state_; }
  const ScoreState& state() const { return state_; }

 private:
  ScoreState state_;
  std::vector<int> tours_;  // per view
};

class WorkingTour {
 public:
  // The shortest way from start to end; the problem outlives this object.
  explicit WorkingTour(const TourProblem& problem);
  // Likewise of a team, whose views outlive it too: its score is that of all tours. A copy is of
  // the same team until `join` puts it into that team's copy.
  WorkingTour(const TourProblem& problem, SharedViews& team);
  void join(SharedViews& team) { team_ = &team; }
  // Becomes `walk`, of which nothing is checked, by the shortest ways from view to view.
  void become(std::span<const int> walk);

  // From start to end; a loop always begins and ends with its start.
  const std::vector<int>& walk() const { return walk_; }
  // As TourProblem::problem_of wants it: a loop without further views is its start alone.
  std::vector<int> finished() const;
  int size() const { return static_cast<int>(walk_.size()); }
  double seconds() const { return seconds_; }
  double room() const { return problem_->budget() + problem_->tolerance() / 2 - seconds_; }
  int images() const { return images_; }
  int visits(int view) const { return visits_[view]; }
  // Whether this tour, or another one of its team, has the view.
  bool taken(int view) const { return team_ ? team_->tours_with(view) > 0 : visits_[view] > 0; }
  ScoreState& state() { return team_ ? team_->state() : *own_; }
  double score() const { return team_ ? team_->state().score() : own_->score(); }
  const TourProblem& problem() const { return *problem_; }

  // For every view the least that putting it into the walk adds (s), and after which position.
  // Passing what is there already costs nothing extra; infinite where there is no way.
  void cheapest_places(std::vector<double>& extra, std::vector<int>& after) const;
  // The same after `insert` put something in after position `at` and made the walk `added` longer.
  void update_places(int at, int added, std::vector<double>& extra, std::vector<int>& after) const;
  // Whether the image limit admits `view` after position `after`, with all that is passed.
  bool admits(int view, int after) const;
  // Puts `view` in, with the views on its ways.
  void insert(int view, int after);
  // Takes the views at positions first..last out; the shortest way closes the hole, and may pass
  // other views. Neither end of the walk can go. False, and nothing done, where the image limit
  // forbids that way.
  bool take_out(int first, int last);
  // Reorders by exchanging two legs (2-opt) and moving up to three views (or-opt) until neither
  // shortens the walk. True where it became shorter.
  bool shorten();

 private:
  // Positions first..last give way to `by`; seconds, visits and score follow.
  void replace(int first, int last, std::span<const int> by);
  int images_with(int first, int last, std::span<const int> by) const;
  void compare_places(int first, int last, std::vector<double>& extra,
                      std::vector<int>& after) const;
  void visit(int view);
  void leave(int view);

  const TourProblem* problem_;
  std::optional<ScoreState> own_;  // of a tour without a team
  SharedViews* team_ = nullptr;
  std::vector<int> walk_;
  std::vector<int> visits_;
  double seconds_ = 0;
  int images_ = 0;
  std::vector<int> settled_;  // the walk when it was last found to be short
};

}  // namespace lapwing
