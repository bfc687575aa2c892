// SPDX-License-Identifier: Apache-2.0
// Where an obstacle that moves is, as formulas that are differentiated read it.
#pragma once

#include <algorithm>

#include "framework/core/dual.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// What is added to its place at a time, which may be a dual number. At a corner of its track, the
// way it goes on.
template <class T>
Eigen::Matrix<T, 3, 1> obstacle_moved(const Obstacle& obstacle, const T& time) {
  const auto& times = obstacle.times;
  if (times.empty()) return Eigen::Matrix<T, 3, 1>(T(0.0), T(0.0), T(0.0));
  const auto next = std::upper_bound(times.begin(), times.end(), value_of(time));
  const auto k = static_cast<std::size_t>(next - times.begin());
  const Eigen::Vector3d& from = obstacle.moves[k == 0 ? 0 : k - 1];
  Eigen::Matrix<T, 3, 1> result(T(from.x()), T(from.y()), T(from.z()));
  if (k == 0 || k == times.size()) return result;
  const Eigen::Vector3d velocity = (obstacle.moves[k] - from) / (times[k] - times[k - 1]);
  for (int i = 0; i < 3; ++i) result(i) += (time - times[k - 1]) * velocity(i);
  return result;
}

}  // namespace lapwing
