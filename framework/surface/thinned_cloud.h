// SPDX-License-Identifier: Apache-2.0
// A point cloud thinned while it is read: one point for every small cube of space.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct ThinnedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world: the mean of those in the cube
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // unit, or zero where the file has none
  std::uint32_t points = 0;
};

class ThinnedCloud {
 public:
  // `cell`: m, edge of the cubes, which are the voxels of a map of that resolution. `most`: number
  // of cubes. InputError for a cell that is not above 0.
  ThinnedCloud(double cell, std::size_t most);
  ~ThinnedCloud();
  ThinnedCloud(ThinnedCloud&&) noexcept;

  // A finite point and its normal, zero where there is none. InputError for a point beyond a
  // million cubes from the origin, and where there would be more than `most` cubes.
  void add(const Eigen::Vector3d& p_W, const Eigen::Vector3f& normal);
  std::uint64_t points() const;  // that were added
  std::size_t cells() const;
  double cell() const;
  // In the order of their places: along z, then y, then x. Leaves an empty cloud.
  std::vector<ThinnedPoint> take();

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace lapwing
