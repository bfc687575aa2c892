// SPDX-License-Identifier: Apache-2.0
#include "framework/map/plain_map.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/map/swept_box.h"

namespace lapwing {
namespace {

using Keys = std::set<VoxelKey>;

// OctoMap's traversal: distances in double, points and directions in single precision. What the ray
// passes, from the voxel of `from` to the one before that of `to`; nothing where they are one.
void pass(const VoxelGrid& grid, const Eigen::Vector3f& from, const Eigen::Vector3f& to,
          Keys& passed) {
  const VoxelKey last = grid.key(to.cast<double>());
  VoxelKey key = grid.key(from.cast<double>());
  if (key == last) return;
  passed.insert(key);
  Eigen::Vector3f d = to - from;
  const float length = static_cast<float>(
      std::sqrt(static_cast<double>(d.x() * d.x() + d.y() * d.y() + d.z() * d.z())));
  d /= length;
  double next[3], spacing[3];
  for (int i = 0; i < 3; ++i) {
    next[i] = spacing[i] = std::numeric_limits<double>::max();
    if (d[i] == 0) continue;
    const float half = static_cast<float>((d[i] > 0 ? 1 : -1) * grid.resolution() * 0.5);
    next[i] = (grid.center(key[i]) + half - from[i]) / d[i];
    spacing[i] = grid.resolution() / std::abs(d[i]);
  }
  while (true) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;
    std::uint16_t& part = axis == 0 ? key.x : axis == 1 ? key.y : key.z;
    part = static_cast<std::uint16_t>(part + (d[axis] > 0 ? 1 : -1));
    next[axis] += spacing[axis];
    if (key == last || std::min({next[0], next[1], next[2]}) > length) return;
    passed.insert(key);
  }
}

}  // namespace

VoxelReading PlainMap::read(const VoxelKey& key) const {
  const auto found = voxels_.find(key);
  if (found == voxels_.end()) return {};
  const Voxel& voxel = found->second;
  return {true, settings().state(voxel.log_odds), voxel.log_odds, voxel.observations};
}

void PlainMap::insert(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W) {
  std::vector<Eigen::Vector3f> ends(points_W.begin(), points_W.end());
  if (settings().mode == IntegrationMode::discretised) {
    Keys keys;
    for (const Eigen::Vector3f& p : points_W) keys.insert(grid().key(p.cast<double>()));
    ends.clear();
    for (const VoxelKey& key : keys) ends.push_back(grid().center(key).cast<float>());
  }
  Keys passed, hit;
  for (const Eigen::Vector3f& end : ends) {
    const Eigen::Vector3f way = end - origin_W;
    const double distance =
        std::sqrt(static_cast<double>(way.x() * way.x() + way.y() * way.y() + way.z() * way.z()));
    if (distance <= settings().maximum_range) {
      pass(grid(), origin_W, end, passed);
      hit.insert(grid().key(end.cast<double>()));
    } else {
      const Eigen::Vector3f direction = way / static_cast<float>(distance);
      const float range = static_cast<float>(settings().maximum_range);
      pass(grid(), origin_W, origin_W + direction * range, passed);
    }
  }
  for (const VoxelKey& key : hit) passed.erase(key);
  const auto update = [&](const VoxelKey& key, float change) {
    Voxel& voxel = voxels_[key];
    voxel.log_odds =
        std::clamp(voxel.log_odds + change, settings().clamp_min, settings().clamp_max);
    if (settings().observations && voxel.observations < 65535) ++voxel.observations;
  };
  for (const VoxelKey& key : passed) update(key, settings().miss);
  for (const VoxelKey& key : hit) update(key, settings().hit);
}

void PlainMap::assign(std::span<const VoxelLeaf> leaves) {
  for (const VoxelLeaf& leaf : leaves) {
    const int edge = 1 << leaf.level;
    for (int k = 0; k < edge * edge * edge; ++k)
      voxels_[{static_cast<std::uint16_t>(leaf.key.x + k % edge),
               static_cast<std::uint16_t>(leaf.key.y + k / edge % edge),
               static_cast<std::uint16_t>(leaf.key.z + k / edge / edge)}] = {leaf.log_odds,
                                                                             leaf.observations};
  }
}

