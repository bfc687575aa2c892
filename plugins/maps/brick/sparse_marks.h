// SPDX-License-Identifier: Apache-2.0
// The marks of a scan whose box is too large for a byte a voxel: slower, and as large as what the
// rays touch.
#pragma once

#include <cstddef>
#include <unordered_map>

#include "plugins/maps/brick/brick_marks.h"
#include "plugins/maps/brick/octomap_ray.h"

namespace lapwing::brick_map {

class SparseMarks {
 public:
  // InputError once the marks would take more than `limit` bytes.
  explicit SparseMarks(std::size_t limit) : limit_(limit) {}

  // What the ray to `end_W` passes; the voxel that it starts in, too, if it leaves it.
  void mark_ray(const RayOrigin& origin, const Eigen::Vector3f& end_W);
  void mark_hit(const int cell[3]);

  const std::unordered_map<std::uint64_t, BrickMarks>& bricks() const { return bricks_; }
  const BrickMarks& at(const int cell[3]) const { return bricks_.at(key(cell)); }
  void clear() {
    bricks_ = {};
    last_ = nullptr;
  }

 private:
  static std::uint64_t key(const int cell[3]) {
    return static_cast<std::uint64_t>(cell[0] >> 4) |
           static_cast<std::uint64_t>(cell[1] >> 4) << 12 |
           static_cast<std::uint64_t>(cell[2] >> 4) << 24;
  }
  BrickMarks& brick(const int cell[3]);

  std::size_t limit_;
  std::unordered_map<std::uint64_t, BrickMarks> bricks_;
  std::uint64_t last_key_ = ~std::uint64_t{0};
  BrickMarks* last_ = nullptr;
};

}  // namespace lapwing::brick_map
