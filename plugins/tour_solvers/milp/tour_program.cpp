// SPDX-License-Identifier: Apache-2.0
// How: the columns are x, then g, for each arc, then y for each view (tour_program.h). Arcs join a
// view with its nearest others, both ways. An arc past a chosen view is left out: it is two arcs.
//
// g is positive and falls along a tour, so arcs that are taken form one walk from the start, and no
// cycle apart from it. kLeastSeconds keeps this true for arcs that take no time. An arc that cannot
// be on a tour within the budget is fixed to 0. Where each view is visited once, x_ab + x_ba <= y_a
// forbids turning back, which the relaxation would otherwise use.
//
// A tour becomes part of a point by chosen_on: no arc may be taken twice, so a part between
// two uses of an arc is turned round. A point becomes a tour by Hierholzer's algorithm: at every
// view as many taken arcs come as go, except at start and end.
#include "plugins/tour_solvers/milp/tour_program.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

// s of the budget: what an arc takes of the time that is left, at least. Without it arcs that take
// no time could go round and round, far from the tour.
constexpr double kLeastSeconds = 1e-7;

}  // namespace

bool keeps_triangle_inequality(const TourProblem& problem, const std::vector<int>& views) {
  if (!problem.each_once()) return true;
  for (const int middle : views) {
    const auto from_middle = problem.legs_from(middle);
    for (const int a : views) {
      const auto from_a = problem.legs_from(a);
      for (const int b : views) {
        if (from_a[b] > from_a[middle] + from_middle[b] + problem.tolerance() / 10) return false;
      }
    }
  }
  return true;
}

bool holds_shortcuts(const TourProblem& problem, const std::vector<int>& chosen) {
  if (!problem.each_once()) return true;
  const std::vector<int> within = problem.reachable();
  return std::includes(chosen.begin(), chosen.end(), within.begin(), within.end()) ||
         keeps_triangle_inequality(problem, within);
}

TourProgram::TourProgram(const TourProblem& problem, std::vector<int> chosen, int neighbours,
                         const std::vector<std::vector<int>>& walks, int flights)
    : problem_(problem),
      chosen_(std::move(chosen)),
      position_(problem.views(), -1),
      leaving_(chosen_.size()),
      flights_(flights) {
  for (int i = 0; i < count(); ++i) position_[chosen_[i]] = i;
  start_ = position_[problem.start()];
  end_ = position_[problem.end()];
  add_arcs(neighbours);
  for (const std::vector<int>& walk : walks) {
    const std::vector<int> on = chosen_on(walk);
    for (std::size_t i = 1; i < on.size(); ++i) {
      add_arc(on[i - 1], on[i]);
      add_arc(on[i], on[i - 1]);
    }
  }
  // One flight may go from start to end at once, whatever the others do.
  if (flights_ > 1 && start_ != end_) add_arc(start_, end_);
  for (auto& list : leaving_) std::sort(list.begin(), list.end());
}

// Both ways between each chosen view and the nearest others that no third one lies between: past a
// third one the way is two arcs.
void TourProgram::add_arcs(int neighbours) {
  std::vector<std::pair<double, int>> near;
  std::vector<int> way;
  for (int i = 0; i < count(); ++i) {
    const auto legs = problem_.legs_from(chosen_[i]);
    near.clear();
    for (int j = 0; j < count(); ++j) {
      if (j != i && std::isfinite(legs[chosen_[j]])) near.push_back({legs[chosen_[j]], j});
    }
    std::sort(near.begin(), near.end());
    int left = neighbours > 0 ? neighbours : count();
    for (const auto& [leg, j] : near) {
      way.clear();
      problem_.append_way(chosen_[i], chosen_[j], way);
      const bool direct =
          std::none_of(way.begin(), way.end() - 1, [&](int view) { return position_[view] >= 0; });
      if (!direct) continue;
      if (left-- <= 0) {
        complete_ = false;
        break;
      }
      add_arc(i, j);
      add_arc(j, i);
    }
  }
}

void TourProgram::add_arc(int from, int to) {
  auto& list = leaving_[from];
  if (std::any_of(list.begin(), list.end(), [&](const auto& known) { return known.first == to; })) {
    return;
  }
  std::vector<int> way;
  problem_.append_way(chosen_[from], chosen_[to], way);
  list.push_back({to, static_cast<int>(arcs_.size())});
  arcs_.push_back(
      {from, to, problem_.leg(chosen_[from], chosen_[to]), static_cast<int>(way.size()) - 1});
}

