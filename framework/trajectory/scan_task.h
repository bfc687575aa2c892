// SPDX-License-Identifier: Apache-2.0
// What a scan is to photograph: a region of interest, and the views that are taken of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "framework/geometry/camera_view.h"
#include "framework/geometry/interest_region.h"

namespace lapwing {

// Planned for what it shows, or there only so that the images before and after it can be matched
// (thesis 4.3, fig. 4.3).
enum class ViewKind { planned, matching };

// An image: the flight is there at that time, and its camera looks that way, level.
struct PlannedView {
  double time = 0;                                     // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  double yaw = 0;                                      // rad
  double pitch = 0;                                    // rad, positive up
  ViewKind kind = ViewKind::planned;
};

struct ScanTask {
  InterestRegion region;            // of interest, world
  Pinhole camera;                   // of the images
  double range = 60;                // m, of a ray through a pixel; beyond it nothing counts as seen
  std::string map;                  // in which the views see: a name of the environment's maps
  std::int64_t seen = 0;            // voxels of the region that all views together see in it
  double seen_share = 0.95;         // of them that must be seen again when the views are cast anew
  double tolerance = 0.3;           // m, how far from a view its image may be taken
  double angle_tolerance = 0.0524;  // rad, between the directions of view
  std::vector<PlannedView> views;   // in the order of their times
};

}  // namespace lapwing
