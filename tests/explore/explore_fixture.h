// SPDX-License-Identifier: Apache-2.0
// A small world to explore: a yard between walls, in voxels of 0.4 m.
#pragma once

#include <functional>

#include "framework/core/error.h"
#include "framework/explore/episode.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/plugin/registry.h"

namespace lapwing {

inline const Registry& plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

// The message of the error that the call ends in; empty where it ends in none.
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline void add_quad(TriangleMesh& mesh, const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                     const Eigen::Vector3d& v) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {corner, corner + u, corner + u + v, corner + v});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

inline void add_box(TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::Vector3d size = high - low;
  const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  add_quad(mesh, low, x, y);
  add_quad(mesh, low + z, x, y);
  add_quad(mesh, low, x, z);
  add_quad(mesh, low + y, x, z);
  add_quad(mesh, low, y, z);
  add_quad(mesh, low + x, y, z);
}

// Ground of 40 m x 40 m, two houses and a sealed chest that nobody sees from inside.
inline std::shared_ptr<const MeshScene> yard() {
  TriangleMesh mesh;
  add_quad(mesh, {-20, -20, 0.1}, {40, 0, 0}, {0, 40, 0});
  add_box(mesh, {6.1, -8.1, 0.1}, {14.1, 2.1, 7.1});
  add_box(mesh, {-14.1, 4.1, 0.1}, {-7.1, 13.1, 5.1});
  return std::make_shared<MeshScene>(std::move(mesh), "yard");
}

struct YardWorld {
  GroundTruth truth{yard(), {Eigen::Vector3d(-16, -16, 0), Eigen::Vector3d(16, 16, 9)}, 0.4};
  EpisodeSettings settings;
  double pitch = -10 * EIGEN_PI / 180;
  Viewpoint start{{0, 0, 4}, 0.3, pitch};

  explicit YardWorld(int steps = 8) {
    settings.sensor.pinhole = {80, 60, 40, 40, 39.5, 29.5};
    settings.steps = steps;
  }
  static std::unique_ptr<Map> new_map() {
    Value given = Value::map();
    given.set("resolution", 0.4);
    given.set("hit", 0.9);
    given.set("miss", 0.1);
    given.set("maximum_range", 20.0);
    given.set("observations", true);
    return plugins().create<Map>("brick", given);
  }
  EpisodeResult run(const ViewUtility& utility, const EpisodeObserver& observer = {}) const {
    ObservedSurface observed(truth, settings.sensor, new_map);
    const auto map = new_map();
    return explore(settings, start, truth, observed, utility, *map, observer);
  }
};

}  // namespace lapwing
