// SPDX-License-Identifier: Apache-2.0
#include "framework/view/true_surface.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kPlaces = 40'000;         // on the whole surface, before both sides are tried
constexpr int kDirections = 64;            // tried from each place
constexpr double kAway = 1e-3;             // m from the surface, where rays begin
constexpr double kLeastCosine = 0.173648;  // of 80 degrees

// Unit vectors, spread evenly over the sphere.
std::vector<Vector3d> directions() {
  std::vector<Vector3d> all;
  const double golden = EIGEN_PI * (3 - std::sqrt(5.0));
  for (int k = 0; k < 2 * kDirections; ++k) {
    const double z = 1 - (k + 0.5) / kDirections;
    const double across = std::sqrt(1 - z * z);
    all.emplace_back(across * std::cos(golden * k), across * std::sin(golden * k), z);
  }
  return all;
}

// m along a ray from within a box to its edge; below 0 where it leaves through the bottom.
double way_out(const Vector3d& from, const Vector3d& direction, const Eigen::AlignedBox3d& box) {
  double nearest = std::numeric_limits<double>::infinity();
  bool down = false;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) continue;
    const double face = direction[i] > 0 ? box.max()[i] : box.min()[i];
    const double distance = std::max(0.0, (face - from[i]) / direction[i]);
    if (distance < nearest) nearest = distance, down = i == 2 && direction[i] < 0;
  }
  return down ? -1 : nearest;
}

}  // namespace

TrueSurface::TrueSurface(std::shared_ptr<const MeshScene> scene, const InterestRegion& region,
                         const Eigen::AlignedBox3d& room, int threads)
    : scene_(std::move(scene)) {
  const TriangleMesh& mesh = scene_->mesh();
  const Eigen::AlignedBox3d& bounds = region.bounds();
  double whole = 0;  // of triangles that may come into the region
  const auto near = [&](std::size_t t) {
    Eigen::AlignedBox3d box(mesh.corner(t, 0));
    box.extend(mesh.corner(t, 1)).extend(mesh.corner(t, 2));
    return bounds.intersects(box);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (near(t)) whole += mesh.area(t);
  // A ground far beyond the region takes places that do not count.
  const double held = std::min(whole, 20 * bounds.sizes().maxCoeff() * bounds.sizes().maxCoeff());
  area_of_place_ = held / kPlaces;
  if (!(area_of_place_ > 0)) throw InputError("the region of interest holds no surface");
  std::vector<Place> tried;
  double left = 0.5 * area_of_place_;  // until the next place
  std::size_t number = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!near(t)) continue;
    const Vector3d a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a;
    const Vector3d normal = mesh.normal(t);
    for (left -= mesh.area(t); left < 0; left += area_of_place_) {
      // Additive recurrence of the plastic number: even in two dimensions, and repeatable.
      ++number;
      double u = std::fmod(0.7548776662466927 * static_cast<double>(number), 1.0);
      double v = std::fmod(0.5698402909980532 * static_cast<double>(number), 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vector3d p = a + u * ab + v * ac;
      if (!region.contains(p)) continue;
      tried.push_back({p, normal});
      tried.push_back({p, -normal});
    }
  }
  const std::vector<Vector3d> ways = directions();
  Eigen::AlignedBox3d space = room;
  space.extend(bounds);
  std::vector<char> counts(tried.size(), 0);
  parallel_for(tried.size(), threads, [&](std::size_t k) {
    const Vector3d from = tried[k].position + kAway * tried[k].normal;
    for (const Vector3d& way : ways) {
      if (way.dot(tried[k].normal) < kLeastCosine) continue;
      const double out = way_out(from, way, space);
      if (out < 0 || scene_->blocked({from, way, out})) continue;
      counts[k] = 1;
      return;
    }
  });
  for (std::size_t k = 0; k < tried.size(); ++k)
    if (counts[k]) places_.push_back(tried[k]);
  if (places_.empty()) throw InputError("the region of interest holds no surface");
}

double TrueSurface::area() const {
  return area_of_place_ * static_cast<double>(places_.size());
}

double TrueSurface::seen(std::span<const Viewpoint> views, const Pinhole& pinhole, double range,
                         int threads) const {
  std::vector<Pose> cameras;
  std::vector<Eigen::Matrix3d> to_camera;
  for (const Viewpoint& view : views) {
    cameras.push_back(view.camera());
    to_camera.push_back(cameras.back().orientation.toRotationMatrix().transpose());
  }
  std::vector<char> met(places_.size(), 0);
  parallel_for(places_.size(), threads, [&](std::size_t k) {
    const Place& place = places_[k];
    const Vector3d target = place.position + kAway * place.normal;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const Vector3d way = target - cameras[i].position;
      const double distance = way.norm();
      if (distance > range || -way.dot(place.normal) < kLeastCosine * distance) continue;
      const Vector3d at = to_camera[i] * way;
      if (!(at.z() > 0)) continue;
      const double x = pinhole.focal_x * at.x() / at.z() + pinhole.principal_x;
      const double y = pinhole.focal_y * at.y() / at.z() + pinhole.principal_y;
      if (x < -0.5 || y < -0.5 || x > pinhole.width - 0.5 || y > pinhole.height - 0.5) continue;
      if (scene_->blocked({cameras[i].position, way / distance, distance})) continue;
      met[k] = 1;
      return;
    }
  });
  return area_of_place_ * static_cast<double>(std::count(met.begin(), met.end(), 1));
}

}  // namespace lapwing
