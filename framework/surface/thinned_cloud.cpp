// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/thinned_cloud.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/surface/grid_table.h"

namespace lapwing {
namespace {

// Sums are of places within the cube, in single precision: 1e5 points of one cube are exact to 1e-4
// of its edge.
struct ThinnedCell {
  float place[3] = {};
  std::uint32_t points = 0;
};

// Of files with normals alone.
struct ThinnedNormal {
  float sum[3] = {};
};

constexpr double kFarthestCell = 1 << 20;  // of a grid key

}  // namespace

struct ThinnedCloud::Table {
  double cell = 1;
  std::size_t most = 0;
  std::uint64_t points = 0;
  GridTable<ThinnedCell> cells;
  GridTable<ThinnedNormal> normals;
};

ThinnedCloud::ThinnedCloud(double cell, std::size_t most) : table_(std::make_unique<Table>()) {
  if (!(cell > 0) || !std::isfinite(cell))
    throw InputError("thinned cloud: the cell must be above 0 m");
  table_->cell = cell;
  table_->most = most;
}

ThinnedCloud::~ThinnedCloud() = default;
ThinnedCloud::ThinnedCloud(ThinnedCloud&&) noexcept = default;

void ThinnedCloud::add(const Eigen::Vector3d& p, const Eigen::Vector3f& normal) {
  const Eigen::Vector3d scaled = p * (1 / table_->cell);
  if (!(scaled.cwiseAbs().maxCoeff() < kFarthestCell - 1))
    throw InputError("a point lies at (" + plain_number(p.x(), 9) + ", " + plain_number(p.y(), 9) +
                     ", " + plain_number(p.z(), 9) + ") m, too far from the world's origin for " +
                     "cubes of " + plain_number(table_->cell) + " m");
  const Eigen::Vector3d low = scaled.array().floor();
  const GridKey key =
      grid_key(static_cast<std::int64_t>(low.x()), static_cast<std::int64_t>(low.y()),
               static_cast<std::int64_t>(low.z()));
  ThinnedCell& cell = table_->cells[key];
  if (table_->cells.size() > table_->most)
    throw InputError("its points fill more than " + std::to_string(table_->most) + " cubes of " +
                     plain_number(table_->cell) +
                     " m: choose a larger resolution or a smaller region");
  for (int axis = 0; axis < 3; ++axis)
    cell.place[axis] += static_cast<float>(scaled[axis] - low[axis]);
  if (normal.allFinite() && normal.squaredNorm() > 0) {
    ThinnedNormal& sum = table_->normals[key];
    for (int axis = 0; axis < 3; ++axis) sum.sum[axis] += normal[axis];
  }
  ++cell.points;
  ++table_->points;
}

std::uint64_t ThinnedCloud::points() const {
  return table_->points;
}
std::size_t ThinnedCloud::cells() const {
  return table_->cells.size();
}
double ThinnedCloud::cell() const {
  return table_->cell;
}

std::vector<ThinnedPoint> ThinnedCloud::take() {
  std::vector<std::pair<GridKey, ThinnedCell>> cells;
  cells.reserve(table_->cells.size());
  for (const auto& slot : table_->cells.slots())
    if (slot.key != kNoPlace) cells.emplace_back(slot.key, slot.entry);
  const GridTable<ThinnedNormal> normals = std::move(table_->normals);
  *table_ = Table{table_->cell, table_->most, 0, {}, {}};
  std::sort(cells.begin(), cells.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ThinnedPoint> thinned;
  thinned.reserve(cells.size());
  constexpr std::uint64_t kAxis = (1 << 21) - 1;
  const auto along = [&](GridKey key, int shift) {
    return static_cast<double>(key >> shift & kAxis) - (1 << 20);
  };
  for (const auto& [key, cell] : cells) {
    const Eigen::Vector3d low(along(key, 42), along(key, 21), along(key, 0));
    const Eigen::Vector3d mean =
        Eigen::Vector3d(cell.place[0], cell.place[1], cell.place[2]) / cell.points;
    ThinnedPoint point;
    // Rounding must not lead into the next cube.
    point.position = table_->cell * (low + mean.cwiseMax(1e-3).cwiseMin(1 - 1e-3));
    if (const ThinnedNormal* sum = normals.find(key)) {
      const Eigen::Vector3d normal(sum->sum[0], sum->sum[1], sum->sum[2]);
      if (normal.norm() > 1e-3 * cell.points) point.normal = normal.normalized();
    }
    point.points = cell.points;
    thinned.push_back(point);
  }
  return thinned;
}

}  // namespace lapwing
