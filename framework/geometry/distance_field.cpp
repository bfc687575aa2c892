// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/distance_field.h"

namespace lapwing {

Eigen::Matrix3d DistanceField::curvature(const Eigen::Vector3d& p_W) const {
  constexpr double kStep = 1e-4;  // m
  Eigen::Matrix3d columns;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d before, after, p = p_W;
    p(i) = p_W(i) - kStep;
    distance(p, &before);
    p(i) = p_W(i) + kStep;
    distance(p, &after);
    columns.col(i) = (after - before) / (2 * kStep);
  }
  return (columns + columns.transpose()) / 2;
}

}  // namespace lapwing
