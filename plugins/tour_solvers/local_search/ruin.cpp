// SPDX-License-Identifier: Apache-2.0
// How: Overlaps gives each view 512 bits, one for each part of the list of voxels, in the order of
// their keys. Two views share about as many voxels as they share bits. When a view leaves the tour,
// its loss is known exactly. A view that shares bits with it may gain up to that share of the loss,
// and at most what it brings alone. This estimate decides which views are evaluated first.
//
// `exchange` enters a cluster that no single view of it is worth the way to: it inserts several
// views at once and then removes the views with the least known gain per second saved, times a
// random factor, until the tour fits the budget again.
#include "plugins/tour_solvers/local_search/ruin.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace lapwing {
namespace {

// A random view that is off the tour and may bring something, and those nearest to it.
std::vector<int> cluster(const WorkingTour& tour, int count, const KnownGains& known,
                         Random& random) {
  const auto wanted = [&](int view) { return !tour.taken(view) && known.gains[view] > 0; };
  const TourProblem& problem = tour.problem();
  const auto from_start = problem.legs_from(problem.start());
  const auto from_end = problem.legs_from(problem.end());
  const double most = problem.budget() - problem.fixed_seconds();
  for (int trial = 0; trial < 20; ++trial) {
    const int middle = static_cast<int>(random.integer(0, problem.views() - 1));
    if (!wanted(middle) || from_start[middle] + from_end[middle] > most) continue;
    const auto legs = problem.legs_from(middle);
    std::vector<int> near;
    for (int view = 0; view < problem.views(); ++view) {
      if (wanted(view) && legs[view] <= most) near.push_back(view);
    }
    const auto end = near.begin() + std::min<std::ptrdiff_t>(count, std::ssize(near));
    std::partial_sort(near.begin(), end, near.end(),
                      [&](int a, int b) { return legs[a] != legs[b] ? legs[a] < legs[b] : a < b; });
    near.erase(end, near.end());
    return near;
  }
  return {};
}

void insert_cheaply(WorkingTour& tour, int view) {
  const auto legs = tour.problem().legs_from(view);
  const std::vector<int>& walk = tour.walk();
  int after = -1;
  double least = HUGE_VAL;
  for (int i = 0; i + 1 < tour.size(); ++i) {
    const double more =
        legs[walk[i]] + legs[walk[i + 1]] - tour.problem().leg(walk[i], walk[i + 1]);
    if (more < least) {
      least = more;
      after = i;
    }
  }
  if (after >= 0 && tour.admits(view, after)) tour.insert(view, after);
}

// The view whose known worth per second saved is least, new ones only where there is no other;
// negative where none saves anything.
int least_worthy(const WorkingTour& tour, const KnownGains& known, const std::vector<int>& added,
                 Random& random) {
  const std::vector<int>& walk = tour.walk();
  int least = -1;
  double least_worth = HUGE_VAL;
  for (const bool spare : {true, false}) {
    for (int i = 1; i + 1 < tour.size(); ++i) {
      if (spare && std::find(added.begin(), added.end(), walk[i]) != added.end()) continue;
      const TourProblem& problem = tour.problem();
      const double saved = problem.leg(walk[i - 1], walk[i]) + problem.leg(walk[i], walk[i + 1]) -
                           problem.leg(walk[i - 1], walk[i + 1]);
      const double worth = known.gains[walk[i]] * random.uniform(0.7, 1.3) / std::max(saved, 1e-9);
      if (saved <= 1e-9 || worth >= least_worth) continue;
      least_worth = worth;
      least = walk[i];
    }
    if (least >= 0) break;
  }
  return least;
}

std::vector<int> stretch(const WorkingTour& tour, int count, Random& random) {
  const int first = static_cast<int>(random.integer(1, std::max(1, tour.size() - 1 - count)));
  const int last = std::min(first + count, tour.size() - 1);
  return {tour.walk().begin() + first, tour.walk().begin() + last};
}

std::vector<int> neighbours(const WorkingTour& tour, int count, Random& random) {
  const std::vector<int>& walk = tour.walk();
  const auto legs = tour.problem().legs_from(walk[random.integer(0, tour.size() - 1)]);
  std::vector<int> near(walk.begin() + 1, walk.end() - 1);
  count = std::min(count, static_cast<int>(near.size()));
  std::partial_sort(near.begin(), near.begin() + count, near.end(),
                    [&](int a, int b) { return legs[a] != legs[b] ? legs[a] < legs[b] : a < b; });
  near.resize(count);
  return near;
}

std::vector<int> any(const WorkingTour& tour, int count, Random& random) {
  std::vector<int> chosen;
  for (int i = 0; i < count; ++i) {
    chosen.push_back(tour.walk()[random.integer(1, tour.size() - 2)]);
  }
  return chosen;
}

}  // namespace

