// SPDX-License-Identifier: Apache-2.0
// A mesh that rays are cast into and distances are measured to, by Embree. World frame, metres.
//
// Embree walks its tree in single precision (robust mode: no ray slips between two triangles); the
// distance to the triangle that it finds is worked out in double precision from the mesh itself.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "framework/geometry/distance_field.h"
#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

struct MeshRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();       // unit
  double farthest = std::numeric_limits<double>::infinity();  // m
};

struct MeshHit {
  double distance = std::numeric_limits<double>::infinity();  // m along the ray; infinite: nothing
  int triangle = -1;                                          // its place in the mesh; -1: nothing
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, on the side that the ray came from
};

struct NearestTriangle {
  double distance = 0;  // m
  int triangle = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // of it, nearest
};

class MeshScene {
 public:
  // Throws as check_mesh does (the mesh is named `what`), and Error when Embree cannot be used.
  explicit MeshScene(TriangleMesh mesh, const std::string& what = "mesh");
  ~MeshScene();
  MeshScene(MeshScene&&) noexcept;
  MeshScene& operator=(MeshScene&&) noexcept;

  const TriangleMesh& mesh() const;

  // All queries are thread-safe.

  // The first triangle beyond the origin and nearer than `farthest`, from either side.
  MeshHit cast(const MeshRay& ray) const;
  // Whether there is any.
  bool blocked(const MeshRay& ray) const;
  // Ray by ray as above, on several threads (see core/parallel.h); the same for any number. Throws
  // Error when the sizes differ.
  void cast(std::span<const MeshRay> rays, std::span<MeshHit> hits, int threads) const;

  // The nearest triangle within `reach` metres; nothing where there is none. Of several at one
  // distance the first in the mesh.
  std::optional<NearestTriangle> nearest(const Eigen::Vector3d& p_W, double reach) const;

  // Whether a box parallel to the axes, its half edges `half`, that is moved in a straight line
  // from `from` to `to` (its middle) enters a triangle; touching it alone is no entering.
  bool box_blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                   const Eigen::Vector3d& half) const;

 private:
  struct Tracer;
  std::unique_ptr<Tracer> tracer_;
};

// The distance to a mesh. It has no inside: every distance is at least 0.
class MeshDistance final : public DistanceField {
 public:
  MeshDistance(std::shared_ptr<const MeshScene> scene, double reach);
  double distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const override;
  double reach() const override { return reach_; }

 private:
  std::shared_ptr<const MeshScene> scene_;
  double reach_;
};

}  // namespace lapwing
