// SPDX-License-Identifier: Apache-2.0
// A plan as waypoints that are joined by straight lines: as few as hold a tolerance.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/trajectory/plan.h"

namespace lapwing {

struct WaypointTolerance {
  double across = 0.25;    // m, of the lines from the path
  double time = 1;         // s, of a flight at even speed on each line
  double angle = 0.08727;  // rad, of the camera, or without a gimbal of the heading, on each line
};

// The end of a line, and what holds on the line that ends there.
struct PlannedWaypoint {
  double time = 0;                                     // s of the plan
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  double speed = 0;                         // m/s; 0 of the first, and of a rest where it is
  double hold = 0;                          // s of rest at this end
  double radius = 0;                        // m, within which its corner may be cut
  double yaw = 0;                           // rad, of the vehicle
  double camera_yaw = 0, camera_pitch = 0;  // rad, world, of the middle of what the camera does
  int subject = -1;         // whom the camera follows by itself, in the plan's list; -1: nobody
  bool photograph = false;  // taken at this end

  bool rests() const { return speed == 0; }
};

// The fewest waypoints among places of the path 0.02 s to 0.1 s apart, with lines of at most 400 of
// them. A place where the flight rests for more than half a second is a waypoint twice. Views of a
// scan, and the times at which the camera goes from one subject to another, are waypoints. A
// subject is followed where it stands still and the plan's camera is on it to within the angle.
// Waypoints are moved where lines between them would be nearer to obstacles and subjects than the
// plan keeps, as far as their shapes are open. Throws InputError beginning with `format` for a plan
// without two samples.
std::vector<PlannedWaypoint> fewest_waypoints(const Plan& plan, const WaypointTolerance& tolerance,
                                              const std::string& format);

// Places in a list of the ends of the fewest lines: from each i to a j > i for which
// `holds(i, j)`, at most `most` further; from 0 to count - 1, where every step of one holds.
// `hopeless(i, j)` ends the search from i. For tests.
std::vector<std::size_t> fewest_steps(
    std::size_t count, std::size_t most, const std::function<bool(std::size_t, std::size_t)>& holds,
    const std::function<bool(std::size_t, std::size_t)>& hopeless);

}  // namespace lapwing
