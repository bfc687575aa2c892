// SPDX-License-Identifier: Apache-2.0
#include "plugins/maps/brick/sparse_marks.h"

#include <algorithm>
#include <string>

#include "framework/core/error.h"

namespace lapwing::brick_map {

BrickMarks& SparseMarks::brick(const int cell[3]) {
  const std::uint64_t wanted = key(cell);
  if (last_ && wanted == last_key_) return *last_;
  BrickMarks& marks = bricks_[wanted];
  for (int i = 0; i < 3; ++i) marks.cell[i] = cell[i] & ~15;
  if (bricks_.size() * (sizeof(BrickMarks) + 32) > limit_)
    throw InputError(
        "the rays of one scan pass so many voxels that the map would take more "
        "than its memory_limit of " +
        std::to_string(limit_ >> 20) +
        " MiB: raise it, take larger voxels or a shorter maximum_range");
  last_key_ = wanted;
  last_ = &marks;
  return marks;
}

void SparseMarks::mark_hit(const int cell[3]) {
  BrickMarks& marks = brick(cell);
  const int chunk = place(cell, kChunkLevel);
  marks.chunks |= bit(chunk);
  marks.measured[chunk] |= bit(place(cell, 0));
  marks.hit[chunk] |= bit(place(cell, 0));
}

void SparseMarks::mark_ray(const RayOrigin& origin, const Eigen::Vector3f& end_W) {
  RayStart ray;
  if (!origin.start(end_W, ray)) return;
  int cell[3] = {origin.cell()[0], origin.cell()[1], origin.cell()[2]};
  while (true) {
    BrickMarks& marks = brick(cell);
    const int chunk = place(cell, kChunkLevel);
    marks.chunks |= bit(chunk);
    marks.measured[chunk] |= bit(place(cell, 0));
    const double* t = ray.t;
    const int axis = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
    cell[axis] += ray.step[axis];
    ray.t[axis] += ray.spacing[axis];
    if (std::equal(cell, cell + 3, ray.end)) return;
    if (std::min(std::min(t[0], t[1]), t[2]) > ray.length) return;
  }
}

}  // namespace lapwing::brick_map
