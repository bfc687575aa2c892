// SPDX-License-Identifier: Apache-2.0
// The least distance between drones that fly at the same time.
//
// Internal to this room. World frame, metres.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "framework/verify/motion.h"

namespace lapwing {

// A tour on the clock of its fleet: straight from point to point, to within `bulge`.
struct TimedPath {
  std::string drone;
  std::vector<double> times;            // s, increasing
  std::vector<Eigen::Vector3d> places;  // as many
  double bulge = 0;                     // m, farthest that the motion leaves that line at any time
  double step = 0;                      // m, longest between two neighbouring places
  double climb = 0;                     // s before and after it, on the line below its ends

  double first() const { return times.front() - climb; }
  double last() const { return times.back() + climb; }
};

// Of a motion that begins at `start` on the clock of the fleet.
TimedPath timed_path(Motion& motion, std::string drone, double start, double climb);

struct Approach {
  double distance = 0;  // m; never overestimated
  double time = 0;      // s, on the clock of the fleet
};
// Infinite where the two never fly, climb or land at the same time.
Approach nearest_approach(const TimedPath& a, const TimedPath& b);

}  // namespace lapwing
