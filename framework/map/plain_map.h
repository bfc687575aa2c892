// SPDX-License-Identifier: Apache-2.0
// A map that is slow and plainly right: one entry for every known voxel, every question answered
// voxel by voxel. What other backends are compared with, and may begin from: whoever overrides a
// function must give the same answers.
#pragma once

#include <unordered_map>

#include "framework/map/map.h"

namespace lapwing {

struct VoxelKeyHash {
  std::size_t operator()(const VoxelKey& key) const {
    return (std::size_t{key.x} << 32 | std::size_t{key.y} << 16 | key.z) * 0x9e3779b97f4a7c15u >>
           20;
  }
};

class PlainMap : public Map {
 public:
  using Map::Map;

  VoxelReading read(const VoxelKey& key) const override;
  void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const override;
  std::optional<VoxelBox> bounds() const override;
  VoxelCounts counts() const override;
  std::size_t bytes() const override;

 protected:
  void insert(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W) override;
  void assign(std::span<const VoxelLeaf> leaves) override;
  void cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const override;
  void means_checked(int level, std::span<const VoxelKey> keys,
                     std::span<MeanReading> means) const override;
  bool sweep_checked(const SweptBox& box) const override;

  struct Voxel {
    float log_odds = 0;
    std::uint16_t observations = 0;
  };
  std::unordered_map<VoxelKey, Voxel, VoxelKeyHash> voxels_;

 private:
  MapRayHit first_hit(const MapRay& ray) const;
};

}  // namespace lapwing
