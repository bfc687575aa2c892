// SPDX-License-Identifier: Apache-2.0
// How: parts are written one after another, then the columns z with their rows, then the rows that
// put alike parts in order. z is whole, so that CBC can decide first whether a view is taken at
// all, and then by which tour.
//
// A start is brought into the order of the rows: views that a tour visits again are left out where
// they may be (they only cost), each view is counted by one tour, and alike tours are exchanged.
#include "plugins/tour_solvers/milp/team_program.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace lapwing {
namespace {

// Rows that order two tours by their views: for the views of largest reward. Those of all would
// have as many entries as views squared.
constexpr int kMostRanked = 60;
// Views in the words of the other order; with more, factors would differ too much for CBC.
constexpr int kLetters = 10;

std::vector<int> within_reach(const TourProblem& problem, const std::vector<int>& chosen) {
  const std::vector<int> reachable = problem.reachable();
  std::vector<int> both;
  std::set_intersection(chosen.begin(), chosen.end(), reachable.begin(), reachable.end(),
                        std::back_inserter(both));
  return both;
}

}  // namespace

bool alike(const TourProblem& a, const TourProblem& b) {
  if (a.budget() != b.budget() || a.image_limit() != b.image_limit()) return false;
  if (a.start() != b.start() || a.end() != b.end()) return false;
  if (a.same_ways(b)) return true;
  if (a.fixed_seconds() != b.fixed_seconds()) return false;
  for (int v = 0; v < a.views(); ++v) {
    if (a.each_once() && !std::ranges::equal(a.legs_from(v), b.legs_from(v))) return false;
    if (!std::ranges::equal(a.neighbours_of(v), b.neighbours_of(v))) return false;
    if (!std::ranges::equal(a.neighbour_legs_of(v), b.neighbour_legs_of(v))) return false;
  }
  return true;
}

TeamProgram::TeamProgram(const TeamProblem& problem, const std::vector<double>& rewards,
                         const std::vector<int>& chosen, int neighbours, const Walks& walks)
    : problem_(problem), rewards_(rewards), chosen_(chosen), ends_(problem.views(), 0) {
  bool limited = false;
  for (int t = 0; t < problem.size(); ++t) {
    ends_[problem.tour(t).start()] = ends_[problem.tour(t).end()] = 1;
    limited = limited || problem.tour(t).image_limit();
  }
  for (const int view : chosen_) {
    if (!is_end(view)) by_rank_.push_back(view);
  }
  std::stable_sort(by_rank_.begin(), by_rank_.end(),
                   [&](int a, int b) { return rewards[a] > rewards[b]; });

  std::vector<std::vector<int>> groups;
  for (int t = 0; t < problem.size(); ++t) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return alike(problem.tour(group.front()), problem.tour(t));
    });
    if (same == groups.end())
      groups.push_back({t});
    else
      same->push_back(t);
  }
  const bool once = problem.tour(0).each_once();
  visits_once_ = once && std::all_of(groups.begin(), groups.end(), [&](const auto& group) {
                   return keeps_triangle_inequality(problem.tour(group.front()), chosen_);
                 });
  counts_once_ = visits_once_ || (!once && !limited);
  const Walks begins = walks.empty() ? walks : without_repeats(walks);
  for (const std::vector<int>& group : groups) {
    const TourProblem& tour = problem.tour(group.front());
    const std::vector<int> near = within_reach(tour, chosen_);
    const bool together = visits_once_ && !tour.image_limit();
    for (std::size_t first = 0; first < group.size(); first += together ? group.size() : 1) {
      Part part;
      part.tours.assign(group.begin() + static_cast<std::ptrdiff_t>(first),
                        together ? group.end() : group.begin() + 1 + std::ptrdiff_t(first));
      // Alike tours can begin with the walks of each other.
      Walks of_group;
      for (const int t : group) {
        if (!begins.empty()) of_group.push_back(begins[t]);
      }
      part.program = std::make_unique<TourProgram>(tour, near, neighbours, of_group,
                                                   static_cast<int>(part.tours.size()));
      alike_.push_back(first > 0);
      parts_.push_back(std::move(part));
    }
  }
}

std::int64_t TeamProgram::columns() const {
  std::int64_t all = shares() ? std::ssize(chosen_) : 0;
  for (const Part& part : parts_) all += part.program->columns();
  return all;
}

bool TeamProgram::has_all_arcs() const {
  return std::all_of(parts_.begin(), parts_.end(),
                     [](const Part& part) { return part.program->complete(); });
}

bool TeamProgram::has_all_shortcuts() const {
  return std::all_of(parts_.begin(), parts_.end(), [](const Part& part) {
    return holds_shortcuts(part.program->problem(), part.program->chosen());
  });
}

void TeamProgram::write() {
  for (const Part& part : parts_) part.program->write(program_, shares() ? nullptr : &rewards_);
  if (!shares()) return;
  write_shared_score();
  write_order();
}

void TeamProgram::write_shared_score() {
  for (const int view : chosen_) {
    z_.push_back(program_.add_column(rewards_[view], 1, true));
    // On every tour, or on the way of one that always flies.
    if (is_end(view)) {
      program_.add_row(1, {{z_.back(), 1}}, 1);
      continue;
    }
    std::vector<IntegerProgram::Entry> row{{z_.back(), 1}};
    for (const Part& part : parts_) {
      const int column = part.program->column_of(view);
      if (column >= 0) row.push_back({column, -1});
    }
    program_.add_row(counts_once_ ? 0 : -kUnbounded, row, 0);
  }
}

