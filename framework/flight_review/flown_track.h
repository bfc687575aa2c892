// SPDX-License-Identifier: Apache-2.0
// The flight of a log as a trajectory in the world and on the clock of its plan.
#pragma once

#include <string>
#include <vector>

#include "framework/flight_review/flight_alignment.h"

namespace lapwing {

// A pose as the log states it, unfiltered.
struct FlownPose {
  double time = 0;                                     // s of the plan
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world of the plan
  std::optional<double> yaw;                           // rad
  std::optional<Eigen::Vector2d> camera;               // yaw and pitch in the world, rad
};

struct FlownTrack {
  std::vector<FlownPose> poses;  // within the part that is compared
  // The same, smooth: the motion `velocity`, from 0 on, `start` s of the plan being its time 0.
  Trajectory trajectory;
  double start = 0, finish = 0;  // s of the plan
  double smoothing = 0;          // m, root of the mean square that the curve leaves out
  double longest_gap = 0;        // s, between two positions; the curve bridges it
  bool yaw_known = false, camera_known = false;
  std::vector<double> photographs;  // s of the plan
};

// Where the log does not hold the yaw or the camera, the trajectory has those of the plan. Throws
// InputError where fewer than four positions lie within the plan.
FlownTrack flown_track(const Plan& plan, const FlightLog& log, const FlownSeries& series,
                       const FlightAlignment& alignment);

}  // namespace lapwing