// The chosen views of a walk, by position, with no arc twice: P a b Q a b R becomes P a Q' b R,
// where Q' is Q the other way round, which passes the same views.
std::vector<int> TourProgram::chosen_on(const std::vector<int>& walk) const {
  std::vector<int> on;
  for (const int view : walk) {
    const int position = position_[view];
    if (position >= 0 && (on.empty() || on.back() != position)) on.push_back(position);
  }
  for (bool again = true; again;) {
    again = false;
    std::vector<std::vector<std::pair<int, std::size_t>>> seen(chosen_.size());
    for (std::size_t k = 0; k + 1 < on.size() && !again; ++k) {
      auto& list = seen[on[k]];
      const auto known = std::find_if(list.begin(), list.end(),
                                      [&](const auto& arc) { return arc.first == on[k + 1]; });
      if (known == list.end()) {
        list.push_back({on[k + 1], k});
        continue;
      }
      // At `first` a b, at `k` a b again: between them b Q a.
      const std::size_t first = known->second;
      std::vector<int> next(on.begin(), on.begin() + static_cast<std::ptrdiff_t>(first));
      for (std::size_t i = k; i > first; --i) next.push_back(on[i]);
      next.insert(next.end(), on.begin() + static_cast<std::ptrdiff_t>(k) + 1, on.end());
      // Where Q was empty the walk stands still now.
      next.erase(std::unique(next.begin(), next.end()), next.end());
      on = std::move(next);
      again = true;
    }
  }
  return on;
}

// s: what g has beyond the budget at the start, for arcs that take no time.
double TourProgram::slack() const {
  const double least = kLeastSeconds * (problem_.budget() - problem_.fixed_seconds());
  if (flights_ == 1) return 2 * count() * least;  // a row has the budget of the only tour
  // Flights visit a view once: as many arcs without time as there are views with such an arc.
  std::vector<char> quick(chosen_.size(), 0);
  for (const TourArc& arc : arcs_) quick[arc.to] |= arc.seconds < least;
  return static_cast<double>(std::count(quick.begin(), quick.end(), 1)) * least;
}

void TourProgram::write(IntegerProgram& program, const std::vector<double>* rewards) {
  first_ = program.columns();
  const int arcs = static_cast<int>(arcs_.size()), n = count();
  const double room = problem_.budget() - problem_.fixed_seconds();
  const double least = kLeastSeconds * room, all = room + slack();
  const std::vector<double> out_to = problem_.least_seconds_from(problem_.start());
  const std::vector<double> home_from = problem_.least_seconds_from(problem_.end());
  const auto used = [&](int a) { return std::max(arcs_[a].seconds, least); };
  // Every flight may be the way from start to end alone; any other arc is taken once.
  const auto times = [&](int a) {
    return arcs_[a].from == start_ && arcs_[a].to == end_ ? flights_ : 1;
  };
  for (int a = 0; a < arcs; ++a) program.add_column(0, times(a), true);
  for (int a = 0; a < arcs; ++a) program.add_column(0, times(a) * all, false);
  for (int v = 0; v < n; ++v) program.add_column(rewards ? (*rewards)[chosen_[v]] : 0, 1, true);

  using Entry = IntegerProgram::Entry;
  std::vector<std::vector<int>> into(n), out(n);
  std::vector<Entry> budget, images;
  for (int a = 0; a < arcs; ++a) {
    out[arcs_[a].from].push_back(a);
    into[arcs_[a].to].push_back(a);
    budget.push_back({x(a), arcs_[a].seconds});
    if (arcs_[a].passed > 0) images.push_back({x(a), static_cast<double>(arcs_[a].passed)});
    // An arc that is too far away for the budget has less than nothing left: it is never taken.
    const double left = all - out_to[chosen_[arcs_[a].from]] - arcs_[a].seconds;
    const double needed = home_from[chosen_[arcs_[a].to]];
    if (left < needed) {
      program.add_row(0, {{x(a), 1}}, 0);
      program.add_row(0, {{g(a), 1}}, 0);
      continue;
    }
    program.add_row(-kUnbounded, {{g(a), 1}, {x(a), -left}}, 0);
    program.add_row(0, {{g(a), 1}, {x(a), -needed}}, kUnbounded);
  }
  program.add_row(-kUnbounded, budget, flights_ * room);
  for (int v = 0; v < n; ++v) {
    std::vector<Entry> balance, time, taken{{y(v), 1}}, once;
    for (const int a : into[v]) {
      balance.push_back({x(a), 1});
      time.push_back({g(a), 1});
      taken.push_back({x(a), -1});
      once.push_back({x(a), 1});
    }
    for (const int a : out[v]) {
      balance.push_back({x(a), -1});
      time.push_back({g(a), -1});
      time.push_back({x(a), -used(a)});
    }
    const double net = flights_ * ((v == end_ ? 1 : 0) - (v == start_ ? 1 : 0));
    program.add_row(net, balance, net);
    images.push_back({y(v), 1});
    if (v == start_) {
      program.add_row(1, {{y(v), 1}}, 1);
      program.add_row(-flights_ * all, time, kUnbounded);
      // Nothing comes back to the start of a way; a loop closes once.
      if (problem_.each_once()) program.add_row(0, once, problem_.loop() ? flights_ : 0);
      continue;
    }
    if (v == end_ && flights_ > 1) {
      // Every flight ends here, and nothing goes on.
      program.add_row(1, {{y(v), 1}}, 1);
      program.add_row(flights_, once, flights_);
      continue;
    }
    // Where each view is visited once the arc into it is the view.
    program.add_row(problem_.each_once() ? 0 : -kUnbounded, taken, 0);
    // The end of a way keeps what is left.
    program.add_row(0, time, v == end_ ? kUnbounded : 0);
    if (problem_.each_once()) forbid_turning_back(program, v);
    if (!problem_.image_limit()) continue;
    for (const int a : into[v]) program.add_row(0, {{y(v), 1}, {x(a), -1}}, kUnbounded);
  }
  if (problem_.image_limit()) program.add_row(-kUnbounded, images, *problem_.image_limit());
}

