// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/triangle_mesh.h"

#include <bit>
#include <cmath>
#include <unordered_map>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kFarthestVertex = 1e5;             // m
constexpr std::size_t kLargestCount = 100'000'000;  // of vertices or triangles

struct Cell {
  std::array<std::int64_t, 3> at;
  bool operator==(const Cell&) const = default;
};

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t h = 0;
    for (const std::int64_t v : cell.at) {
      h = (h ^ static_cast<std::uint64_t>(v)) * 0x9e3779b97f4a7c15ULL;
      h ^= h >> 29;
    }
    return static_cast<std::size_t>(h);
  }
};

Cell cell_of(const Eigen::Vector3d& p, double tolerance) {
  Cell cell{};
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // The bits of the number itself where only equal ones are to meet; + 0.0 makes -0 a 0.
    if (tolerance > 0)
      cell.at[k] = std::llround(p[i] / tolerance);
    else
      cell.at[k] = std::bit_cast<std::int64_t>(p[i] + 0.0);
  }
  return cell;
}

}  // namespace

Eigen::AlignedBox3d TriangleMesh::bounds() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : vertices) box.extend(v);
  return box;
}

void check_mesh(const TriangleMesh& mesh, const std::string& what) {
  const auto fail = [&](const std::string& why) { throw InputError(what + ": " + why); };
  if (mesh.triangles.empty()) fail("the mesh has no triangle");
  if (mesh.vertices.size() > kLargestCount || mesh.triangles.size() > kLargestCount) {
    fail("the mesh has " + std::to_string(mesh.vertices.size()) + " vertices and " +
         std::to_string(mesh.triangles.size()) + " triangles; at most 100 million are read");
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!(mesh.vertices[i].cwiseAbs().maxCoeff() <= kFarthestVertex) ||
        !mesh.vertices[i].allFinite()) {
      fail("vertex " + std::to_string(i + 1) +
           " has a coordinate that is not finite or beyond 1e5 m");
    }
  }
  const auto count = static_cast<std::int64_t>(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::int32_t index : mesh.triangles[i]) {
      if (index >= 0 && index < count) continue;
      fail("triangle " + std::to_string(i + 1) + " names vertex " +
           std::to_string(std::int64_t{index} + 1) + " of " + std::to_string(count));
    }
  }
  if (!mesh.colors.empty() && mesh.colors.size() != mesh.triangles.size()) {
    fail(std::to_string(mesh.colors.size()) + " colours for " +
         std::to_string(mesh.triangles.size()) + " triangles");
  }
}

void weld(TriangleMesh& mesh, double tolerance) {
  std::unordered_map<Cell, std::int32_t, CellHash> places;
  places.reserve(mesh.vertices.size());
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<Rgb> colors;
  std::vector<std::int32_t> renamed(mesh.vertices.size(), -1);
  // Two that agree may lie on both sides of a border of cells. The first of them in the mesh.
  const auto beside = [&](const Cell& cell, const Eigen::Vector3d& p) {
    std::int32_t first = -1;
    for (int k = 0; k < 27; ++k) {
      const Cell next{{cell.at[0] + k % 3 - 1, cell.at[1] + k / 3 % 3 - 1, cell.at[2] + k / 9 - 1}};
      const auto it = places.find(next);
      if (it == places.end() || (first >= 0 && it->second > first)) continue;
      const Eigen::Vector3d off = vertices[static_cast<std::size_t>(it->second)] - p;
      if (off.cwiseAbs().maxCoeff() <= tolerance) first = it->second;
    }
    return first;
  };
  const auto place = [&](std::int32_t old) {
    std::int32_t& known = renamed[static_cast<std::size_t>(old)];
    if (known >= 0) return known;
    const Eigen::Vector3d& p = mesh.vertices[static_cast<std::size_t>(old)];
    const Cell cell = cell_of(p, tolerance);
    const auto it = places.find(cell);
    if (it != places.end()) return known = it->second;
    known = tolerance > 0 ? beside(cell, p) : -1;
    if (known >= 0) return known;
    known = static_cast<std::int32_t>(vertices.size());
    places.emplace(cell, known);
    vertices.push_back(p);
    return known;
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!(mesh.cross(i).norm() > 0)) continue;
    std::array<std::int32_t, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = place(mesh.triangles[i][k]);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    triangles.push_back(t);
    if (!mesh.colors.empty()) colors.push_back(mesh.colors[i]);
  }
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  mesh.colors = std::move(colors);
}

}  // namespace lapwing
