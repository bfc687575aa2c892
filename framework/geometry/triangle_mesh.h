// SPDX-License-Identifier: Apache-2.0
// A surface of triangles. World frame, metres.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace lapwing {

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;               // m
  std::vector<std::array<std::int32_t, 3>> triangles;  // places in `vertices`, counter-clockwise as
                                                       // seen from outside, where there is one
  std::vector<Rgb> colors;  // one per triangle, or none at all; for pictures

  const Eigen::Vector3d& corner(std::size_t triangle, int which) const {
    return vertices[static_cast<std::size_t>(triangles[triangle][static_cast<std::size_t>(which)])];
  }
  // Half the length of this is the area.
  Eigen::Vector3d cross(std::size_t triangle) const {
    const Eigen::Vector3d& a = corner(triangle, 0);
    return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
  }
  // Unit; zero of a triangle without area.
  Eigen::Vector3d normal(std::size_t triangle) const { return cross(triangle).normalized(); }
  double area(std::size_t triangle) const { return cross(triangle).norm() / 2; }
  // Empty for a mesh without vertices.
  Eigen::AlignedBox3d bounds() const;
};

// Throws InputError, its text beginning with `what` (a file's name, say), when the mesh has no
// triangle, a coordinate that is not finite or beyond 1e5 m, an index out of range, colours that do
// not fit the triangles, or more than 100 million vertices or triangles.
void check_mesh(const TriangleMesh& mesh, const std::string& what);

// Puts vertices that agree to `tolerance` metres in one (0: exactly equal ones), drops triangles
// that thereby lose their area and vertices that none uses. The order of what stays is kept.
void weld(TriangleMesh& mesh, double tolerance);

}  // namespace lapwing
