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

}  // namespace

void add_surroundings(const Plan& plan, const std::filesystem::path& folder, Drawing& drawing) {
  const Environment& environment = plan.environment;
  drawing.spheres = environment.spheres;
  drawing.boxes = environment.boxes;
  drawing.zones = environment.zones;
  double low = 0, high = 0;
  for (const Sample& s : plan.trajectory.samples) {
    low = std::min(low, s.position.z());
    high = std::max(high, s.position.z());
  }
  for (const Zone& zone : environment.flight_zones) add_outline(zone, low, high, drawing);
  for (const MeshObstacle& mesh : environment.meshes) {
    if (folder.empty()) continue;
    try {
      add_edges(read_mesh(folder / mesh.file).mesh, mesh.name.empty() ? "mesh" : mesh.name,
                drawing);
    } catch (const InputError&) {
      // The certificate says what is wrong with it.
    }
  }
}

}  // namespace lapwing
