// SPDX-License-Identifier: Apache-2.0
#include "framework/view/footprint.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lapwing {

std::vector<Eigen::Vector2d> footprint_of(const Viewpoint& view, const Pinhole& pinhole,
                                          double level, double range) {
  check_camera(pinhole, range);
  const Pose camera = view.camera();
  const double left = -0.5, right = pinhole.width - 0.5, top = -0.5, bottom = pinhole.height - 0.5;
  std::array<Eigen::Vector3d, 5> points{view.position};
  std::size_t next = 1;
  for (const auto& [u, v] : {std::pair{left, top}, {right, top}, {right, bottom}, {left, bottom}}) {
    const Eigen::Vector3d ray((u - pinhole.principal_x) / pinhole.focal_x,
                              (v - pinhole.principal_y) / pinhole.focal_y, 1);
    points[next++] = view.position + range * (camera.orientation * ray);
  }
  std::vector<Eigen::Vector2d> corners;
  const auto cross = [&](std::size_t i, std::size_t k) {
    const double a = points[i].z() - level, b = points[k].z() - level;
    if ((a > 0) == (b > 0)) return;
    corners.push_back((points[i] + a / (a - b) * (points[k] - points[i])).head<2>());
  };
  for (std::size_t k = 1; k < 5; ++k) cross(0, k);
  for (std::size_t k = 1; k < 5; ++k) cross(k, k % 4 + 1);
  // Of a convex body they are in order round their mean.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : corners) middle += p / static_cast<double>(corners.size());
  std::sort(corners.begin(), corners.end(), [&](const auto& p, const auto& q) {
    return std::atan2(p.y() - middle.y(), p.x() - middle.x()) <
           std::atan2(q.y() - middle.y(), q.x() - middle.x());
  });
  return corners;
}

}  // namespace lapwing
