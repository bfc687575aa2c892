// SPDX-License-Identifier: Apache-2.0
// A scene that rays are cast into: bodies, boards and the ground, ray-traced by Embree. World
// frame, metres.
//
// Embree finds the candidates in single precision; every hit is computed in double precision from
// the shape itself. Coordinates up to 1e5 m.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "framework/geometry/surface_hit.h"

namespace lapwing {

struct BallShape {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};

// Parallel to the axes.
struct BlockShape {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
};

// A rectangle without thickness, seen from both sides; its half edges are at right angles.
struct BoardShape {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_across = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_up = Eigen::Vector3d::Zero();
};

// Closed at both ends.
struct UprightCylinderShape {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double height = 0;
  double width = 0;  // diameter
};

// An endless level plane.
struct GroundShape {
  double height = 0;  // z
};

// What answers rays itself; what of it lies beyond 1e5 m is not drawn.
struct TracedShape {
  std::shared_ptr<const RayBody> body;
};

using BodyShape =
    std::variant<BallShape, BlockShape, BoardShape, UprightCylinderShape, GroundShape, TracedShape>;

// Whether a scene takes the shape: it has an extent, and finite numbers up to 1e5.
bool drawable(const BodyShape& shape);

struct RayHit {
  double distance = 0;                                // m along the ray
  int shape = 0;                                      // its place in the list
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, on the side that the ray came from
};

class Scene {
 public:
  // Throws InputError naming the shape that has no extent or a number that is not finite or beyond
  // 1e5, and Error when Embree cannot be used. Shapes may overlap.
  explicit Scene(std::vector<BodyShape> shapes);
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  // The first hit beyond `origin` and nearer than `farthest`, at most once per shape and ray: from
  // inside a body its far side. `direction` is a unit vector. Of hits at one distance the shape
  // that comes first in the list. Thread-safe.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double farthest = std::numeric_limits<double>::infinity()) const;

  // Whether there is any hit. Thread-safe.
  bool blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
               double farthest = std::numeric_limits<double>::infinity()) const;

  const std::vector<BodyShape>& shapes() const;

 private:
  struct Tracer;
  std::unique_ptr<Tracer> tracer_;
};

}  // namespace lapwing
