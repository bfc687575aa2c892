// SPDX-License-Identifier: Apache-2.0
// Rays against single shapes, in double precision. Internal to this room; callers include scene.h.
#pragma once

#include "framework/geometry/scene.h"

namespace lapwing {

struct Ray {
  Eigen::Vector3d origin, direction;  // direction is a unit vector
};

// Where a ray meets a shape first beyond `kNearestHit`; the normal faces the ray.
std::optional<SurfaceHit> hit(const BodyShape& shape, const Ray& ray);

// The box that holds a bounded shape.
BlockShape bounds_of(const BodyShape& shape);

// What is wrong with a shape, in words; empty when it is sound.
const char* problem_of(const BodyShape& shape);

inline constexpr double kNearestHit = 1e-9;        // m
inline constexpr double kLargestCoordinate = 1e5;  // m

}  // namespace lapwing
