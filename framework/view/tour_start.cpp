// SPDX-License-Identifier: Apache-2.0
#include "framework/view/tour_start.h"

#include <algorithm>
#include <numeric>

#include "framework/core/error.h"

namespace lapwing {

ViewIslands::ViewIslands(std::size_t count, std::span<const ViewMotion> motions)
    : island_(count), sizes_(count, 0) {
  std::iota(island_.begin(), island_.end(), 0);
  const auto root = [&](int v) {
    while (island_[static_cast<std::size_t>(v)] != v) v = island_[static_cast<std::size_t>(v)];
    return v;
  };
  for (const ViewMotion& m : motions) {
    const int a = root(m.a), b = root(m.b);
    island_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  for (int v = 0; v < static_cast<int>(count); ++v) {
    const int island = root(v);
    island_[static_cast<std::size_t>(v)] = island;
    ++sizes_[static_cast<std::size_t>(island)];
  }
}

int ViewIslands::joined(int view) const {
  return sizes_[static_cast<std::size_t>(island_[static_cast<std::size_t>(view)])];
}

int ViewIslands::best_start(int given) const {
  if (given < 1 || given > static_cast<int>(island_.size())) throw Error("a tour has no start");
  int best = 0;
  for (int v = 1; v < given; ++v)
    if (joined(v) > joined(best)) best = v;
  return best;
}

std::optional<ViewIslands::Island> ViewIslands::largest_beside(
    int view, std::span<const Viewpoint> views) const {
  const int own = island_[static_cast<std::size_t>(view)];
  int largest = -1;
  for (int k = 0; k < static_cast<int>(sizes_.size()); ++k) {
    const int size = sizes_[static_cast<std::size_t>(k)];
    if (k != own && size > (largest < 0 ? 0 : sizes_[static_cast<std::size_t>(largest)]))
      largest = k;
  }
  if (largest < 0) return std::nullopt;
  Island found{sizes_[static_cast<std::size_t>(largest)], -1};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto for_each = [&](auto visit) {
    for (std::size_t v = 0; v < island_.size(); ++v)
      if (island_[v] == largest) visit(static_cast<int>(v), views[v].position);
  };
  for_each([&](int, const Eigen::Vector3d& p) { mean += p / found.views; });
  double nearest = 0;
  for_each([&](int v, const Eigen::Vector3d& p) {
    const double away = (p - mean).norm();
    if (found.middle >= 0 && away >= nearest) return;
    found.middle = v;
    nearest = away;
  });
  return found;
}

}  // namespace lapwing
