// SPDX-License-Identifier: Apache-2.0
#include "framework/export/surroundings.h"

#include <cmath>
#include <map>

#include "framework/core/error.h"
#include "framework/geometry/mesh_file.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostEdges = 3000;
constexpr double kSharp = 0.9;  // cosine between the normals on both sides of an edge

void add_outline(const Zone& zone, double low, double high, Drawing& drawing) {
  const double floor = std::isfinite(zone.floor) ? zone.floor : low;
  const double ceiling = std::isfinite(zone.ceiling) ? zone.ceiling : high;
  Polyline line{zone.name.empty() ? "flight zone" : zone.name, {}, {}, {}};
  for (const double height : {floor, ceiling}) {
    for (const Eigen::Vector2d& corner : zone.corners)
      line.points.emplace_back(corner.x(), corner.y(), height);
    line.points.emplace_back(zone.corners.front().x(), zone.corners.front().y(), height);
    line.points.push_back(Eigen::Vector3d::Constant(std::nan("")));
  }
  for (const Eigen::Vector2d& corner : zone.corners) {
    line.points.emplace_back(corner.x(), corner.y(), floor);
    line.points.emplace_back(corner.x(), corner.y(), ceiling);
    line.points.push_back(Eigen::Vector3d::Constant(std::nan("")));
  }
  drawing.lines.push_back(std::move(line));
}

void add_edges(const TriangleMesh& mesh, const std::string& name, Drawing& drawing) {
  struct Sides {
    Eigen::Vector3d normal;
    int count = 0;
    bool sharp = false;
  };
  std::map<std::pair<int, int>, Sides> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d normal = mesh.normal(t);
    for (int i = 0; i < 3; ++i) {
      const int a = mesh.triangles[t][static_cast<std::size_t>(i)];
      const int b = mesh.triangles[t][static_cast<std::size_t>((i + 1) % 3)];
      Sides& sides = edges[{std::min(a, b), std::max(a, b)}];
      if (sides.count++ == 0)
        sides.normal = normal;
      else
        sides.sharp |= sides.normal.dot(normal) < kSharp;
    }
  }
  Polyline line{name, {}, {}, {}};
  for (const auto& [ends, sides] : edges) {
    if (sides.count > 1 && !sides.sharp) continue;
    line.points.push_back(mesh.vertices[static_cast<std::size_t>(ends.first)]);
    line.points.push_back(mesh.vertices[static_cast<std::size_t>(ends.second)]);
    line.points.push_back(Eigen::Vector3d::Constant(std::nan("")));
  }
  if (!line.points.empty() && line.points.size() <= 3 * kMostEdges)
    drawing.lines.push_back(std::move(line));
}

Zone drawn_zone(const Obstacle& obstacle, const Eigen::Vector3d& moved) {
  Zone zone;
  zone.name = obstacle.name;
  const auto corners = recorded_numbers(obstacle.parameters, "corners");
  for (std::size_t i = 0; i + 1 < corners.size(); i += 2)
    zone.corners.emplace_back(corners[i] + moved.x(), corners[i + 1] + moved.y());
  const auto height = [&](const char* key, double& end) {
    if (const Value* found = obstacle.parameters.find(key)) end = found->as_number() + moved.z();
  };
  height("floor", zone.floor);
  height("ceiling", zone.ceiling);
  return zone;
}

// The part of endless surfaces that is shown.
Eigen::AlignedBox3d shown(const Plan& plan) {
  constexpr double kRoom = 10;  // m
  Eigen::AlignedBox3d box;
  for (const Sample& s : plan.trajectory.samples) box.extend(s.position);
  if (box.isEmpty()) box.extend(Eigen::Vector3d(Eigen::Vector3d::Zero()));
  const Eigen::Vector3d room = Eigen::Vector3d::Constant(kRoom);
  return {box.min() - room, box.max() + room};
}

TriangleMesh moved_mesh(TriangleMesh mesh, const Eigen::Vector3d& moved) {
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex += moved;
  return mesh;
}

}  // namespace

TriangleMesh drawn_surface(const Obstacle& obstacle, const Plan& plan,
                           const std::filesystem::path& folder) {
  constexpr double kShare = 0.02;  // of its size, that chords may leave a round surface by
  if (obstacle.shape) {
    Eigen::AlignedBox3d within = shown(plan);
    const Eigen::AlignedBox3d bounds = obstacle.shape->bounds();
    if (!within.intersects(bounds)) {
      within.extend(Eigen::Vector3d(within.center().cwiseMax(bounds.min()).cwiseMin(bounds.max())));
    }
    const double size = bounds.intersection(within).sizes().minCoeff();
    return obstacle.shape->triangles(std::max(kShare * size, 1e-3), within);
  }
  if (obstacle.triangles) return *obstacle.triangles;
  const Value* file = obstacle.parameters.find("file");
  if (obstacle.type != "mesh" || folder.empty() || !file) return {};
  try {
    return read_mesh(folder / file->as_text()).mesh;
  } catch (const InputError&) {
    return {};  // the certificate says what is wrong with it
  }
}

namespace {

void add_obstacle(const Obstacle& obstacle, const Plan& plan, const std::filesystem::path& folder,
                  Drawing& drawing) {
  const Eigen::Vector3d moved = obstacle.moved(0);
  if (obstacle.type == "prism") {
    drawing.zones.push_back(drawn_zone(obstacle, moved));
    return;
  }
  if (obstacle.shape) {
    if (const auto form = obstacle.shape->simple_form()) {
      const Eigen::Vector3d center = form->center + moved;
      if (form->round)
        drawing.spheres.push_back({obstacle.name, center, form->half.x()});
      else
        drawing.boxes.push_back({obstacle.name, center - form->half, center + form->half});
      return;
    }
  }
  TriangleMesh surface = moved_mesh(drawn_surface(obstacle, plan, folder), moved);
  if (surface.triangles.empty()) return;
  const bool solid = obstacle.shape ? obstacle.shape->solid() : obstacle.type != "mesh";
  if (solid)
    drawing.solids.push_back({obstacle.name, std::move(surface)});
  else
    add_edges(surface, obstacle.name.empty() ? obstacle.type : obstacle.name, drawing);
}

}  // namespace

void add_surroundings(const Plan& plan, const std::filesystem::path& folder, Drawing& drawing) {
  double low = 0, high = 0;
  for (const Sample& s : plan.trajectory.samples) {
    low = std::min(low, s.position.z());
    high = std::max(high, s.position.z());
  }
  for (const Obstacle& obstacle : plan.environment.obstacles) {
    if (obstacle.side == Side::keep_out)
      add_obstacle(obstacle, plan, folder, drawing);
    else if (obstacle.type == "prism")
      add_outline(drawn_zone(obstacle, obstacle.moved(0)), low, high, drawing);
    else
      add_edges(moved_mesh(drawn_surface(obstacle, plan, folder), obstacle.moved(0)),
                obstacle.name.empty() ? "flight zone" : obstacle.name, drawing);
  }
}

}  // namespace lapwing
