// SPDX-License-Identifier: Apache-2.0
// Points with normals from many depth images, one for every small cube of space (thesis 4.5.4).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "framework/geometry/depth_image.h"

namespace lapwing {

struct FusedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world: the mean of what was measured
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   // unit, on the side of the cameras
  int images = 0;                                      // that measured it
};

struct FusionOptions {
  double voxel = 0.1;  // m, edge of the cubes
  double range = 30;   // m of depth, beyond which pixels are left out
  double reach = std::numeric_limits<double>::infinity();  // m along the ray, likewise
  double incidence = 1.309;    // rad between normal and ray (75 degrees), likewise
  double discontinuity = 0.1;  // share of the depth by which neighbouring pixels may differ
  int stride = 1;              // every so many pixels, across and down
};

class PointFusion {
 public:
  // Throws InputError for options without sense.
  explicit PointFusion(const FusionOptions& options);

  // A pixel's normal comes from its four neighbours; where one of them has no depth or lies across
  // an edge the pixel is left out. Throws InputError for a pose or a depth that is not finite
  // (infinity, "nothing there", excepted) and for an image whose size is not that of its pinhole.
  void add(const PosedDepthImage& measured);

  // In the order of their places; those that at least `images` images measured.
  std::vector<FusedPoint> points(int images = 1) const;

 private:
  struct Sum {
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    double weight = 0;
    int images = 0;
    std::int64_t last = -1;  // image
  };
  using Key = std::array<std::int32_t, 3>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };

  FusionOptions options_;
  std::int64_t images_ = 0;
  std::unordered_map<Key, Sum, KeyHash> sums_;
};

}  // namespace lapwing
