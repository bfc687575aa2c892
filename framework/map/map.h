// SPDX-License-Identifier: Apache-2.0
// What is known of a space: which voxels are free, occupied or unknown. The plugin kind `map`.
//
// Thesis 2.2, 5.4.1, 5.4.3; readings 2.2, 2.3, 4.0, 5.1, 5.4 in this room's README. World frame,
// metres. Every backend gives the same answers, bit for bit, to everything but `bytes`. Const calls
// are thread-safe while nobody changes the map; all others want it alone.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/geometry/depth_image.h"
#include "framework/map/map_settings.h"
#include "framework/map/voxel.h"

namespace lapwing {

// What a map knows of one voxel.
struct VoxelReading {
  bool known = false;  // measured or imported at least once
  VoxelState state = VoxelState::unknown;
  float log_odds = 0;              // 0, as likely as not, where it is not known
  std::uint16_t observations = 0;  // 65535: that many or more; 0 unless the map counts them
};

struct MapRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      // m, inside the largest map
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit vector
  double range = 0;                                      // m; voxels that begin there are not met
};

// The first voxel on a ray that is not free.
struct MapRayHit {
  VoxelKey voxel;                       // where there is none, 0
  VoxelState state = VoxelState::free;  // free: nothing within range
  float distance = 0;  // m to its face, 0 from within; the range where there is none
};

// The mean over the voxels of a cube, unknown ones with occupancy 0.5 and uncertainty 1.
struct MeanReading {
  float occupancy = 0.5f;
  float uncertainty = 1;
};

struct VoxelCounts {
  std::uint64_t known = 0, free = 0, occupied = 0;  // known: free, occupied or in between
};

class Map : public PluginObject {
 public:
  using Interface = Map;
  static constexpr const char* kKind = "map";

  explicit Map(const MapSettings& settings) : settings_(settings), grid_(settings.resolution) {}
  virtual ~Map() = default;

  const MapSettings& settings() const { return settings_; }
  const VoxelGrid& grid() const { return grid_; }
  // Threads that `integrate` and batches may use, at least 1 (the default). Results are the same.
  void set_threads(int threads) { threads_ = std::max(threads, 1); }
  int threads() const { return threads_; }

  // One scan: rays from `origin_W` to points in the world. Each voxel is updated at most once,
  // and a point in it counts more than rays through it (reading 2.3). InputError, and nothing
  // changed: a point that is not finite or lies outside the largest map; the memory limit reached.
  void integrate(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W);
  // One image, see scan.h. InputError also for an image whose size is not its pinhole's, a pose
  // that is none, and pixels without a hit in a map without a maximum range.
  void integrate(const PosedDepthImage& measured);

  // Sets voxels to what the leaves say; log odds beyond the clamps become the clamps. For voxels
  // in several leaves the last one counts. InputError, and nothing changed: a leaf with NaN, with
  // a level above 16 or a key that is no multiple of its size; the memory limit reached.
  void import(std::span<const VoxelLeaf> leaves);

  virtual VoxelReading read(const VoxelKey& key) const = 0;
  // Of every key in turn.
  virtual void read_states(std::span<const VoxelKey> keys, std::span<VoxelState> states) const;
  // M^u of (5.1) after so many observations: exp(-eta n).
  double uncertainty(std::uint16_t observations) const;

  // `hits` has as many places as there are rays. InputError naming the ray that starts outside
  // the largest map, whose direction is no unit vector or whose range is not positive and finite.
  // What is outside the largest map is unknown: the voxel is then the last one inside.
  // Of a view, in the order of `tiled_pixel_rays`, it is quickest.
  void cast(std::span<const MapRay> rays, std::span<MapRayHit> hits) const;

  // Whether every voxel that the inside of the box meets is free; unknown ones block, and so does
  // what is outside the largest map. Touching is free, to a millionth of a voxel; a flat box is in
  // the voxel that holds it. InputError for numbers that are not finite or lower > upper.
  bool box_free(const Eigen::Vector3d& lower_W, const Eigen::Vector3d& upper_W) const;
  // The same for a box with half edges `half` whose middle moves straight from `from` to `to`.
  bool swept_box_free(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W,
                      const Eigen::Vector3d& half) const;

  // Means over the aligned cubes of (2^level)^3 voxels that hold the keys; level 0 to 10. Equal
  // among backends to 1e-5.
  void read_means(int level, std::span<const VoxelKey> keys, std::span<MeanReading> means) const;

  // Every known voxel once, in cubes of any size. The order is the backend's own, but the same for
  // the same history.
  virtual void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const = 0;
  // The smallest box of voxels that holds all known ones.
  virtual std::optional<VoxelBox> bounds() const = 0;
  // At full resolution.
  virtual VoxelCounts counts() const = 0;
  // What the map takes, with what it keeps for the next scan.
  virtual std::size_t bytes() const = 0;

 protected:
  virtual void insert(std::span<const Eigen::Vector3f> points_W,
                      const Eigen::Vector3f& origin_W) = 0;
  // Log odds already within the clamps.
  virtual void assign(std::span<const VoxelLeaf> leaves) = 0;
  // Called from several threads at once, each with rays of its own.
  virtual void cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const = 0;
  virtual void means_checked(int level, std::span<const VoxelKey> keys,
                             std::span<MeanReading> means) const = 0;
  // A box inside the largest map.
  virtual bool sweep_checked(const class SweptBox& box) const = 0;
  // For `assign` and `insert` before they change anything.
  void require_memory(std::size_t bytes) const;

 private:
  MapSettings settings_;
  VoxelGrid grid_;
  int threads_ = 1;
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace lapwing
