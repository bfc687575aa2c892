// A map that holds what it is given and nothing else, to test what needs only a map's reads.
#pragma once

#include <map>

#include "framework/core/error.h"
#include "framework/map/map.h"

namespace lapwing {

class PlainMap final : public Map {
 public:
  explicit PlainMap(double resolution = 0.5)
      : Map(map_settings(check(map_parameters(), with_resolution(resolution)))) {}

  VoxelReading read(const VoxelKey& key) const override {
    const auto found = voxels_.find(key);
    if (found == voxels_.end()) return {};
    return {true, settings().state(found->second), found->second, 0};
  }
  void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const override {
    for (const auto& [key, value] : voxels_) visit({key, 0, 0, value});
  }
  std::optional<VoxelBox> bounds() const override { return {}; }
  VoxelCounts counts() const override { return {voxels_.size(), 0, 0}; }
  std::size_t bytes() const override { return voxels_.size(); }

 protected:
  void insert(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f&) override {
    for (const Eigen::Vector3f& p : points) voxels_[grid().key(p.cast<double>())] = settings().hit;
  }
  void assign(std::span<const VoxelLeaf> leaves) override {
    for (const VoxelLeaf& leaf : leaves)
      for (int z = 0; z < 1 << leaf.level; ++z)
        for (int y = 0; y < 1 << leaf.level; ++y)
          for (int x = 0; x < 1 << leaf.level; ++x)
            voxels_[{static_cast<std::uint16_t>(leaf.key.x + x),
                     static_cast<std::uint16_t>(leaf.key.y + y),
                     static_cast<std::uint16_t>(leaf.key.z + z)}] = leaf.log_odds;
  }
  void cast_checked(std::span<const MapRay>, std::span<MapRayHit>) const override {
    throw Error("not asked for here");
  }
  void means_checked(int, std::span<const VoxelKey>, std::span<MeanReading>) const override {
    throw Error("not asked for here");
  }
  bool sweep_checked(const SweptBox&) const override { throw Error("not asked for here"); }

 private:
  static Value with_resolution(double resolution) {
    Value value = Value::map();
    value.set("resolution", resolution);
    return value;
  }
  std::map<VoxelKey, float> voxels_;
};

}  // namespace lapwing
