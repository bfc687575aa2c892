// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/map/scan.h"
#include "framework/map/swept_box.h"

namespace lapwing {
namespace {

constexpr std::size_t kRaysAPart = 1024;

std::string text(double value) {
  std::string digits = std::to_string(value);
  digits.erase(std::max(digits.find_last_not_of('0'), digits.find('.') + 1) + 1);
  return digits;
}

std::string text(const Eigen::Vector3d& p) {
  return "(" + text(p.x()) + ", " + text(p.y()) + ", " + text(p.z()) + ")";
}

std::string reach_of(const VoxelGrid& grid) {
  return "a map with voxels of " + text(grid.resolution()) + " m reaches " + text(grid.reach()) +
         " m from the origin each way";
}

// Keeps traversals off the outermost voxels, where keys end.
bool inside(const VoxelGrid& grid, const Eigen::Vector3f& p) {
  const float reach = static_cast<float>(grid.reach() - 8 * grid.resolution());
  return std::abs(p.x()) < reach && std::abs(p.y()) < reach && std::abs(p.z()) < reach;
}

bool is_unit(const Eigen::Vector3d& direction) {
  return std::abs(direction.squaredNorm() - 1) < 1e-6;
}

bool castable(const VoxelGrid& grid, const MapRay& ray) {
  const Eigen::Vector3d& o = ray.origin;
  const double reach = grid.reach();
  return (o.x() >= -reach) & (o.x() < reach) & (o.y() >= -reach) & (o.y() < reach) &
         (o.z() >= -reach) & (o.z() < reach) & is_unit(ray.direction) & (ray.range > 0) &
         (ray.range <= std::numeric_limits<double>::max());
}

// For the first of several rays that cannot be cast.
[[noreturn]] void refuse_rays(const VoxelGrid& grid, std::span<const MapRay> rays) {
  std::size_t k = 0;
  while (k + 1 < rays.size() && castable(grid, rays[k])) ++k;
  const MapRay& ray = rays[k];
  const std::string name = "ray " + std::to_string(k);
  if (!grid.contains(ray.origin))
    throw InputError(name + " starts at " + text(ray.origin) + "; " + reach_of(grid));
  if (!is_unit(ray.direction))
    throw InputError(name + " points along " + text(ray.direction) +
                     ", which is not a unit vector");
  throw InputError(name + " has range " + text(ray.range) + "; it must be positive and finite");
}

}  // namespace

void Map::integrate(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W) {
  if (!inside(grid_, origin_W))
    throw InputError("a scan is taken from " + text(origin_W.cast<double>()) + "; " +
                     reach_of(grid_));
  for (std::size_t k = 0; k < points_W.size(); ++k)
    if (!inside(grid_, points_W[k]))
      throw InputError("point " + std::to_string(k) + " of a scan lies at " +
                       text(points_W[k].cast<double>()) + "; " + reach_of(grid_));
  if (!points_W.empty()) in_plugin(*this, "insert", [&] { insert(points_W, origin_W); });
}

void Map::integrate(const PosedDepthImage& measured) {
  scan_points(measured, settings_.pixel_step, settings_.maximum_range, settings_.resolution,
              points_);
  integrate(points_, measured.camera.position.cast<float>());
}

void Map::import(std::span<const VoxelLeaf> leaves) {
  std::vector<VoxelLeaf> clamped(leaves.begin(), leaves.end());
  for (VoxelLeaf& leaf : clamped) {
    if (leaf.level > kTreeDepth)
      throw InputError("a leaf of level " + std::to_string(leaf.level) + "; levels are 0 to 16");
    if (std::isnan(leaf.log_odds)) throw InputError("a leaf whose log odds is not a number");
    if (((leaf.key.x | leaf.key.y | leaf.key.z) & ((1 << leaf.level) - 1)) != 0)
      throw InputError("a leaf of level " + std::to_string(leaf.level) +
                       " begins between two cubes of its size");
    leaf.log_odds = std::clamp(leaf.log_odds, settings_.clamp_min, settings_.clamp_max);
    if (!settings_.observations) leaf.observations = 0;
  }
  if (!clamped.empty()) in_plugin(*this, "assign", [&] { assign(clamped); });
}

void Map::read_states(std::span<const VoxelKey> keys, std::span<VoxelState> states) const {
  for (std::size_t k = 0; k < keys.size(); ++k) states[k] = read(keys[k]).state;
}

double Map::uncertainty(std::uint16_t observations) const {
  return std::exp(-settings_.information * observations);
}

void Map::cast(std::span<const MapRay> rays, std::span<MapRayHit> hits) const {
  if (rays.size() != hits.size()) throw Error("as many hits as rays are needed");
  // Checked while they are at hand: over all rays first it would cost a tenth of the casts.
  std::atomic<bool> refused{false};
  parallel_for((rays.size() + kRaysAPart - 1) / kRaysAPart, threads_, [&](std::size_t part) {
    const std::size_t first = part * kRaysAPart;
    const std::size_t count = std::min(rays.size() - first, kRaysAPart);
    bool all = true;  // without branches: there are many, and hardly ever a bad one
    for (const MapRay& ray : rays.subspan(first, count)) all &= castable(grid_, ray);
    if (!all) {
      refused = true;
      return;
    }
    in_plugin(*this, "cast",
              [&] { cast_checked(rays.subspan(first, count), hits.subspan(first, count)); });
  });
  if (refused) refuse_rays(grid_, rays);
}

bool Map::box_free(const Eigen::Vector3d& lower_W, const Eigen::Vector3d& upper_W) const {
  if ((lower_W.array() > upper_W.array()).any())
    throw InputError("a box from " + text(lower_W) + " to " + text(upper_W) + " has no inside");
  const Eigen::Vector3d middle = (lower_W + upper_W) / 2;
  return swept_box_free(middle, middle, (upper_W - lower_W) / 2);
}

bool Map::swept_box_free(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W,
                         const Eigen::Vector3d& half) const {
  if (!from_W.allFinite() || !to_W.allFinite() || !half.allFinite() || half.minCoeff() < 0)
    throw InputError("a box with half edges " + text(half) + " moved from " + text(from_W) +
                     " to " + text(to_W) + ": numbers must be finite, edges not negative");
  for (const Eigen::Vector3d& end : {from_W, to_W}) {
    // Touching the end of the largest map is as good as touching a wall.
    const double slack = 2 * kTouching * grid_.resolution();
    if ((end.cwiseAbs() + half).maxCoeff() > grid_.reach() + slack) return false;
  }
  const SweptBox box(grid_, from_W, to_W, half);
  for (int i = 0; i < 3; ++i)
    if (box.lower[i] < 0 || box.upper[i] >= kKeyCount) return false;
  return in_plugin(*this, "swept_box_free", [&] { return sweep_checked(box); });
}

void Map::read_means(int level, std::span<const VoxelKey> keys,
                     std::span<MeanReading> means) const {
  if (level < 0 || level > 10)
    throw InputError("means over cubes of level " + std::to_string(level) + "; levels are 0 to 10");
  if (keys.size() != means.size()) throw Error("as many means as keys are needed");
  in_plugin(*this, "read_means", [&] { means_checked(level, keys, means); });
}

void Map::require_memory(std::size_t bytes) const {
  if (bytes <= settings_.memory_limit) return;
  const auto mebibytes = [](std::size_t n) { return std::to_string((n + (1u << 20) - 1) >> 20); };
  throw InputError("the map would take " + mebibytes(bytes) +
                   " MiB, more than its memory_limit of " + mebibytes(settings_.memory_limit) +
                   " MiB: raise it, take larger voxels or a shorter maximum_range");
}

}  // namespace lapwing
