// SPDX-License-Identifier: Apache-2.0
#include "framework/map/voxel_balls.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

constexpr float kNowhere = 1e12f;  // voxels squared

// In place: the least of value(q) + |p - q|^2 over all voxels q within `reach` along each axis.
void lower_envelope(const VoxelBlock& block, int reach, std::vector<float>& values) {
  std::vector<float> before;
  const std::ptrdiff_t row = block.size[0];
  const std::ptrdiff_t strides[3] = {1, row, row * block.size[1]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    before = values;
    for (int z = 0; z < block.size[2]; ++z)
      for (int y = 0; y < block.size[1]; ++y) {
        const int at[3] = {0, y, z};
        const float* from = before.data() + block.place(0, y, z);
        float* to = values.data() + block.place(0, y, z);
        for (int d = -reach; d <= reach; ++d) {
          if (axis > 0 && (at[axis] + d < 0 || at[axis] + d >= block.size[axis])) continue;
          const int first = axis == 0 ? std::max(0, -d) : 0;
          const int last = axis == 0 ? std::min(block.size[0], block.size[0] - d) : block.size[0];
          const auto more = static_cast<float>(d * d);
          const std::ptrdiff_t moved = d * strides[axis];
          for (int x = first; x < last; ++x) to[x] = std::min(to[x], from[x + moved] + more);
        }
      }
  }
}

}  // namespace

std::vector<float> squared_rooms(const VoxelBlock& block, int reach) {
  std::vector<float> values(block.count());
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = block.marked[k] ? kNowhere : 0;
  lower_envelope(block, reach, values);
  return values;
}

void keep_balls(VoxelBlock& block, const std::vector<float>& radius) {
  const float largest = *std::max_element(radius.begin(), radius.end());
  const int reach = static_cast<int>(std::ceil(largest));
  std::vector<float> values = squared_rooms(block, reach);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const float squared = radius[k] * radius[k];
    values[k] = values[k] > squared ? -squared : kNowhere;
  }
  lower_envelope(block, reach, values);
  for (std::size_t k = 0; k < values.size(); ++k) block.marked[k] = values[k] <= 0;
}

}  // namespace lapwing
