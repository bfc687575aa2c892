// SPDX-License-Identifier: Apache-2.0
// Which voxels a viewpoint sees in a map, and how (thesis 4.4.4).
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "framework/geometry/interest_region.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/map/map.h"
#include "framework/map/region_voxels.h"
#include "framework/view/view_information.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

struct SightSettings {
  Pinhole pinhole{600, 450, 345, 345, 299.5, 224.5};  // thesis 4.4.4
  double range = 60;                                  // m, of the rays (reading 4.11)
  // Only voxels with their centre inside count (reading 4.1).
  InterestRegion region;
  // m, world: of those only the ones in this box, if it is set. A part of a large region.
  std::optional<Eigen::AlignedBox3d> within = std::nullopt;
  // m: where camera to surface and camera to voxel differ by as much or more, the surface that the
  // ray meets is not the voxel's, and its normal is not known (reading 4.3).
  double normal_tolerance = 0.5;
  // Pixels a row of the smaller image that rays are cast through; 0: every pixel of the camera.
  int across = 0;
  // m and rad: what an image shows from farther away, or at a known larger angle of incidence, is
  // of no use to a model, and is not seen. Matching (4.8) looks as far as `range`.
  double usable_range = std::numeric_limits<double>::infinity();
  double usable_incidence = 1.5707963267948966;
};

struct SeenVoxel {
  VoxelKey voxel;
  VoxelSight sight;
};

// Asks the map for the first voxel that is not free on a ray through every pixel, and the prior
// surface, which may be missing, for the normal on the way to each voxel's centre. Both are kept,
// and nobody may change them meanwhile. Thread-safe.
class VisibleVoxels {
 public:
  // InputError for a box `within` beside the region, a camera without pixels or focal length,
  // ranges or an angle that are not above 0, what RegionVoxels refuses, or a range that reaches out
  // of the largest map from the region.
  VisibleVoxels(std::shared_ptr<const Map> map, std::shared_ptr<const MeshScene> prior,
                SightSettings settings);

  const SightSettings& settings() const { return settings_; }
  const Map& map() const { return *map_; }
  const std::shared_ptr<const Map>& shared_map() const { return map_; }
  const std::shared_ptr<const MeshScene>& prior() const { return prior_; }
  // What a voxel counts; 0 outside the region.
  double weight(const VoxelKey& voxel) const { return counts(voxel) ? region_->weight(voxel) : 0; }

  // In the order of keys, each once: occupied and unknown voxels of the region that are usable.
  std::vector<SeenVoxel> seen_from(const Viewpoint& viewpoint) const;
  // The same of one voxel; nothing where `seen_from` does not list it. Much quicker.
  std::optional<VoxelSight> sight_of(const Viewpoint& viewpoint, const VoxelKey& voxel) const;
  // The keys of all that the rays meet, usable or not.
  std::vector<VoxelKey> voxels_from(const Viewpoint& viewpoint) const;
  // The keys alone, with a smaller image of the same view: `across` pixels wide.
  std::vector<VoxelKey> seen_coarsely_from(const Viewpoint& viewpoint, int across) const;

 private:
  // m; 0 where a ray misses the region. What lies beyond does not count and need not be looked at.
  double leaves_region_after(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double range) const;
  // m, of the rays of what is seen.
  double sight_range() const;
  // How a voxel that a ray meets is seen; nothing where that is of no use.
  std::optional<VoxelSight> usable_sight(const Viewpoint& viewpoint, const VoxelKey& key) const;
  std::vector<VoxelKey> keys_from(const Viewpoint& viewpoint,
                                  std::span<const Eigen::Vector3d> directions_C,
                                  double range) const;

  std::shared_ptr<const Map> map_;
  std::shared_ptr<const MeshScene> prior_;
  SightSettings settings_;
  bool counts(const VoxelKey& voxel) const {
    return region_->contains(voxel) && (!within_ || within_->contains(voxel));
  }

  std::optional<RegionVoxels> region_;  // always there once constructed
  std::optional<VoxelBox> within_;
  Eigen::AlignedBox3d reach_;          // around it
  std::vector<Eigen::Vector3d> rays_;  // unit vectors of the camera, tile by tile
};

// Whether two views can be matched: they share at least `alpha` of the mean of what they see (4.8).
// Two views that see nothing are not. Both lists in order, each key once.
bool matchable(const std::vector<VoxelKey>& a, const std::vector<VoxelKey>& b, double alpha);

}  // namespace lapwing
