// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/judged_shape.h"

#include <cmath>
#include <map>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_file.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/winding.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// A mesh has no inside: what of it is nearer to the middle of a subject than the subject's own size
// is taken for a part of it.
class JudgedSurface final : public JudgedShape {
 public:
  JudgedSurface(TriangleMesh mesh, const std::string& name) : scene_(std::move(mesh), name) {}
  double distance(const Vector3d& p, double farthest) const override {
    const auto nearest = scene_.nearest(p, farthest);
    return nearest ? nearest->distance : farthest;
  }
  double reach() const override { return tolerances::kMeshReach; }
  bool hides(const Vector3d& camera, const Vector3d& middle, double own) const override {
    const double length = (middle - camera).norm() - own;
    return length > 0 && scene_.blocked({camera, (middle - camera).normalized(), length});
  }

 private:
  MeshScene scene_;
};

// Likewise a map.
class JudgedMap final : public JudgedShape {
 public:
  JudgedMap(const MapFile& file, const Eigen::AlignedBox3d& box) : voxels_(file, box) {}
  double distance(const Vector3d& p, double farthest) const override {
    return voxels_.distance(p, farthest);
  }
  double reach() const override { return tolerances::kMapReach; }
  std::optional<Nearest> nearest(const Vector3d& from, const Vector3d& to,
                                 double farthest) const override {
    const auto found = voxels_.nearest(from, to, farthest);
    return Nearest{found.distance, found.share};
  }
  bool hides(const Vector3d& camera, const Vector3d& middle, double own) const override {
    constexpr double kTouching = 1e-9;  // m, from a voxel, is on it
    const double length = (middle - camera).norm() - own;
    if (!(length > 0)) return false;
    const Vector3d end = camera + length * (middle - camera).normalized();
    return voxels_.nearest(camera, end, kTouching).distance < kTouching;
  }
  const BlockedVoxels* voxels() const override { return &voxels_; }

 private:
  BlockedVoxels voxels_;
};

// What triangles bound.
class JudgedSolid final : public JudgedShape {
 public:
  JudgedSolid(const TriangleMesh& mesh, double tolerance, const std::string& name)
      : scene_(mesh, name), tolerance_(tolerance) {}

  double distance(const Vector3d& p, double farthest) const override {
    const bool in = inside(p);
    // From inside the true way out is never farther than the box.
    const double reach = in ? scene_.mesh().bounds().diagonal().norm() : farthest;
    const auto nearest = scene_.nearest(p, reach);
    const double away = nearest ? nearest->distance : reach;
    return in ? -away : away;
  }
  double error() const override { return tolerance_; }
  double reach() const override { return tolerances::kMeshReach; }
  bool hides(const Vector3d& camera, const Vector3d& middle, double) const override {
    if (inside(middle)) return false;
    if (inside(camera)) return true;
    return scene_.blocked({camera, (middle - camera).normalized(), (middle - camera).norm()});
  }
  bool by_triangles() const override { return true; }

 private:
  bool inside(const Vector3d& p) const {
    const TriangleMesh& mesh = scene_.mesh();
    return mesh.bounds().contains(p) && std::abs(winding_number(mesh, p)) > 0.5;
  }

  MeshScene scene_;
  double tolerance_;
};

// The bytes of an obstacle's file, which the plan says what they were when it was made.
std::string recorded_file(const Obstacle& obstacle, const std::filesystem::path& file,
                          std::string& name) {
  const Value* hash = obstacle.parameters.find("sha256");
  name = obstacle.parameters.at("file").as_text();
  std::string bytes = read_file(file, std::size_t{1} << 30);
  if (!hash || !hash->is_text() || sha256(bytes) != hash->as_text())
    throw InputError("'" + name + "' has changed since planning");
  return bytes;
}

}  // namespace

std::optional<JudgedShape::Nearest> JudgedShape::nearest(const Vector3d&, const Vector3d&,
                                                         double) const {
  return std::nullopt;
}

std::unique_ptr<JudgedShape> judged_surface(TriangleMesh mesh, const std::string& name) {
  return std::make_unique<JudgedSurface>(std::move(mesh), name);
}

std::unique_ptr<JudgedShape> judged_solid(const TriangleMesh& mesh, double tolerance,
                                          const std::string& name) {
  return std::make_unique<JudgedSolid>(mesh, tolerance, name);
}

std::string open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> balance;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  std::size_t open = 0;
  for (const auto& [edge, count] : balance) open += count != 0;
  if (open == 0) return "";
  return " has triangles that do not bound a solid: " + std::to_string(open) +
         " edges have no neighbour with the same orientation";
}

std::unique_ptr<JudgedShape> judged_shape(const Obstacle& obstacle,
                                          const std::filesystem::path& file,
                                          const Eigen::AlignedBox3d& around) {
  if (auto form = judged_form(obstacle)) return form;
  std::string name;
  if (obstacle.type == "mesh") {
    recorded_file(obstacle, file, name);
    return judged_surface(read_mesh(file).mesh, obstacle.name);
  }
  if (obstacle.type == "map")
    return std::make_unique<JudgedMap>(parse_map(recorded_file(obstacle, file, name), name),
                                       around);
  return judged_solid(*obstacle.triangles, obstacle.tolerance, obstacle.type);
}

}  // namespace lapwing
