// SPDX-License-Identifier: Apache-2.0
// Scenes made by the shipped scripts, and how much of one a simple flight around it would see.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <numbers>

#include "framework/geometry/camera_view.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/mission/scene_script.h"

namespace lapwing {

inline MissionSettings scene_settings() {
  MissionSettings settings;
  settings.scripts = std::filesystem::path(LAPWING_SOURCE_DIR) / "scripts";
  settings.configs = std::filesystem::path(LAPWING_SOURCE_DIR) / "configs";
  return settings;
}

inline GeneratedScene shipped_scene(const std::string& name, std::int64_t seed = 1) {
  Value options = Value::map();
  options.set("seed", seed);
  const MissionSettings settings = scene_settings();
  return generate_scene(settings.scripts / "scene" / (name + ".lua"), options, settings);
}

// The air that can be reached from outside a region: cells of a metre that hold no surface,
// next to each other from the top down. What is walled in on all sides is none of a flight's
// business.
class ReachableAir {
 public:
  ReachableAir(const MeshScene& scene, const Eigen::AlignedBox3d& region)
      : lower_(region.min() - Eigen::Vector3d::Constant(2)) {
    const Eigen::Vector3d size = region.sizes() + Eigen::Vector3d::Constant(4);
    size_ = size.array().ceil().cast<int>();
    reached_.assign(static_cast<std::size_t>(size_.prod()), false);
    std::deque<Eigen::Vector3i> open{{0, 0, size_.z() - 1}};
    reached_[place(open.front())] = true;
    while (!open.empty()) {
      const Eigen::Vector3i cell = open.front();
      open.pop_front();
      for (int k = 0; k < 6; ++k) {
        const Eigen::Vector3i next = cell + (k < 3 ? 1 : -1) * Eigen::Vector3i::Unit(k % 3);
        if ((next.array() < 0).any() || (next.array() >= size_.array()).any()) continue;
        // The whole way, because a wall may stand exactly between two cells.
        if (reached_[place(next)] ||
            scene.box_blocked(middle(cell), middle(next), Eigen::Vector3d::Constant(0.5))) {
          continue;
        }
        reached_[place(next)] = true;
        open.push_back(next);
      }
    }
  }

  // Whether a place that the air reaches, at most about two metres away, has a free view of it.
  bool near(const MeshScene& scene, const Eigen::Vector3d& p) const {
    const Eigen::Vector3i cell = (p - lower_).array().floor().cast<int>();
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i other = cell + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if ((other.array() < 0).any() || (other.array() >= size_.array()).any()) continue;
      if (!reached_[place(other)]) continue;
      const Eigen::Vector3d way = middle(other) - p;
      const double distance = way.norm();
      if (!scene.blocked({p, way / distance, distance})) return true;
    }
    return false;
  }

 private:
  std::size_t place(const Eigen::Vector3i& c) const {
    return static_cast<std::size_t>((c.z() * size_.y() + c.y()) * size_.x() + c.x());
  }
  Eigen::Vector3d middle(const Eigen::Vector3i& c) const {
    return lower_ + c.cast<double>() + Eigen::Vector3d::Constant(0.5);
  }

  Eigen::Vector3d lower_;
  Eigen::Vector3i size_;
  std::vector<bool> reached_;
};

// A place on a surface, a hair in front of it on the side that air reaches.
struct SurfacePoint {
  Eigen::Vector3d place, normal;
};

// Spread evenly over the region's surface, as many as asked for or fewer: those next to air.
inline std::vector<SurfacePoint> surface_of(const MeshScene& scene,
                                            const Eigen::AlignedBox3d& region, int count) {
  const TriangleMesh& mesh = scene.mesh();
  const ReachableAir air(scene, region);
  double total = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) total += mesh.area(i);
  Random random(1);
  std::vector<SurfacePoint> points;
  double passed = 0, next = total / count * random.uniform();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (passed += mesh.area(i); next < passed; next += total / count) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Eigen::Vector3d& a = mesh.corner(i, 0);
      const Eigen::Vector3d p = a + u * (mesh.corner(i, 1) - a) + v * (mesh.corner(i, 2) - a);
      if (!region.contains(p)) continue;
      for (const double side : {1.0, -1.0}) {
        const Eigen::Vector3d normal = side * mesh.normal(i);
        // The way out of the surface must be free, or this side lies inside a wall.
        const MeshRay out{p + 0.01 * normal, normal, 0.6};
        if (scene.blocked(out) || !air.near(scene, p + 0.6 * normal)) continue;
        points.push_back({p + 0.01 * normal, normal});
        break;
      }
    }
  }
  return points;
}

// `count` cameras of 600 by 450 pixels all over a hemisphere about the region's centre, looking at
// it.
inline std::vector<CameraView> hemisphere(const Eigen::AlignedBox3d& region, double radius,
                                          int count) {
  std::vector<CameraView> views;
  const Eigen::Vector3d center = region.center();
  for (int i = 0; i < count; ++i) {
    const double up = (i + 0.5) / count, around = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - up * up);
    const Eigen::Vector3d out(across * std::cos(around), across * std::sin(around), up);
    CameraView view;
    view.pinhole = {600, 450, 345, 345, 299.5, 224.5};
    view.position = center + radius * out;
    view.axes = camera_axes(std::atan2(-out.y(), -out.x()), -std::asin(out.z()));
    views.push_back(view);
  }
  return views;
}

// The share of the region's surface that none of the views sees: in front, inside the image,
// nothing in between.
inline double unseen_share(const MeshScene& scene, const Eigen::AlignedBox3d& region,
                           const std::vector<CameraView>& views, int count) {
  const auto points = surface_of(scene, region, count);
  EXPECT_GT(points.size(), 1000u);
  int unseen = 0;
  for (const SurfacePoint& point : points) {
    bool seen = false;
    for (const CameraView& view : views) {
      const Eigen::Vector3d way = view.position - point.place;
      if (way.dot(point.normal) <= 0 || !view.sees(point.place)) continue;
      const double distance = way.norm();
      seen = !scene.blocked({point.place, way / distance, distance});
      if (seen) break;
    }
    if (!seen) ++unseen;
  }
  return static_cast<double>(unseen) / static_cast<double>(points.size());
}

}  // namespace lapwing
