// SPDX-License-Identifier: Apache-2.0
// Where a body may be: the same questions to meshes and to maps. World frame, metres.
//
// Bodies are boxes parallel to the axes, as the thesis has its drone (4.3; reading 4.11). Touching
// is free (reading 5.3). In a map unknown voxels are blocked; a mesh blocks where its triangles are
// and has no inside.
#pragma once

#include <memory>

#include <Eigen/Geometry>

#include "framework/geometry/mesh_scene.h"
#include "framework/map/map.h"

namespace lapwing {

class FreeSpace {
 public:
  virtual ~FreeSpace() = default;

  // All are thread-safe while nobody changes what they ask.
  virtual bool point_free(const Eigen::Vector3d& p_W) const = 0;
  virtual bool segment_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const = 0;
  // A box with half edges `half` whose middle moves straight.
  virtual bool swept_box_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                              const Eigen::Vector3d& half) const = 0;
  // What is known of the space lies in this box; beyond it a map is blocked and a mesh is not.
  virtual Eigen::AlignedBox3d bounds() const = 0;
};

// Each shares its source with the caller; null is a defect (Error).
std::unique_ptr<FreeSpace> free_space_of(std::shared_ptr<const MeshScene> scene);
std::unique_ptr<FreeSpace> free_space_of(std::shared_ptr<const Map> map);
// Free where both are.
std::unique_ptr<FreeSpace> free_in_both(std::unique_ptr<FreeSpace> a, std::unique_ptr<FreeSpace> b);
// Free where a body larger by `more` metres on every side is.
std::unique_ptr<FreeSpace> with_room(std::unique_ptr<FreeSpace> space, double more);

}  // namespace lapwing
