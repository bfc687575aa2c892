// SPDX-License-Identifier: Apache-2.0
// The distance to what blocks flight in a map, and where it grows.
#pragma once

#include <vector>

#include "framework/geometry/distance_field.h"
#include "framework/map/map.h"

namespace lapwing {

// Blocked is what is occupied or unknown. At the middle of every voxel of a box the distance is
// exact: to the nearest blocked voxel from a free one, the other way round and negative from a
// blocked one, both to the cube and not to its middle (Felzenszwalb and Huttenlocher, 2012;
// Meijster et al., 2000). In between it is interpolated along the three axes, and the gradient is
// that of the interpolation. It is a copy: what the map learns afterwards is not in it.
class MapDistance final : public DistanceField {
 public:
  // From `lower_W` to `upper_W`, grown to whole voxels; voxels up to `reach` metres away are taken
  // into account. InputError: an empty box, one outside the largest map, a reach that is not
  // positive and finite, more than 500 million voxels.
  MapDistance(const Map& map, const Eigen::Vector3d& lower_W, const Eigen::Vector3d& upper_W,
              double reach);

  // Outside the box: that of the nearest place in it less the distance to there, so that the way
  // back is uphill.
  double distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const override;
  double reach() const override { return reach_; }

 private:
  struct Region {
    int low[3], size[3];  // voxels
    std::size_t count() const {
      return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
             static_cast<std::size_t>(size[2]);
    }
  };
  static void transform(const Region& region, std::vector<float>& squared);
  float at(int x, int y, int z) const {
    return distances_[static_cast<std::size_t>(x) +
                      static_cast<std::size_t>(box_.size[0]) *
                          (static_cast<std::size_t>(y) +
                           static_cast<std::size_t>(box_.size[1]) * static_cast<std::size_t>(z))];
  }

  VoxelGrid grid_;
  double reach_;
  Region box_;                    // with one voxel more on every side, to interpolate
  std::vector<float> distances_;  // m, of the box, x fastest
};

}  // namespace lapwing
