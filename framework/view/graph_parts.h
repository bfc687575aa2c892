// SPDX-License-Identifier: Apache-2.0
// What graphs of views are made with.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "framework/core/error.h"
#include "framework/view/visible_voxels.h"

namespace lapwing {

// Numbers for the voxels of a box, given in the order in which they are first asked for. They are
// kept in cubes, of which only those with numbers take memory.
class VoxelNumbers {
 public:
  VoxelNumbers(const Eigen::AlignedBox3d& region, const VoxelGrid& grid) {
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = grid.index(region.min()[axis]);
      const int high = grid.index(region.max()[axis]);
      size_[axis] = static_cast<std::size_t>((high - low_[axis]) >> kBits) + 1;
      count *= static_cast<double>(size_[axis]);
    }
    if (count > kMostCubes)
      throw InputError(
          "the region of interest has more than 2^37 voxels: set a larger resolution or a smaller "
          "region, or the unit of the mesh file");
    cubes_.resize(static_cast<std::size_t>(count));
  }

  std::uint32_t number(const VoxelKey& key) {
    std::size_t cube = 0, place = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const auto at = static_cast<std::size_t>(key[axis] - low_[axis]);
      cube = cube * size_[axis] + (at >> kBits);
      place = place << kBits | (at & ((1u << kBits) - 1));
    }
    std::vector<std::uint32_t>& numbers = cubes_[cube];
    if (numbers.empty()) numbers.assign(std::size_t{1} << 3 * kBits, kNone);
    if (numbers[place] == kNone) {
      numbers[place] = static_cast<std::uint32_t>(voxels_.size());
      voxels_.push_back(key);
    }
    return numbers[place];
  }
  std::size_t count() const { return voxels_.size(); }
  std::vector<VoxelKey> take() { return std::move(voxels_); }

 private:
  static constexpr int kBits = 3;  // of the edge of a cube
  static constexpr double kMostCubes = 268435456.0;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  int low_[3];
  std::size_t size_[3];
  std::vector<std::vector<std::uint32_t>> cubes_;
  std::vector<VoxelKey> voxels_;
};

// The level of the cubes in which coarse views are compared.
int coarse_level(const VisibleVoxels& visible, int across);
// What a coarse view sees, in such cubes, in the order of keys, each once.
std::vector<VoxelKey> coarse_cubes(const VisibleVoxels& visible, const Viewpoint& view, int across,
                                   int level);

}  // namespace lapwing
