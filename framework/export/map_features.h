// SPDX-License-Identifier: Apache-2.0
// What a plan has beside its path that maps and planning programs draw: named points and zones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/trajectory/plan.h"

namespace lapwing {

struct MapPoint {
  std::string kind;  // keyframe, gate, view, subject, home, rally_point
  std::string name;  // its own, or kind and number
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  std::optional<double> time;                          // s, when the flight is there
  std::optional<double> yaw, pitch;                    // rad, of the camera of a view
};

// Keyframes, gates, views, subjects (where they begin), home and rally points, in the order of the
// plan.
std::vector<MapPoint> map_points(const Plan& plan);

// A prism over a polygon: closed to flight, or not to be left.
struct MapZone {
  std::string name;
  bool keep_inside = false;
  std::vector<Eigen::Vector2d> corners;  // m, world, counter-clockwise
  std::optional<double> floor, ceiling;  // m, world
};

// Those that stand still. Obstacles of other types have no outline on the ground.
std::vector<MapZone> map_zones(const Plan& plan);

// The name of the mission, with " (not certified)" after it where the plan is not.
std::string stated_name(const Plan& plan);

}  // namespace lapwing