MapRayHit PlainMap::first_hit(const MapRay& ray) const {
  // Every crossing of a face, then in order of distance; at one distance z before y before x.
  struct Crossing {
    double distance;
    int axis;
  };
  std::vector<Crossing> crossings;
  int cell[3];
  for (int i = 0; i < 3; ++i) {
    cell[i] = grid().index(ray.origin[i]);
    if (std::abs(ray.direction[i]) <= 1e-12) continue;
    const double inverse = 1 / ray.direction[i];
    const double first = (grid().face(cell[i] + (inverse > 0)) - ray.origin[i]) * inverse;
    const double spacing = grid().resolution() * std::abs(inverse);
    for (int n = 0; n <= kKeyCount && first + n * spacing < ray.range; ++n)
      crossings.push_back({first + n * spacing, i});
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.axis > b.axis;
  });
  const auto key = [&] {
    return VoxelKey{static_cast<std::uint16_t>(cell[0]), static_cast<std::uint16_t>(cell[1]),
                    static_cast<std::uint16_t>(cell[2])};
  };
  VoxelState state = read(key()).state;
  if (state != VoxelState::free) return {key(), state, 0};
  for (const Crossing& crossing : crossings) {
    const VoxelKey before = key();
    cell[crossing.axis] += ray.direction[crossing.axis] > 0 ? 1 : -1;
    const float distance = static_cast<float>(std::max(crossing.distance, 0.0));
    if (cell[crossing.axis] < 0 || cell[crossing.axis] >= kKeyCount)
      return {before, VoxelState::unknown, distance};
    state = read(key()).state;
    if (state != VoxelState::free) return {key(), state, distance};
  }
  return {{}, VoxelState::free, static_cast<float>(ray.range)};
}

void PlainMap::cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const {
  for (std::size_t k = 0; k < rays.size(); ++k) hits[k] = first_hit(rays[k]);
}

void PlainMap::means_checked(int level, std::span<const VoxelKey> keys,
                             std::span<MeanReading> means) const {
  const int edge = 1 << level;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    double occupancy = 0, uncertain = 0;
    for (int n = 0; n < edge * edge * edge; ++n) {
      const VoxelReading voxel =
          read({static_cast<std::uint16_t>((keys[k].x & -edge) + n % edge),
                static_cast<std::uint16_t>((keys[k].y & -edge) + n / edge % edge),
                static_cast<std::uint16_t>((keys[k].z & -edge) + n / edge / edge)});
      occupancy += voxel.known ? probability_of(voxel.log_odds) : 0.5;
      uncertain += uncertainty(voxel.observations);
    }
    means[k] = {static_cast<float>(occupancy / (edge * edge * edge)),
                static_cast<float>(uncertain / (edge * edge * edge))};
  }
}

bool PlainMap::sweep_checked(const SweptBox& box) const {
  for (int z = box.lower[2]; z <= box.upper[2]; ++z)
    for (int y = box.lower[1]; y <= box.upper[1]; ++y)
      for (int x = box.lower[0]; x <= box.upper[0]; ++x) {
        const int cell[3] = {x, y, z};
        const VoxelKey key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                           static_cast<std::uint16_t>(z)};
        if (box.meets(cell, 0) && read(key).state != VoxelState::free) return false;
      }
  return true;
}

void PlainMap::for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const {
  for (const auto& [key, voxel] : voxels_) visit({key, 0, voxel.observations, voxel.log_odds});
}

std::optional<VoxelBox> PlainMap::bounds() const {
  if (voxels_.empty()) return std::nullopt;
  VoxelBox box{voxels_.begin()->first, voxels_.begin()->first};
  for (const auto& [key, voxel] : voxels_) {
    box.lower = {std::min(box.lower.x, key.x), std::min(box.lower.y, key.y),
                 std::min(box.lower.z, key.z)};
    box.upper = {std::max(box.upper.x, key.x), std::max(box.upper.y, key.y),
                 std::max(box.upper.z, key.z)};
  }
  return box;
}

VoxelCounts PlainMap::counts() const {
  VoxelCounts counts;
  for (const auto& [key, voxel] : voxels_) {
    const VoxelState state = settings().state(voxel.log_odds);
    ++counts.known;
    counts.free += state == VoxelState::free;
    counts.occupied += state == VoxelState::occupied;
  }
  return counts;
}

std::size_t PlainMap::bytes() const {
  return sizeof *this + voxels_.size() * 64;
}

}  // namespace lapwing
