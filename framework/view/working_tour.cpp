// SPDX-License-Identifier: Apache-2.0
// How: the walk has every view that is passed, not only those that were put in: neighbours in it
// are joined by a motion of the graph. `insert` and `take_out` therefore add the shortest ways with
// the views on them. `visits_` counts how often a view is passed. Its first visit adds it to the
// score, and its last departure removes it. Seconds change by the legs that come and go.
//
// The cheapest place of a view v is the leg from a to b with the smallest d(a, v) + d(v, b) - d(a,
// b), where d is the time of the shortest way. An insertion changes one leg. `update_places`
// compares all views with the new legs, and searches the whole walk only for views whose best leg
// is gone. `shorten` takes the order that walk_order.h proposes (2-opt, or-opt) if it is shorter
// and within the limit of images.
#include "framework/view/working_tour.h"

#include <algorithm>
#include <limits>

#include "framework/view/walk_order.h"

namespace lapwing {

WorkingTour::WorkingTour(const TourProblem& problem)
    : problem_(&problem), own_(problem.score()), visits_(problem.views(), 0) {
  const int ends[] = {problem.start(), problem.end()};
  become(ends);
}

WorkingTour::WorkingTour(const TourProblem& problem, SharedViews& team)
    : problem_(&problem), team_(&team), visits_(problem.views(), 0) {
  const int ends[] = {problem.start(), problem.end()};
  become(ends);
}

void WorkingTour::visit(int view) {
  if (visits_[view]++ > 0) return;
  ++images_;
  team_ ? team_->enter(view) : own_->add(view);
}

void WorkingTour::leave(int view) {
  if (--visits_[view] > 0) return;
  --images_;
  team_ ? team_->leave(view) : own_->remove(view);
}

void WorkingTour::become(std::span<const int> walk) {
  std::vector<int> next{walk.front()};
  for (std::size_t i = 1; i < walk.size(); ++i) problem_->append_way(walk[i - 1], walk[i], next);
  if (next.size() == 1 && problem_->loop()) next.push_back(problem_->end());
  // What stays is not taken out and put in again.
  for (const int view : next) visit(view);
  for (const int view : walk_) leave(view);
  walk_ = std::move(next);
  seconds_ = problem_->fixed_seconds();
  for (int i = 1; i < size(); ++i) seconds_ += problem_->leg(walk_[i - 1], walk_[i]);
}

std::vector<int> WorkingTour::finished() const {
  if (problem_->loop() && size() == 2) return {walk_.front()};
  return walk_;
}

void WorkingTour::cheapest_places(std::vector<double>& extra, std::vector<int>& after) const {
  const std::size_t n = problem_->views();
  extra.assign(n, std::numeric_limits<double>::infinity());
  after.assign(n, 0);
  compare_places(0, size() - 2, extra, after);
}

// Legs first..last against the best so far.
void WorkingTour::compare_places(int first, int last, std::vector<double>& extra,
                                 std::vector<int>& after) const {
  const std::size_t n = problem_->views();
  for (int i = first; i <= last; ++i) {
    const double* from = problem_->legs_from(walk_[i]).data();
    const double* to = problem_->legs_from(walk_[i + 1]).data();
    const double leg = from[walk_[i + 1]];
    for (std::size_t v = 0; v < n; ++v) {
      const double more = from[v] + to[v] - leg;
      if (more < extra[v]) {
        extra[v] = more;
        after[v] = i;
      }
    }
  }
}

void WorkingTour::update_places(int at, int added, std::vector<double>& extra,
                                std::vector<int>& after) const {
  std::vector<int> lost;  // their leg is gone
  for (int v = 0; v < problem_->views(); ++v) {
    if (after[v] > at) {
      after[v] += added;
    } else if (after[v] == at) {
      lost.push_back(v);
      extra[v] = std::numeric_limits<double>::infinity();
      after[v] = 0;
    }
  }
  compare_places(at, at + added, extra, after);
  for (int i = 0; i + 1 < size() && !lost.empty(); ++i) {
    // From what stands in the walk: ways from there are known already.
    const double* from = problem_->legs_from(walk_[i]).data();
    const double* to = problem_->legs_from(walk_[i + 1]).data();
    const double leg = from[walk_[i + 1]];
    for (const int v : lost) {
      const double more = from[v] + to[v] - leg;
      if (more >= extra[v]) continue;
      extra[v] = more;
      after[v] = i;
    }
  }
}

int WorkingTour::images_with(int first, int last, std::span<const int> by) const {
  std::vector<int> gone(walk_.begin() + first, walk_.begin() + last + 1),
      come(by.begin(), by.end());
  std::sort(gone.begin(), gone.end());
  std::sort(come.begin(), come.end());
  int images = images_;
  for (std::size_t i = 0; i < gone.size();) {
    const auto same = std::upper_bound(gone.begin(), gone.end(), gone[i]) - gone.begin() - i;
    const bool back = std::binary_search(come.begin(), come.end(), gone[i]);
    if (!back && visits_[gone[i]] == static_cast<int>(same)) --images;
    i += static_cast<std::size_t>(same);
  }
  come.erase(std::unique(come.begin(), come.end()), come.end());
  for (const int view : come) images += visits_[view] == 0;
  return images;
}

bool WorkingTour::admits(int view, int after) const {
  if (!problem_->image_limit()) return true;
  std::vector<int> by;
  problem_->append_way(walk_[after], view, by);
  problem_->append_way(view, walk_[after + 1], by);
  return images_with(after + 1, after, by) <= *problem_->image_limit();
}

void WorkingTour::replace(int first, int last, std::span<const int> by) {
  for (int i = first; i <= last + 1; ++i) seconds_ -= problem_->leg(walk_[i - 1], walk_[i]);
  for (const int view : by) visit(view);
  for (int i = first; i <= last; ++i) leave(walk_[i]);
  walk_.erase(walk_.begin() + first, walk_.begin() + last + 1);
  walk_.insert(walk_.begin() + first, by.begin(), by.end());
  const int end = first + static_cast<int>(by.size());
  for (int i = first; i <= end; ++i) seconds_ += problem_->leg(walk_[i - 1], walk_[i]);
}

void WorkingTour::insert(int view, int after) {
  std::vector<int> by;
  problem_->append_way(walk_[after], view, by);
  problem_->append_way(view, walk_[after + 1], by);
  if (by.empty()) return;  // a loop without further views, and its start
  by.pop_back();
  replace(after + 1, after, by);
}

bool WorkingTour::take_out(int first, int last) {
  // Where the walk would stand still it goes on at once; a loop may end as its start alone.
  if (walk_[first - 1] == walk_[last + 1] && size() - (last - first + 1) > 2) {
    if (last + 2 < size()) {
      ++last;
    } else {
      --first;
    }
  }
  std::vector<int> by;
  problem_->append_way(walk_[first - 1], walk_[last + 1], by);
  if (!by.empty()) by.pop_back();
  const auto& limit = problem_->image_limit();
  if (limit && images_with(first, last, by) > *limit) return false;
  replace(first, last, by);
  return true;
}

bool WorkingTour::shorten() {
  const std::vector<int> order = shorter_order(*problem_, walk_, settled_);
  if (order.empty()) {
    settled_ = walk_;
    return false;
  }
  const double before = seconds_;
  const std::vector<int> old = walk_;
  become(order);
  const auto& limit = problem_->image_limit();
  settled_ = walk_;
  if (seconds_ < before && !(limit && images_ > *limit)) return true;
  become(old);
  settled_ = walk_;
  return false;
}

}  // namespace lapwing