void TeamProgram::write_order() {
  for (std::size_t p = 1; p < parts_.size(); ++p) {
    if (!alike_[p]) continue;
    const TourProgram &first = *parts_[p - 1].program, &second = *parts_[p].program;
    if (counts_once_)
      order_by_views(first, second);
    else
      order_by_words(first, second);
  }
}

// What the second tour counts comes after something that the first one counts.
void TeamProgram::order_by_views(const TourProgram& first, const TourProgram& second) {
  std::vector<IntegerProgram::Entry> before;
  int ranked = 0;
  for (const int view : by_rank_) {
    if (second.column_of(view) < 0) continue;  // out of reach, of both
    if (++ranked > kMostRanked) return;
    std::vector<IntegerProgram::Entry> row = before;
    row.push_back({second.column_of(view), 1});
    program_.add_row(-kUnbounded, row, 0);
    before.push_back({first.column_of(view), -1});
  }
}

// What the first tour visits of the views of largest reward comes not after what the second one
// does, as words do: the numbers that the visits make in base two.
void TeamProgram::order_by_words(const TourProgram& first, const TourProgram& second) {
  std::vector<IntegerProgram::Entry> row;
  double weight = std::exp2(kLetters);
  for (const int view : letters(first)) {
    weight /= 2;
    row.push_back({first.column_of(view), weight});
    row.push_back({second.column_of(view), -weight});
  }
  if (!row.empty()) program_.add_row(0, row, kUnbounded);
}

std::vector<int> TeamProgram::letters(const TourProgram& part) const {
  std::vector<int> views;
  for (const int view : by_rank_) {
    if (part.column_of(view) >= 0 && std::ssize(views) < kLetters) views.push_back(view);
  }
  return views;
}

// Walks without what only costs: views that another one has, and ends of others.
Walks TeamProgram::without_repeats(Walks walks) const {
  if (!visits_once_) return walks;
  std::set<int> seen;
  for (std::vector<int>& walk : walks) {
    if (walk.size() < 3) continue;
    const auto spare = [&](int view) { return is_end(view) || !seen.insert(view).second; };
    walk.erase(std::remove_if(walk.begin() + 1, walk.end() - 1, spare), walk.end() - 1);
  }
  return walks;
}

std::vector<double> TeamProgram::point_of(const Walks& walks) const {
  const Walks begins = without_repeats(walks);
  std::vector<double> point(program_.columns(), 0);
  // Views that each tour counts, by rank.
  std::vector<std::vector<int>> counted(begins.size());
  std::vector<int> rank(problem_.views(), -1);
  for (std::size_t r = 0; r < by_rank_.size(); ++r) rank[by_rank_[r]] = static_cast<int>(r);
  std::set<int> taken;
  for (std::size_t t = 0; t < begins.size(); ++t) {
    for (const int view : begins[t]) {
      if (rank[view] >= 0 && taken.insert(view).second) counted[t].push_back(rank[view]);
    }
    std::sort(counted[t].begin(), counted[t].end());
  }
  for (std::size_t p = 0; p < parts_.size();) {
    // Alike parts follow each other; their walks are dealt in order.
    std::size_t end = p + 1;
    while (end < parts_.size() && alike_[end]) ++end;
    std::vector<int> tours;
    for (std::size_t q = p; q < end; ++q)
      tours.insert(tours.end(), parts_[q].tours.begin(), parts_[q].tours.end());
    const std::vector<int> spelled = letters(*parts_[p].program);
    const auto word = [&](int t) {
      std::vector<char> visits;
      for (const int view : spelled)
        visits.push_back(std::find(begins[t].begin(), begins[t].end(), view) != begins[t].end());
      return visits;
    };
    const auto first_of = [&](int t) {
      return counted[t].empty() ? problem_.views() : counted[t].front();
    };
    std::stable_sort(tours.begin(), tours.end(), [&](int a, int b) {
      return counts_once_ ? first_of(a) < first_of(b) : word(a) > word(b);
    });
    std::size_t next = 0;
    for (std::size_t q = p; q < end; ++q) {
      const TourProgram& program = *parts_[q].program;
      for (std::size_t k = 0; k < parts_[q].tours.size(); ++k) {
        const int t = tours[next++];
        if (!program.put(begins[t], point)) return {};
        if (!counts_once_ || visits_once_) continue;
        for (const int view : begins[t]) {
          const bool counts = rank[view] >= 0 &&
                              std::binary_search(counted[t].begin(), counted[t].end(), rank[view]);
          if (rank[view] >= 0 && program.column_of(view) >= 0)
            point[program.column_of(view)] = counts ? 1 : 0;
        }
      }
    }
    p = end;
  }
  for (std::size_t i = 0; i < z_.size(); ++i)
    point[z_[i]] = is_end(chosen_[i]) || taken.contains(chosen_[i]) ? 1 : 0;
  return point;
}

Walks TeamProgram::walks_of(const std::vector<double>& point) const {
  Walks walks(problem_.size());
  for (const Part& part : parts_) {
    std::vector<std::vector<int>> own = part.program->walks_of(point);
    for (std::size_t k = 0; k < part.tours.size(); ++k) walks[part.tours[k]] = std::move(own[k]);
  }
  return walks;
}

}  // namespace lapwing