void take_out_view(WorkingTour& tour, int view, KnownGains& known) {
  if (tour.visits(view) == 0) return;  // went with another one
  const double before = tour.score();
  for (int i = 1; i + 1 < tour.size(); ++i) {
    if (tour.walk()[i] != view) continue;
    if (!tour.take_out(i, i)) return;
    break;
  }
  if (tour.visits(view) == 0) {
    known.left(tour.problem().score(), view, std::max(0.0, before - tour.score()));
  }
}

void shrink_to_budget(WorkingTour& tour, const std::vector<int>& added, KnownGains& known,
                      Random& random) {
  while (tour.room() < 0) {
    const int view = least_worthy(tour, known, added, random);
    const int before = tour.size();
    if (view < 0) break;
    take_out_view(tour, view, known);
    if (tour.size() >= before) break;  // another way took its place
  }
}

Overlaps::Overlaps(const ViewScore& score)
    : bits_(static_cast<std::size_t>(score.views()) * kWords, 0), lists_(score.views()) {
  std::vector<char> seen(score.voxels(), 0);
  bool shared = false;
  for (int view = 0; view < score.views(); ++view) {
    for (const std::uint32_t voxel : score.voxels_of(view))
      shared = std::exchange(seen[voxel], 1) > 0 || shared;
  }
  if (!shared) return;  // a score of views: none changes what another one brings
  for (int view = 0; view < score.views(); ++view) {
    std::uint64_t* words = bits_.data() + static_cast<std::size_t>(view) * kWords;
    for (const std::uint32_t voxel : score.voxels_of(view)) {
      const std::uint64_t bit = std::uint64_t{voxel} * (kWords * 64) / score.voxels();
      words[bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
}

const std::vector<Overlaps::Shared>& Overlaps::of(int view) {
  List& list = lists_[view];
  if (list.known) return list.shared;
  list.known = true;
  const std::uint64_t* a = bits_.data() + static_cast<std::size_t>(view) * kWords;
  int all = 0;
  for (int i = 0; i < kWords; ++i) all += std::popcount(a[i]);
  for (int other = 0; other < static_cast<int>(lists_.size()); ++other) {
    const std::uint64_t* b = bits_.data() + static_cast<std::size_t>(other) * kWords;
    int common = 0;
    for (int i = 0; i < kWords; ++i) common += std::popcount(a[i] & b[i]);
    if (common > 0 && other != view) {
      list.shared.push_back({other, static_cast<double>(common) / all});
    }
  }
  return list.shared;
}

void KnownGains::left(const ViewScore& score, int view, double loss) {
  gains[view] = loss;
  for (const auto& [other, share] : overlaps->of(view)) {
    gains[other] = std::min(score.alone(other), gains[other] + share * loss);
  }
}

bool exchange(WorkingTour& tour, int count, KnownGains& known, Random& random) {
  const std::vector<int> added = cluster(tour, count, known, random);
  for (const int view : added) {
    if (!tour.taken(view)) insert_cheaply(tour, view);
  }
  tour.shorten();
  shrink_to_budget(tour, added, known, random);
  return !added.empty();
}

void ruin(WorkingTour& tour, int count, KnownGains& known, Random& random) {
  if (tour.size() < 3) return;
  const std::int64_t how = random.integer(0, 2);
  const std::vector<int> views = how == 0   ? stretch(tour, count, random)
                                 : how == 1 ? neighbours(tour, count, random)
                                            : any(tour, count, random);
  for (const int view : views) take_out_view(tour, view, known);
}

}  // namespace lapwing
