// Which voxels one scan measured: each at most once, points before rays.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "framework/map/map_settings.h"

namespace lapwing::brick_map {

// Of one brick: measured voxels and those among them that hold a point, by chunk.
struct BrickMarks {
  int cell[3];               // its lowest voxel
  std::uint64_t chunks = 0;  // with a mark
  std::uint64_t measured[64], hit[64];
};

class ScanMarks {
 public:
  explicit ScanMarks(const MapSettings& settings)
      : settings_(settings), grid_(settings.resolution) {}

  // The marks of a scan, brick by brick, valid until the next. Rays are OctoMap's to the bit, as
  // is what becomes of them; see README.md.
  std::span<const BrickMarks> mark(std::span<const Eigen::Vector3f> points_W,
                                   const Eigen::Vector3f& origin_W, int threads);
  // Of what is kept for the next scan.
  std::size_t bytes() const;

 private:
  struct Free {
    void operator()(std::uint8_t* bytes) const { std::free(bytes); }
  };

  void find_box(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W);
  void make_room();
  void discretise(std::span<const Eigen::Vector3f> points_W);
  void clip(std::span<const Eigen::Vector3f> ends_W, const Eigen::Vector3f& origin_W);
  void collect(int threads);
  std::int64_t offset(const int cell[3]) const {
    return (cell[0] - base_[0]) + stride_[1] * (cell[1] - base_[1]) +
           stride_[2] * (cell[2] - base_[2]);
  }

  MapSettings settings_;
  VoxelGrid grid_;
  int base_[3] = {}, size_[3] = {};  // of the box that holds all rays, in voxels
  std::int64_t stride_[3] = {};
  std::unique_ptr<std::uint8_t[], Free>
      marks_;  // a byte for each voxel of the box, then some spare
  std::size_t room_ = 0;
  std::vector<Eigen::Vector3f> ends_, rays_;  // one ray to each of rays_
  std::vector<std::int64_t> hits_;
  std::vector<BrickMarks> found_;
};

}  // namespace lapwing::brick_map
