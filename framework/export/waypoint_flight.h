// SPDX-License-Identifier: Apache-2.0
// A flight from waypoint to waypoint, as an autopilot makes it of the orders in a file.
//
// A model of what PX4 and ArduPilot document, and of no version of either: straight lines at the
// ordered speed, reached and left at 3 m/s^2 at most, or what the vehicle has; corners cut within
// the radius of acceptance, as fast as the same acceleration across allows; the heading of a line
// sought as fast as the vehicle turns; the gimbal likewise.
#pragma once

#include <optional>
#include <vector>

#include "framework/export/exporter.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// A waypoint, and what is ordered for the way to it.
struct FlownPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  double speed = 0;                                    // m/s
  double hold = 0;                                     // s of rest there
  double radius = 0;          // m, within which it counts as reached; 0: it is flown over
  std::optional<double> yaw;  // rad; absent: along the way
  double pitch = 0;           // rad, of the gimbal, where they are joined evenly
};

// An order to the camera, carried out when a point is reached and the time to hold there is over;
// at the first one it holds already.
struct CameraOrder {
  std::size_t point = 0;
  std::optional<double> pitch, yaw;  // rad; yaw in the world, or from the nose
  bool yaw_in_world = false;
  std::optional<Eigen::Vector3d> target;  // m, world: the camera, and the nose, turn to it
};

struct WaypointFlight {
  std::vector<FlownPoint> points;
  std::vector<CameraOrder> orders;       // in the order of their points
  std::vector<std::size_t> photographs;  // points at which one is taken
  // Yaw and pitch go evenly along each line from those of its start to those of its end.
  bool evenly = false;
};

// From rest at the first point to rest at the last one. InputError for fewer than two points.
FlownFile fly_waypoints(const WaypointFlight& flight, const Vehicle& vehicle, bool has_gimbal);

}  // namespace lapwing
