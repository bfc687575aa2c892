// SPDX-License-Identifier: Apache-2.0
// What images see in the map of a plan: from where they are planned, and from where a simulated
// flight takes them.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>

#include "framework/geometry/depth_camera.h"
#include "framework/map/map_file.h"
#include "framework/plugin/registry.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {

inline std::shared_ptr<const Map> map_in(const std::filesystem::path& file) {
  static const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  const MapFile read = read_map_file(file);
  Value given = Value::map();
  given.set("resolution", read.resolution);
  std::shared_ptr<Map> map = registry.create<Map>("brick", given, "map");
  map->import(read.leaves);
  return map;
}

// Metres along a ray from a point to the face at which it leaves the point's voxel.
inline double way_out(const VoxelGrid& grid, const Eigen::Vector3d& from,
                      const Eigen::Vector3d& way) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (way(i) == 0) continue;
    const double face = grid.face(grid.index(from(i)) + (way(i) > 0 ? 1 : 0));
    least = std::min(least, (face - from(i)) / way(i));
  }
  return std::max(least, 0.0);
}

// What one view sees in a map: along the rays of every `stride`-th pixel, from voxel to voxel.
inline void see(const Map& map, const ScanTask& scan, const Eigen::Vector3d& position, double yaw,
                double pitch, std::set<VoxelKey>& seen, int stride = 1) {
  constexpr double kPastFace = 1e-9;  // m
  const Pose pose = camera_pose(position, yaw, pitch);
  for (int y = 0; y < scan.camera.height; y += stride)
    for (int x = 0; x < scan.camera.width; x += stride) {
      const Eigen::Vector3d way = (pose.orientation * pixel_ray(scan.camera, x, y)).normalized();
      for (double along = 0; along < scan.range;) {
        const Eigen::Vector3d p = position + along * way;
        const VoxelKey key = map.grid().key(p);
        if (map.read(key).state != VoxelState::free) {
          if (scan.region.contains(map.grid().center(key))) seen.insert(key);
          break;
        }
        along += way_out(map.grid(), p, way) + kPastFace;
      }
    }
}

// What all images of a plan see, added to both sets. Whether the flight was finished.
inline bool see_planned_and_flown(const Plan& plan, const Map& map, std::set<VoxelKey>& planned,
                                  std::set<VoxelKey>& flown, int stride = 1) {
  const FlownPath path = fly(plan.trajectory, vehicle_from_value(plan.vehicle));
  for (const PlannedView& view : plan.task.scan->views) {
    see(map, *plan.task.scan, view.position, view.yaw, view.pitch, planned, stride);
    const auto sample =
        std::lower_bound(path.samples.begin(), path.samples.end(), view.time,
                         [](const FlownSample& s, double time) { return s.time < time; });
    if (sample == path.samples.end()) return false;
    const Eigen::Vector3d ahead = sample->state.orientation * Eigen::Vector3d::UnitX();
    see(map, *plan.task.scan, sample->state.position, std::atan2(ahead.y(), ahead.x()),
        sample_at(plan.trajectory, view.time).gimbal_pitch, flown, stride);
  }
  return path.finished;
}

}  // namespace lapwing
