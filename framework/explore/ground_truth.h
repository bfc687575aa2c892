// SPDX-License-Identifier: Apache-2.0
// What there is to be found: the voxels of a surface that can be seen from the space around it, and
// how much of them a map has observed (thesis 5.4.1, 5.4.2). Only a simulation has it.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "framework/core/random.h"
#include "framework/explore/view_sensor.h"
#include "framework/explore/view_utility.h"
#include "framework/explore/viewpoint_index.h"
#include "framework/geometry/mesh_scene.h"

namespace lapwing {

// The surface of a scene in voxels. The space that an exploration is about is the one connected
// space of voxels without surface that holds most of the region of interest: the rooms of an
// office, all that is outside of houses. Surf of (5.2) are the voxels of the surface that have a
// face in common with it (reading 5.2: those that can be seen).
class GroundTruth {
 public:
  // Metres above and beside the scene that belong to the space around it.
  static constexpr double kAbove = 8, kBeside = 2;
  static constexpr double kFarthest = 20;

  // InputError: a scene with no surface in reach, more than 2^29 voxels, a resolution that is not
  // above 0.
  // With `inside` it is the space that holds that place; InputError where it lies more than
  // kFarthest from the box of the scene.
  GroundTruth(std::shared_ptr<const MeshScene> scene, const Eigen::AlignedBox3d& region,
              double resolution, const std::optional<Eigen::Vector3d>& inside = std::nullopt);

  const MeshScene& scene() const { return *scene_; }
  // For those who need it longer.
  const std::shared_ptr<const MeshScene>& shared_scene() const { return scene_; }
  const VoxelGrid& grid() const { return grid_; }
  const Eigen::AlignedBox3d& region() const { return region_; }
  std::size_t size() const { return surface_.size(); }
  std::span<const VoxelKey> surface() const { return surface_; }

  // Whether a place lies in the space that the exploration is about.
  bool in_space(const Eigen::Vector3d& p_W) const;

  // Whether the surface enters a box.
  bool box_blocked(const Eigen::AlignedBox3d& box) const;

  // Calls `visit(first, last)` for runs of places in `surface` that hold all voxels within a box.
  template <class Visit>
  void for_each_run(const VoxelBox& box, Visit visit) const;

 private:
  static constexpr int kCellBits = 4;  // runs are of cubes of 16^3 voxels
  struct Cell {
    std::uint64_t key = 0;
    std::uint32_t first = 0, last = 0;
  };
  static std::uint64_t cell_key(int x, int y, int z) {
    return static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << 20 |
           static_cast<std::uint64_t>(z) << 40;
  }
  void lay_out();
  void find_space(std::span<const VoxelKey> all, const std::optional<Eigen::Vector3d>& inside);
  std::size_t place_of(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  }

  std::shared_ptr<const MeshScene> scene_;
  VoxelGrid grid_;
  Eigen::AlignedBox3d region_;
  int low_[3] = {}, size_[3] = {};  // voxels
  std::vector<bool> space_;         // of that box, x fastest
  std::vector<VoxelKey> surface_;   // cell by cell
  std::unordered_map<std::uint64_t, Cell> cells_;
};

template <class Visit>
void GroundTruth::for_each_run(const VoxelBox& box, Visit visit) const {
  for (int z = box.lower.z >> kCellBits; z <= box.upper.z >> kCellBits; ++z)
    for (int y = box.lower.y >> kCellBits; y <= box.upper.y >> kCellBits; ++y)
      for (int x = box.lower.x >> kCellBits; x <= box.upper.x >> kCellBits; ++x) {
        const auto found = cells_.find(cell_key(x, y, z));
        if (found != cells_.end()) visit(found->second.first, found->second.last);
      }
}

// A mesh that stands in the open: with a floor at the level of its lowest point, ten metres beyond
// its sides, and as the region all that is above the floor, up to six metres above the mesh.
struct OpenWorld {
  TriangleMesh mesh;
  Eigen::AlignedBox3d region;
};
OpenWorld with_floor(TriangleMesh mesh);

// The voxels that the inside of a box with such an edge meets, as a box: what is taken to be free
// where an exploration starts.
Eigen::AlignedBox3d cleared_box(const VoxelGrid& grid, const Eigen::Vector3d& middle, double edge);

// Holds every voxel that an image from there can measure in a map of that maximum range: the box
// of the camera's pyramid, cut where the range ends.
VoxelBox reach_box(const VoxelGrid& grid, const Viewpoint& view, const Pinhole& pinhole,
                   double range);

// How much of the surface a map has observed: ObsSurf of (5.2), and what images would add (5.3).
// Images are true ones, of the map's own update rule: a voxel counts when it is hit or passed
// (reading 5.1). `gain` is thread-safe; what an image sees is worked out once for each viewpoint.
class ObservedSurface final : public TrueGain {
 public:
  using NewMap = std::function<std::unique_ptr<Map>()>;

  // `new_map` makes empty maps as the exploration's own; the truth outlives this object.
  ObservedSurface(const GroundTruth& truth, const ViewSensor& sensor, NewMap new_map);

  // After the map has taken an image from there.
  void update(const Map& map, const Viewpoint& view);

  double observed() const { return observed_; }  // ObsSurf
  double gain(const Viewpoint& view) const override;
  // The parts of that sum: calls `visit(middle of a voxel, its part)`, m, world. Thread-safe.
  void each_gain(const Viewpoint& view,
                 const std::function<void(const Eigen::Vector3d& p_W, double gain)>& visit) const;

 private:
  using Sight = std::vector<std::uint32_t>;  // places in the surface
  std::shared_ptr<const Sight> sight_of(const Viewpoint& view) const;
  Sight look(const Viewpoint& view) const;

  const GroundTruth* truth_;
  ViewSensor sensor_;
  NewMap new_map_;
  std::vector<std::uint16_t> counts_;  // observations of each voxel of the surface
  std::vector<double> certainty_;      // 1 - M^u after so many observations
  double eta_ = 0;
  double observed_ = 0;
  mutable std::mutex mutex_;
  mutable ViewpointIndex index_;
  mutable std::vector<std::shared_ptr<const Sight>> sights_;  // by place in the index
};

// No place to begin at, or none that could be left, where smaller moves may find one.
class StartError : public InputError {
 public:
  using InputError::InputError;
};

// A viewpoint for an exploration to begin at: where the cleared box is truly free, in the space,
// the region and the bounds, with a surface within `reach` metres. InputError for bounds that have
// nothing of the region, and after 100,000 failed draws, saying what was in the way; StartError
// where it was the cleared box.
Viewpoint random_start(const GroundTruth& truth, double clear, double reach, double pitch,
                       Random& random,
                       const std::optional<Eigen::AlignedBox3d>& bounds = std::nullopt);

}  // namespace lapwing