// Valid where each view is visited once, and no more than that: what the relaxation would do most.
void TourProgram::forbid_turning_back(IntegerProgram& program, int view) const {
  for (const auto& [to, arc] : leaving_[view]) {
    if (to == start_) continue;
    const auto& list = leaving_[to];
    const auto back = std::lower_bound(list.begin(), list.end(), std::pair(view, 0));
    if (back == list.end() || back->first != view) continue;
    program.add_row(-kUnbounded, {{x(arc), 1}, {x(back->second), 1}, {y(view), -1}}, 0);
  }
}

bool TourProgram::put(const std::vector<int>& walk, std::vector<double>& point) const {
  const std::vector<int> on = chosen_on(walk);
  for (const int v : on) point[y(v)] = 1;
  const double room = problem_.budget() - problem_.fixed_seconds();
  const double least = kLeastSeconds * room;
  double left = room + slack();
  for (std::size_t k = 1; k < on.size(); ++k) {
    const auto& list = leaving_[on[k - 1]];
    const auto arc = std::find_if(list.begin(), list.end(),
                                  [&](const auto& known) { return known.first == on[k]; });
    if (arc == list.end()) return false;
    left -= std::max(arcs_[arc->second].seconds, least);
    point[x(arc->second)] += 1;
    point[g(arc->second)] += left;
  }
  return true;
}

std::vector<std::vector<int>> TourProgram::walks_of(const std::vector<double>& point) const {
  if (flights_ == 1) return {one_walk_of(point)};
  // No view but start and end is on two flights, so each flight is followed from view to view.
  std::vector<std::vector<int>> onward(chosen_.size());
  for (int v = 0; v < count(); ++v) {
    for (const auto& [to, arc] : leaving_[v]) {
      const auto taken = static_cast<int>(std::lround(point[x(arc)]));
      onward[v].insert(onward[v].end(), std::max(0, taken), to);
    }
  }
  std::vector<std::vector<int>> walks;
  for (int flight = 0; flight < flights_; ++flight) {
    std::vector<int> walk{problem_.start()};
    int v = start_;
    while (!onward[v].empty() && (v != end_ || walk.size() == 1)) {
      const int to = onward[v].back();
      onward[v].pop_back();
      problem_.append_way(chosen_[v], chosen_[to], walk);
      v = to;
    }
    walks.push_back(std::move(walk));
  }
  return walks;
}

// Hierholzer: arcs that are taken come and go at every view in balance, but for start and end.
std::vector<int> TourProgram::one_walk_of(const std::vector<double>& point) const {
  std::vector<std::vector<int>> onward(chosen_.size());
  for (int v = 0; v < count(); ++v) {
    for (const auto& [to, arc] : leaving_[v]) {
      if (point[x(arc)] > 0.5) onward[v].push_back(to);
    }
  }
  std::vector<int> stack{start_}, turned;
  while (!stack.empty()) {
    const int v = stack.back();
    if (onward[v].empty()) {
      turned.push_back(v);
      stack.pop_back();
    } else {
      stack.push_back(onward[v].back());
      onward[v].pop_back();
    }
  }
  std::vector<int> walk{problem_.start()};
  for (std::size_t k = turned.size() - 1; k-- > 0;) {
    problem_.append_way(chosen_[turned[k + 1]], chosen_[turned[k]], walk);
  }
  return walk;
}

}  // namespace lapwing
