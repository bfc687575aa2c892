// SPDX-License-Identifier: Apache-2.0
// What lies behind the surfaces that images saw: the voxels within some distance behind each
// measured point, along the image's own ray (Isler et al. 2016; Delmerico et al. 2018).
//
// Each such voxel keeps its distance to the surface, the smallest of all images: from the measured
// point to where the ray enters the voxel. Whether a voxel has been measured since is the map's to
// say. Only what is followed is kept, so that nobody else pays for it.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "framework/map/map.h"

namespace lapwing {

class HiddenVoxels {
  static constexpr int kBits = 3;  // blocks of 8^3 voxels
  using Block = std::array<float, std::size_t{1} << (3 * kBits)>;

 public:
  static constexpr float kNowhere = std::numeric_limits<float>::infinity();

  // The map outlives this object.
  explicit HiddenVoxels(const Map& map) : map_(&map) {}

  // From the first image on voxels up to `farthest` metres behind surfaces are wanted: for a
  // utility's require_fit. Thread-safe. InputError where images were seen without, or for a
  // distance that is not above 0 and finite.
  void follow(double farthest) const;
  // InputError unless voxels up to that distance have been followed from the first image on.
  void require_followed(double farthest) const;

  // An image was taken; points beyond the map's maximum range are none. Not while anybody reads.
  void saw(const PosedDepthImage& measured);
  void saw(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3d& origin_W);

  // Distances of voxels, m, kNowhere where no image saw a surface before them; quickest for
  // neighbours one after the other. One for each thread.
  class Reader {
   public:
    explicit Reader(const HiddenVoxels& hidden) : hidden_(&hidden) {}
    float distance(const VoxelKey& key) {
      const std::uint64_t wanted = block_key(key);
      if (wanted != at_) {
        at_ = wanted;
        const auto found = hidden_->blocks_.find(wanted);
        block_ = found == hidden_->blocks_.end() ? nullptr : found->second.get();
      }
      return block_ ? (*block_)[place_of(key)] : kNowhere;
    }

   private:
    const HiddenVoxels* hidden_;
    std::uint64_t at_ = ~std::uint64_t{0};
    const Block* block_ = nullptr;
  };

  std::size_t bytes() const;

 private:
  static std::uint64_t block_key(const VoxelKey& key) {
    return static_cast<std::uint64_t>(key.x >> kBits) |
           static_cast<std::uint64_t>(key.y >> kBits) << 16 |
           static_cast<std::uint64_t>(key.z >> kBits) << 32;
  }
  static std::size_t place_of(const VoxelKey& key) {
    constexpr unsigned kIn = (1u << kBits) - 1;
    return (key.x & kIn) | (key.y & kIn) << kBits | (key.z & kIn) << (2 * kBits);
  }

  const Map* map_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
  std::vector<Eigen::Vector3f> points_;
  bool seen_ = false;  // images, by anybody or nobody
  mutable double farthest_ = 0;
  mutable std::mutex mutex_;
};

}  // namespace lapwing
