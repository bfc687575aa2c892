// SPDX-License-Identifier: Apache-2.0
// The take-off place of a flight, and what it may not go beyond from there.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct Home {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world, on the ground
  std::optional<double> max_height;                    // m above `position`
  std::optional<double> max_distance;                  // m from `position`, across the ground
  // m, world: where the vehicle may go in place of home when something fails.
  std::vector<Eigen::Vector3d> rally_points;

  bool operator==(const Home&) const = default;
};

}  // namespace lapwing
