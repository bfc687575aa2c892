// SPDX-License-Identifier: Apache-2.0
#include "framework/shape/surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::int32_t index_of(std::size_t i) {
  return static_cast<std::int32_t>(i);
}

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Whether p lies in the triangle a, b, c, which turns counter-clockwise; its edges included.
bool holds(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& p) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

// Corners that turn counter-clockwise, cut ear by ear.
std::vector<std::array<std::int32_t, 3>> ears(const std::vector<Vector2d>& corners) {
  std::vector<std::size_t> rest(corners.size());
  std::iota(rest.begin(), rest.end(), 0);
  std::vector<std::array<std::int32_t, 3>> triangles;
  while (rest.size() > 3) {
    std::size_t best = rest.size();
    for (std::size_t k = 0; k < rest.size() && best == rest.size(); ++k) {
      const std::size_t i = rest[(k + rest.size() - 1) % rest.size()], j = rest[k],
                        l = rest[(k + 1) % rest.size()];
      const Vector2d &a = corners[i], &b = corners[j], &c = corners[l];
      if (cross(b - a, c - b) <= 0) continue;
      if (std::none_of(rest.begin(), rest.end(), [&](std::size_t m) {
            return m != i && m != j && m != l && holds(a, b, c, corners[m]);
          }))
        best = k;
    }
    if (best == rest.size()) best = 0;  // corners in line: a triangle without area
    const std::size_t n = rest.size();
    triangles.push_back(
        {index_of(rest[(best + n - 1) % n]), index_of(rest[best]), index_of(rest[(best + 1) % n])});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({index_of(rest[0]), index_of(rest[1]), index_of(rest[2])});
  return triangles;
}

}  // namespace

int chords_of(double radius, double tolerance) {
  constexpr int kFewest = 8, kMost = 2000;
  if (!(tolerance > 0) || tolerance >= radius) return kFewest;
  const double half = std::acos(1 - tolerance / radius);  // of the angle of a chord
  return std::clamp(static_cast<int>(std::ceil(std::numbers::pi / half)), kFewest, kMost);
}

TriangleMesh turned_surface(const std::vector<Vector2d>& profile, int chords,
                            const Vector3d& origin, const Eigen::Matrix3d& R) {
  TriangleMesh mesh;
  const auto n = static_cast<std::size_t>(chords);
  std::vector<std::size_t> first;  // vertex of each ring; on the axis it has one alone
  std::vector<bool> single;
  const auto ring = [&](const Vector2d& point) {
    first.push_back(mesh.vertices.size());
    single.push_back(point.x() <= 0);
    const std::size_t count = single.back() ? 1 : n;
    for (std::size_t k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      mesh.vertices.emplace_back(origin + R * Vector3d(std::max(point.x(), 0.0) * std::cos(angle),
                                                       std::max(point.x(), 0.0) * std::sin(angle),
                                                       point.y()));
    }
  };
  if (profile.front().x() > 0) ring({0, profile.front().y()});
  for (const Vector2d& point : profile) ring(point);
  if (profile.back().x() > 0) ring({0, profile.back().y()});
  const auto vertex = [&](std::size_t r, std::size_t k) {
    return index_of(first[r] + (single[r] ? 0 : k % n));
  };
  for (std::size_t r = 0; r + 1 < first.size(); ++r)
    for (std::size_t k = 0; k < n; ++k) {
      if (!single[r]) mesh.triangles.push_back({vertex(r, k), vertex(r, k + 1), vertex(r + 1, k)});
      if (!single[r + 1])
        mesh.triangles.push_back({vertex(r, k + 1), vertex(r + 1, k + 1), vertex(r + 1, k)});
    }
  return mesh;
}

TriangleMesh box_surface(const Eigen::AlignedBox3d& box) {
  const Vector3d &a = box.min(), &b = box.max();
  return prism_surface({{a.x(), a.y()}, {b.x(), a.y()}, {b.x(), b.y()}, {a.x(), b.y()}}, a.z(),
                       b.z());
}

TriangleMesh cut_box(const Eigen::AlignedBox3d& box, const Vector3d& point,
                     const Vector3d& normal) {
  TriangleMesh mesh;
  std::vector<Vector3d> cut;  // corners of the face in the plane
  const auto corner = [&](int k) {
    return box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
  };
  const auto add = [&](const std::vector<Vector3d>& polygon) {
    const auto start = index_of(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), polygon.begin(), polygon.end());
    for (std::int32_t k = 2; k < index_of(polygon.size()); ++k)
      mesh.triangles.push_back({start, start + k - 1, start + k});
  };
  // Faces of the box, counter-clockwise as seen from outside; bits of a corner are x, y, z.
  static constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& face : kFaces) {
    std::vector<Vector3d> kept;
    for (int k = 0; k < 4; ++k) {
      const Vector3d a = corner(face[k]), b = corner(face[(k + 1) % 4]);
      const double from = normal.dot(a - point), to = normal.dot(b - point);
      if (from <= 0) kept.push_back(a);
      if ((from <= 0) == (to <= 0)) continue;
      kept.push_back(a + from / (from - to) * (b - a));
      cut.push_back(kept.back());
    }
    if (kept.size() >= 3) add(kept);
  }
  if (cut.size() >= 3) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : cut) middle += p / static_cast<double>(cut.size());
    const Vector3d across = normal.unitOrthogonal(), up = normal.cross(across);
    std::sort(cut.begin(), cut.end(), [&](const Vector3d& a, const Vector3d& b) {
      return std::atan2(up.dot(a - middle), across.dot(a - middle)) <
             std::atan2(up.dot(b - middle), across.dot(b - middle));
    });
    std::vector<Vector3d> face;  // every corner was met from two faces
    for (const Vector3d& p : cut)
      if (face.empty() || (p - face.back()).norm() > 1e-9) face.push_back(p);
    while (face.size() > 1 && (face.front() - face.back()).norm() <= 1e-9) face.pop_back();
    if (face.size() >= 3) add(face);
  }
  weld(mesh, 1e-9);
  return mesh;
}

TriangleMesh prism_surface(std::vector<Vector2d> corners, double floor, double ceiling) {
  double twice_area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    twice_area += cross(corners[i], corners[(i + 1) % corners.size()]);
  if (twice_area < 0) std::reverse(corners.begin(), corners.end());
  TriangleMesh mesh;
  const std::int32_t n = index_of(corners.size());
  for (const double height : {floor, ceiling})
    for (const Vector2d& corner : corners)
      mesh.vertices.emplace_back(corner.x(), corner.y(), height);
  for (const auto& ear : ears(corners)) {
    mesh.triangles.push_back({ear[0], ear[2], ear[1]});
    mesh.triangles.push_back({ear[0] + n, ear[1] + n, ear[2] + n});
  }
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, next + n});
    mesh.triangles.push_back({i, next + n, i + n});
  }
  return mesh;
}

}  // namespace lapwing
