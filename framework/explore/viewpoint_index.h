// SPDX-License-Identifier: Apache-2.0
// Viewpoints by where they are: whether one has been met before.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "framework/view/viewpoint.h"

namespace lapwing {

// Two viewpoints of one pitch are the same within a millimetre and a ten thousandth of a radian of
// yaw (reading 5.6: equal within a tolerance). Not thread-safe.
class ViewpointIndex {
 public:
  static constexpr double kSamePlace = 1e-3;  // m, along each axis
  static constexpr double kSameYaw = 1e-4;    // rad

  // The place of an equal viewpoint, -1 where there is none.
  int find(const Viewpoint& view) const {
    std::int64_t low[3], high[3];
    for (int i = 0; i < 3; ++i) {
      low[i] = cell(view.position[i] - kSamePlace);
      high[i] = cell(view.position[i] + kSamePlace);
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const auto range = cells_.equal_range(key(x, y, z));
          for (auto it = range.first; it != range.second; ++it)
            if (same(views_[static_cast<std::size_t>(it->second)], view)) return it->second;
        }
    return -1;
  }

  // The place of the viewpoint, which is added where it is new.
  int add(const Viewpoint& view) {
    const int known = find(view);
    if (known >= 0) return known;
    views_.push_back(view);
    const int place = static_cast<int>(views_.size()) - 1;
    cells_.emplace(key(cell(view.position[0]), cell(view.position[1]), cell(view.position[2])),
                   place);
    return place;
  }

  const Viewpoint& operator[](int place) const { return views_[static_cast<std::size_t>(place)]; }
  int size() const { return static_cast<int>(views_.size()); }

 private:
  static bool same(const Viewpoint& a, const Viewpoint& b) {
    const double turn = std::remainder(a.yaw - b.yaw, 2 * std::numbers::pi);
    return (a.position - b.position).cwiseAbs().maxCoeff() <= kSamePlace &&
           std::abs(turn) <= kSameYaw && std::abs(a.pitch - b.pitch) <= kSameYaw;
  }
  static std::int64_t cell(double coordinate) {
    return static_cast<std::int64_t>(std::floor(coordinate / 0.5));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
    return part(x) | part(y) << 21 | part(z) << 42;
  }

  std::vector<Viewpoint> views_;
  std::unordered_multimap<std::uint64_t, int> cells_;
};

}  // namespace lapwing
