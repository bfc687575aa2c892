// SPDX-License-Identifier: Apache-2.0
// How: prisms are looked up column by column once. Columns under the same prisms share one set of
// bands, so that a column takes four bytes. The band of a prism does not depend on the column.
#include "framework/map/region_voxels.h"

#include <algorithm>
#include <map>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kMostColumns = 268435456;  // 2^28

// The first and the last voxel along an axis whose centres lie between two coordinates.
std::pair<int, int> voxels_between(double low, double high, const VoxelGrid& grid) {
  int first = grid.index(low), last = grid.index(high);
  if (grid.center(first) < low) ++first;
  if (grid.center(last) > high) --last;
  return {first, last};
}

VoxelKey key_of(const int at[3]) {
  return {static_cast<std::uint16_t>(at[0]), static_cast<std::uint16_t>(at[1]),
          static_cast<std::uint16_t>(at[2])};
}

}  // namespace

RegionVoxels::RegionVoxels(const InterestRegion& region, const VoxelGrid& grid) {
  const Eigen::AlignedBox3d& bounds = region.bounds();
  if (region.is_empty() || !bounds.min().allFinite() || !bounds.max().allFinite())
    throw InputError("the region of interest is empty");
  if (!grid.contains(bounds.min()) || !grid.contains(bounds.max()))
    throw InputError(
        "the region of interest is too far from the origin for a map of this resolution");
  int lower[3], upper[3];
  for (int axis = 0; axis < 3; ++axis) {
    std::tie(lower[axis], upper[axis]) =
        voxels_between(bounds.min()[axis], bounds.max()[axis], grid);
    if (lower[axis] > upper[axis])
      throw InputError("the region of interest is thinner than a voxel of the map");
  }
  box_ = {key_of(lower), key_of(upper)};
  if (!region.is_box()) add_columns(region, grid);
}

void RegionVoxels::add_columns(const InterestRegion& region, const VoxelGrid& grid) {
  const auto& prisms = region.prisms();
  const double count = static_cast<double>(box_.upper.x - box_.lower.x + 1) *
                       static_cast<double>(box_.upper.y - box_.lower.y + 1);
  if (count > kMostColumns)
    throw InputError(
        "the regions of interest have more than 2^28 columns of voxels between them: set a larger "
        "resolution or smaller regions");
  columns_.assign(static_cast<std::size_t>(count), 0);
  sets_.emplace_back();
  std::map<std::vector<std::size_t>, std::uint32_t> numbers{{{}, 0}};  // of sets of prisms
  std::vector<Band> bands;
  std::vector<Eigen::AlignedBox3d> bounds;
  for (std::size_t k = 0; k < prisms.size(); ++k) {
    const auto [low, high] = voxels_between(prisms[k].low, prisms[k].high, grid);
    bands.push_back({low, high, prisms[k].weight});
    bounds.push_back(prisms[k].bounds());
  }
  std::vector<char> met(prisms.size(), 0);
  std::vector<std::size_t> over;
  for (int y = box_.lower.y; y <= box_.upper.y; ++y)
    for (int x = box_.lower.x; x <= box_.upper.x; ++x) {
      const Eigen::Vector2d p(grid.center(x), grid.center(y));
      over.clear();
      for (std::size_t k = 0; k < prisms.size(); ++k) {
        if (bands[k].low > bands[k].high || p.x() < bounds[k].min().x() ||
            p.x() > bounds[k].max().x() || p.y() < bounds[k].min().y() ||
            p.y() > bounds[k].max().y() || !prisms[k].contains(p))
          continue;
        over.push_back(k);
        met[k] = 1;
      }
      if (over.empty()) continue;
      const auto [found, added] = numbers.try_emplace(over, sets_.size());
      if (added) {
        sets_.emplace_back();
        for (const std::size_t k : over) sets_.back().push_back(bands[k]);
      }
      columns_[column(x, y)] = found->second;
    }
  for (std::size_t k = 0; k < prisms.size(); ++k)
    if (!met[k])
      throw InputError(prisms[k].label(k + 1) +
                       " holds the middle of no voxel of the map: it is too narrow or too flat for "
                       "this resolution");
}

double RegionVoxels::weight(const VoxelKey& key) const {
  if (!box_.contains(key)) return 0;
  if (columns_.empty()) return 1;
  double weight = 0;
  for (const Band& band : sets_[columns_[column(key.x, key.y)]])
    if (key.z >= band.low && key.z <= band.high) weight = std::max(weight, band.weight);
  return weight;
}

}  // namespace lapwing
