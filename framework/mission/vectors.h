// SPDX-License-Identifier: Apache-2.0
// Three numbers of a parameter table as a vector.
#pragma once

#include <span>

#include <Eigen/Core>

namespace lapwing {

inline Eigen::Vector3d vector_of(std::span<const double> numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace lapwing
