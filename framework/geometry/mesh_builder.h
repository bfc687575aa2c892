// SPDX-License-Identifier: Apache-2.0
// Makes a mesh out of boxes, prisms, tubes, balls and faces, each placed in the frame that is on
// top of a stack.
//
// Bodies are closed and their triangles turn counter-clockwise as seen from outside. Sizes are in
// metres of the frame; frames move, turn about z and scale evenly. Every call throws InputError
// that says which number is wrong, and then has added nothing.
#pragma once

#include <span>
#include <vector>

#include "framework/core/random.h"
#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

class MeshBuilder {
 public:
  // `seed` moves the bumps of rough balls alone.
  explicit MeshBuilder(std::uint64_t seed = 1) : random_(seed) {}

  // Of everything that follows.
  void set_color(const Rgb& color) { color_ = color; }

  // A frame within the one on top: its origin there, its yaw (rad), its scale.
  void push(const Eigen::Vector3d& origin, double yaw = 0, double scale = 1);
  // Throws InputError when nothing was pushed.
  void pop();
  std::size_t depth() const { return frames_.size(); }

  // A flat polygon without holes whose edges do not cross, three corners or more.
  void face(std::span<const Eigen::Vector3d> corners);
  void quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
            const Eigen::Vector3d& d);
  void box(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);
  // The polygon, in either turn, from one height up to another.
  void prism(std::span<const Eigen::Vector2d> corners, double floor, double ceiling);
  // A round bar; a radius of 0 ends it in a point. At least three sides.
  void tube(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius_from,
            double radius_to, int sides);
  // An ellipsoid of 20 * 4^detail triangles. `roughness` is the share by which corners are moved in
  // or out, at random.
  void ball(const Eigen::Vector3d& center, const Eigen::Vector3d& radii, int detail,
            double roughness = 0);
  // A surface over a grid: rows of `columns` heights, the first at `corner`, `step` apart along x,
  // rows along y.
  void terrain(const Eigen::Vector2d& corner, double step, int columns,
               std::span<const double> heights);

  const TriangleMesh& mesh() const { return mesh_; }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  struct Frame {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    double cosine = 1, sine = 0, scale = 1;
  };
  Eigen::Vector3d placed(const Eigen::Vector3d& p) const;
  std::int32_t add_vertex(const Eigen::Vector3d& p);
  void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c);
  void check_room(std::size_t triangles) const;

  TriangleMesh mesh_;
  std::vector<Frame> frames_{Frame{}};
  Rgb color_{180, 180, 180};
  Random random_;
};

// The triangles of a polygon without holes, as places in `corners`, counter-clockwise; by cutting
// off ears. Throws InputError for fewer than three corners, no area, or crossing edges where they
// leave no ear.
std::vector<std::array<std::int32_t, 3>> triangulate(std::span<const Eigen::Vector2d> corners);
// Of a polygon in space, as seen along its mean normal: they turn as its corners do.
std::vector<std::array<std::int32_t, 3>> triangulate_face(std::span<const Eigen::Vector3d> corners);

}  // namespace lapwing
