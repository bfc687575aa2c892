// SPDX-License-Identifier: Apache-2.0
// Voxels: cubes of one size, their keys, and what a map knows of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace lapwing {

// Voxels are counted along each axis from 0; the corner of voxel (32768, 32768, 32768) is the
// origin of the world. The same keys as OctoMap's.
struct VoxelKey {
  std::uint16_t x = 0, y = 0, z = 0;

  std::uint16_t operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  auto operator<=>(const VoxelKey&) const = default;
  // The key's bits interleaved, x lowest: equal for all voxels of a cube after a shift.
  std::uint64_t morton() const;
};

inline constexpr int kCenterKey = 32768;
inline constexpr int kKeyCount = 65536;  // along an axis
inline constexpr int kTreeDepth = 16;    // a cube of level l has (2^l)^3 voxels; 16 is everything

inline std::uint64_t VoxelKey::morton() const {
  const auto spread = [](std::uint64_t v) {
    v = (v | v << 16) & 0x0000ff0000ffull;
    v = (v | v << 8) & 0x00f00f00f00full;
    v = (v | v << 4) & 0x0c30c30c30c3ull;
    return (v | v << 2) & 0x249249249249ull;
  };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

enum class VoxelState : std::uint8_t { unknown, free, occupied };

// A cube of voxels that are all alike. `key` is the one with the lowest coordinates, a multiple of
// 2^level. An infinite log odds is as free or as occupied as the map's clamps let it be.
struct VoxelLeaf {
  VoxelKey key;
  std::uint8_t level = 0;
  std::uint16_t observations = 0;
  float log_odds = 0;

  bool operator==(const VoxelLeaf&) const = default;
};

// From `lower` to `upper`, both included.
struct VoxelBox {
  VoxelKey lower, upper;

  bool contains(const VoxelKey& key) const {
    return lower.x <= key.x && key.x <= upper.x && lower.y <= key.y && key.y <= upper.y &&
           lower.z <= key.z && key.z <= upper.z;
  }
  bool operator==(const VoxelBox&) const = default;
};

// Where the voxels of an edge length lie, in OctoMap's arithmetic.
class VoxelGrid {
 public:
  explicit VoxelGrid(double resolution) : resolution_(resolution), per_metre_(1.0 / resolution) {}

  double resolution() const { return resolution_; }
  double per_metre() const { return per_metre_; }

  // The number of the voxel along an axis; beyond 0 to 65535 outside every map. The coordinate is
  // at most 2^30 voxels from 0.
  int index(double coordinate) const {
    const double voxels = per_metre_ * coordinate;
    const int towards_zero = static_cast<int>(voxels);
    return towards_zero - (voxels < towards_zero) + kCenterKey;
  }
  // Of a point in the world. `p_W` must lie inside, see `contains`.
  VoxelKey key(const Eigen::Vector3d& p_W) const {
    return {static_cast<std::uint16_t>(index(p_W.x())), static_cast<std::uint16_t>(index(p_W.y())),
            static_cast<std::uint16_t>(index(p_W.z()))};
  }
  // Whether a point has a key; false for what is not finite.
  bool contains(const Eigen::Vector3d& p_W) const {
    const double reach = this->reach();
    return p_W.x() >= -reach && p_W.x() < reach && p_W.y() >= -reach && p_W.y() < reach &&
           p_W.z() >= -reach && p_W.z() < reach;
  }
  // m from the origin of the world to the faces of the largest map.
  double reach() const { return kCenterKey * resolution_; }

  double center(int index) const { return ((index - kCenterKey) + 0.5) * resolution_; }
  Eigen::Vector3d center(const VoxelKey& key) const {
    return {center(key.x), center(key.y), center(key.z)};
  }
  // The face of a voxel towards lower coordinates.
  double face(int index) const { return (index - kCenterKey) * resolution_; }
  Eigen::Vector3d corner(const VoxelKey& key) const {
    return {face(key.x), face(key.y), face(key.z)};
  }

 private:
  double resolution_, per_metre_;
};

// OctoMap's, in its precision.
inline float log_odds_of(double probability) {
  return static_cast<float>(std::log(probability / (1 - probability)));
}
inline double probability_of(float log_odds) {
  return 1. - (1. / (1. + std::exp(static_cast<double>(log_odds))));
}

}  // namespace lapwing
