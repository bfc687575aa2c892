// SPDX-License-Identifier: Apache-2.0
// Where a ray meets a surface, and what rays can be cast at.
#pragma once

#include <optional>

#include <Eigen/Geometry>

namespace lapwing {

struct SurfaceHit {
  double distance = 0;                                // m along the ray
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, on the side that the ray came from
};

// A body that answers rays itself. World frame, metres.
class RayBody {
 public:
  virtual ~RayBody() = default;

  // The first place of its surface farther than 1e-9 m along the ray, from inside its far side;
  // `direction` is a unit vector. Thread-safe.
  virtual std::optional<SurfaceHit> hit(const Eigen::Vector3d& origin,
                                        const Eigen::Vector3d& direction) const = 0;
  // Of the body and what it holds; infinite where it has no end.
  virtual Eigen::AlignedBox3d bounds() const = 0;
};

}  // namespace lapwing
