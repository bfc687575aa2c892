// SPDX-License-Identifier: Apache-2.0
// Which parts of a true surface can be seen by who flies: what the recall of a model is measured
// against. Inner faces of walls, closed rooms and what nobody comes near enough to do not count.
//
// The room is cut into cubes. A cube is free when the vehicle's box, its middle in the cube's
// middle, enters no triangle, and it is joined to the cubes of the first flight by free cubes. A
// piece of surface counts if a straight line within a distance and an angle of incidence leads from
// one of its sides to a free cube without meeting the surface; 256 directions a side are tried.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "framework/geometry/mesh_scene.h"

namespace lapwing {

struct ViewingSettings {
  Eigen::AlignedBox3d room;               // of the vehicle's middle, m
  Eigen::Vector3d body{1, 1, 0.5};        // half edges of the vehicle's box, m
  double range = 30;                      // m, of an image
  double incidence = 1.3089969389957472;  // rad, 75 degrees
  double step = 0.5;                      // m, edge of a cube
};

class ViewingSpace {
 public:
  // `from`: places of which at least one lies in a free cube. The same for any number of threads.
  // InputError for an empty room, one of more than 2^28 cubes, and where no place is free.
  ViewingSpace(std::shared_ptr<const MeshScene> scene, const ViewingSettings& settings,
               std::span<const Eigen::Vector3d> from, int threads);

  // Whether the surface at a point, its unit normal to either side, can be seen. Thread-safe.
  bool sees(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  double free_volume() const;  // m^3

 private:
  std::size_t place(const Eigen::Array3i& at) const;
  Eigen::Array3i cube_of(const Eigen::Vector3d& p) const;
  bool inside(const Eigen::Array3i& at) const;
  void find_free(int threads);
  void keep_joined(std::span<const Eigen::Vector3d> from);
  bool meets_free(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;

  std::shared_ptr<const MeshScene> scene_;
  ViewingSettings settings_;
  Eigen::Array3i count_;
  std::vector<char> free_;                   // cubes, x fastest
  std::vector<Eigen::Vector3d> directions_;  // of a side whose normal is +z
};

}  // namespace lapwing
