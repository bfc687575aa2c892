// SPDX-License-Identifier: Apache-2.0
#include "framework/map/scan.h"

#include <cmath>

#include "framework/core/error.h"

namespace lapwing {
namespace {

void check(const PosedDepthImage& measured) {
  const Pinhole& pinhole = measured.image.pinhole;
  if (pinhole.width < 1 || pinhole.height < 1 || !(pinhole.focal_x > 0) || !(pinhole.focal_y > 0) ||
      !std::isfinite(pinhole.principal_x + pinhole.principal_y + pinhole.focal_x + pinhole.focal_y))
    throw InputError("a depth image needs a size of at least 1 by 1 and positive focal lengths");
  const std::size_t pixels = static_cast<std::size_t>(pinhole.width) * pinhole.height;
  if (measured.image.depth.size() != pixels)
    throw InputError("a depth image of " + std::to_string(pinhole.width) + " by " +
                     std::to_string(pinhole.height) + " has " + std::to_string(pixels) +
                     " depths, not " + std::to_string(measured.image.depth.size()));
  const Pose& camera = measured.camera;
  if (!camera.position.allFinite() || !camera.orientation.coeffs().allFinite())
    throw InputError("the pose of a depth image has a number that is not finite");
  if (std::abs(camera.orientation.norm() - 1) > 1e-3)
    throw InputError("the pose of a depth image is not a rotation: its quaternion has length " +
                     std::to_string(camera.orientation.norm()) + ", not 1");
}

}  // namespace

void scan_points(const PosedDepthImage& measured, int pixel_step, double maximum_range,
                 double resolution, std::vector<Eigen::Vector3f>& points_W) {
  check(measured);
  const Pinhole& pinhole = measured.image.pinhole;
  const Eigen::Matrix3d R_WC = measured.camera.orientation.normalized().toRotationMatrix();
  const Eigen::Vector3d p = measured.camera.position;
  const auto place = [](int x, int y) {
    return "pixel " + std::to_string(x) + ", " + std::to_string(y);
  };
  points_W.clear();
  for (int y = 0; y < pinhole.height; y += pixel_step) {
    const double down = (y - pinhole.principal_y) / pinhole.focal_y;
    const Eigen::Vector3d row = R_WC.col(2) + down * R_WC.col(1);
    for (int x = 0; x < pinhole.width; x += pixel_step) {
      const double depth = measured.image.at(x, y);
      if (depth == 0) continue;
      const Eigen::Vector3d ray = row + ((x - pinhole.principal_x) / pinhole.focal_x) * R_WC.col(0);
      if (std::isinf(depth) && depth > 0) {
        if (!std::isfinite(maximum_range))
          throw InputError(place(x, y) +
                           " of a depth image is infinite: give the map a "
                           "maximum_range, up to which such rays clear voxels");
        // The middle of a voxel at most 0.87 voxels away still lies beyond.
        const double far = (maximum_range + 2 * resolution) / ray.norm();
        points_W.push_back((p + far * ray).cast<float>());
        continue;
      }
      if (!(depth > 0))
        throw InputError(place(x, y) + " of a depth image is " + std::to_string(depth) +
                         " m deep; depths are positive, 0 without a measurement");
      points_W.push_back((p + depth * ray).cast<float>());
    }
  }
}

}  // namespace lapwing
