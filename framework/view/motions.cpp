// SPDX-License-Identifier: Apache-2.0
#include "framework/view/motions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Pair = std::pair<int, int>;

constexpr std::size_t kReported = 1000;  // pairs at a time

// Every viewpoint with the nearest that match it, each pair once, ascending.
template <class Matchable>
std::vector<Pair> neighbour_pairs(const std::vector<Viewpoint>& viewpoints,
                                  const MotionSettings& settings, int threads,
                                  const CancellationToken* cancellation, Matchable match,
                                  std::int64_t& unmatched) {
  const std::size_t count = viewpoints.size();
  const auto wanted = static_cast<std::size_t>(settings.neighbours);
  const auto most = std::min(static_cast<std::size_t>(settings.among), count - 1);
  std::vector<std::vector<Pair>> found(count);
  std::vector<std::int64_t> refused(count, 0);
  parallel_for(count, threads, [&](std::size_t k) {
    if (cancellation && cancellation->cancelled()) return;
    std::vector<std::pair<double, int>> by_distance;
    by_distance.reserve(count);
    for (std::size_t j = 0; j < count; ++j)
      if (j != k)
        by_distance.emplace_back((viewpoints[j].position - viewpoints[k].position).squaredNorm(),
                                 static_cast<int>(j));
    std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(most),
                      by_distance.end());
    for (std::size_t i = 0; i < most && found[k].size() < wanted; ++i) {
      const Pair pair = std::minmax(static_cast<int>(k), by_distance[i].second);
      if (match(pair)) {
        found[k].push_back(pair);
      } else {
        ++refused[k];
      }
    }
  });
  if (cancellation && cancellation->cancelled()) throw Cancelled();
  unmatched = std::accumulate(refused.begin(), refused.end(), std::int64_t{0});
  std::vector<Pair> pairs;
  for (const auto& list : found) pairs.insert(pairs.end(), list.begin(), list.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

enum class Outcome { blocked, straight, planned, cancelled };

// Iterations of a search in a small box, where a planner's own limit is meant for wide spaces.
constexpr std::int64_t kNearIterations = 500;

// Around all ways between two places that are not longer than `length`, m: around the ellipsoid
// whose foci the places are.
Eigen::AlignedBox3d box_of_ways(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                double length) {
  const Eigen::Vector3d middle = (from + to) / 2, along = (to - from) / 2;
  // Half axes: length / 2 along the line, sqrt(length^2 / 4 - |along|^2) across.
  const double across = std::max(0.0, length * length / 4 - along.squaredNorm());
  const Eigen::Vector3d reach = (along.cwiseAbs2().array() + across).sqrt();
  return {middle - reach, middle + reach};
}

}  // namespace

MotionGraph find_motions(const FreeSpace& space, const std::vector<Viewpoint>& viewpoints,
                         const std::vector<std::vector<VoxelKey>>& seen,
                         const MotionSettings& settings, std::uint64_t seed, int threads,
                         const CancellationToken* cancellation,
                         const std::function<void(std::size_t, std::size_t)>& report) {
  if (settings.alpha > 0 && seen.size() != viewpoints.size())
    throw Error("find_motions: the seen voxels belong to other viewpoints");
  if (settings.neighbours < 1 || settings.among < settings.neighbours)
    throw InputError("motions: neighbours must be at least 1 and among no fewer, not " +
                     std::to_string(settings.neighbours) + " among " +
                     std::to_string(settings.among));
  if (!(settings.alpha >= 0 && settings.alpha <= 1))
    throw InputError("motions: alpha must lie between 0 and 1");
  if (!(settings.longest_detour >= 1))
    throw InputError("motions: the longest detour must be at least 1");
  MotionGraph graph;
  if (viewpoints.size() < 2) return graph;
  const auto match = [&](const Pair& pair) {
    return settings.alpha == 0 ||
           matchable(seen[static_cast<std::size_t>(pair.first)],
                     seen[static_cast<std::size_t>(pair.second)], settings.alpha);
  };
  const std::vector<Pair> pairs =
      neighbour_pairs(viewpoints, settings, threads, cancellation, match, graph.unmatched);
  std::vector<Outcome> outcomes(pairs.size(), Outcome::blocked);
  std::vector<ViewMotion> motions(pairs.size());
  const Random seeds(seed);
  const auto try_pair = [&](std::size_t k) {
    if (cancellation && cancellation->cancelled()) {
      outcomes[k] = Outcome::cancelled;
      return;
    }
    const auto [a, b] = pairs[k];
    const auto at = [&](int i) -> const Viewpoint& {
      return viewpoints[static_cast<std::size_t>(i)];
    };
    const Eigen::Vector3d& from = at(a).position;
    const Eigen::Vector3d& to = at(b).position;
    const double straight = (to - from).norm();
    if (space.swept_box_free(from, to, settings.half)) {
      outcomes[k] = Outcome::straight;
      motions[k] = {a, b, {from, to}, straight};
      return;
    }
    if (!settings.planner) return;
    PathProblem problem{&space, from, to, settings.half,
                        settings.search_near
                            ? box_of_ways(from, to, settings.longest_detour * straight)
                                  .intersection(settings.allowed)
                            : settings.allowed};
    PathRequest request;
    request.seed = seeds.split(k).bits();
    request.cancellation = cancellation;
    if (settings.search_near) request.iteration_limit = kNearIterations;
    PathResult path = settings.planner->plan(problem, request);
    if (path.report.status != PathStatus::found ||
        path.report.length > settings.longest_detour * straight)
      return;
    outcomes[k] = Outcome::planned;
    motions[k] = {a, b, std::move(path.points), path.report.length};
  };
  for (std::size_t first = 0; first < pairs.size(); first += kReported) {
    const std::size_t size = std::min(kReported, pairs.size() - first);
    parallel_for(size, threads, [&](std::size_t k) { try_pair(first + k); });
    if (report) report(first + size, pairs.size());
  }
  graph.tried = static_cast<std::int64_t>(pairs.size()) + graph.unmatched;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (outcomes[k] == Outcome::cancelled) throw Cancelled();
    graph.blocked += outcomes[k] == Outcome::blocked;
    graph.planned += outcomes[k] == Outcome::planned;
    if (outcomes[k] == Outcome::straight || outcomes[k] == Outcome::planned)
      graph.motions.push_back(std::move(motions[k]));
  }
  return graph;
}

}  // namespace lapwing
