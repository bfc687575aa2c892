// SPDX-License-Identifier: Apache-2.0
// The distance to what blocks the way, whatever it is made of: meshes and maps answer alike.
#pragma once

#include <Eigen/Core>

namespace lapwing {

class DistanceField {
 public:
  virtual ~DistanceField() = default;

  // Metres from `p_W` to the nearest blocked place, at most `reach()`; negative or zero inside one
  // where the inside is known. `gradient`, unless null, takes its derivative: zero beyond reach and
  // where several places are nearest. Thread-safe.
  virtual double distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const = 0;

  // The second derivatives: here the differences of the gradient over a tenth of a millimetre.
  // Across a kink they are those of the chord.
  virtual Eigen::Matrix3d curvature(const Eigen::Vector3d& p_W) const;

  // m; distances are not told apart beyond it.
  virtual double reach() const = 0;
};

}  // namespace lapwing
