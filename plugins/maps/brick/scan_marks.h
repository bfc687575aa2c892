// SPDX-License-Identifier: Apache-2.0
// Which voxels one scan measured: each at most once, points before rays.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "framework/map/map_settings.h"
#include "plugins/maps/brick/ray_lanes.h"
#include "plugins/maps/brick/sparse_marks.h"

namespace lapwing::brick_map {

class ScanMarks {
 public:
  explicit ScanMarks(const MapSettings& settings)
      : settings_(settings), grid_(settings.resolution), sparse_(settings.memory_limit) {}

  // Marks a scan and returns the lowest voxels of the bricks with a mark; `take` them all before
  // the next scan. Rays are OctoMap's to the bit, as is what becomes of them; see README.md.
  struct Corner {
    int cell[3];
  };
  std::span<const Corner> mark(std::span<const Eigen::Vector3f> points_W,
                               const Eigen::Vector3f& origin_W, int threads);
  // The marks of one brick; `clear` forgets them. Thread-safe for different bricks.
  BrickMarks take(const Corner& corner, bool clear);
  // Gives back what would be too much to keep.
  void finish();
  // Of what is kept for the next scan.
  std::size_t bytes() const;

 private:
  struct Free {
    void operator()(std::uint8_t* bytes) const { std::free(bytes); }
  };
  using Bytes = std::unique_ptr<std::uint8_t[], Free>;

  void find_box(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W);
  void make_room();
  void discretise(std::span<const Eigen::Vector3f> points_W);
  // Where a ray towards the end really ends; false for one beyond the range, which hits nothing.
  bool clip(Eigen::Vector3f& end_W, const Eigen::Vector3f& origin_W) const;
  void mark_hits(std::span<const Eigen::Vector3f> ends_W, const Eigen::Vector3f& origin_W);
  void find_bricks();
  void mark_sparse(std::span<const Eigen::Vector3f> ends_W, const Eigen::Vector3f& origin_W);
  bool touch(int y, int z, std::vector<std::uint8_t>& touched) const;
  void note_page(std::int64_t at) {
    if (pages_) pages_[at >> kPageShift] = 1;
  }
  std::int64_t offset(const int cell[3]) const {
    return (cell[0] - base_[0]) + stride_[1] * (cell[1] - base_[1]) +
           stride_[2] * (cell[2] - base_[2]);
  }

  MapSettings settings_;
  VoxelGrid grid_;
  int base_[3] = {}, size_[3] = {};  // of the box that holds all rays, in voxels
  std::int64_t stride_[3] = {};
  Bytes marks_, pages_;  // see MarkTarget; pages for large boxes only
  std::size_t room_ = 0;
  std::vector<Eigen::Vector3f> ends_;
  std::vector<Corner> found_;
  bool is_sparse_ = false;  // for this scan
  SparseMarks sparse_;
};

}  // namespace lapwing::brick_map
