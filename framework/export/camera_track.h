// SPDX-License-Identifier: Apache-2.0
// The camera of a plan, for formats that play it back: frames at an even rate, its optics, and how
// far what a format plays back is from the plan.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/geometry/camera_view.h"
#include "framework/geometry/pose.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// Whether the plan's own certificate states that it passed. `lapwing export` puts in the verdict
// that it made itself.
bool states_certified(const Plan& plan);

// Times of frames in s, from the first sample on, 1 / rate apart; the last is at or before the last
// sample. `rate` in frames/s. Throws InputError beginning with `format` for a plan without samples,
// and for more than two million frames.
std::vector<double> frame_times(const Trajectory& trajectory, double rate,
                                const std::string& format);

// The pinhole of the camera that films: that of a scan's images, else the vehicle's. Throws
// InputError beginning with `format` where no gimbal turns a camera, which is so for races.
Pinhole filming_camera(const Plan& plan, const std::string& format);

// The camera of the plan at a time in s, as of a pose: x right, y down, z forward.
Pose filming_pose(const Plan& plan, double time);

// The pose, in the world of the plan, of a camera that a format places in a world with y up (x
// east, z south), where cameras look along their -z axis.
Pose from_y_up(const Eigen::Vector3d& place, const Eigen::Quaterniond& turn);

// How far a playback is from the plan, at most, and when.
struct TrackDeviation {
  double distance = 0, distance_time = 0;  // m, s
  double angle = 0, angle_time = 0;        // rad, whole turn between both orientations; s
};

// Compares at `steps` even steps over [start, finish], both included; `played` gives the pose of
// the camera that the format shows at a time of the plan.
TrackDeviation deviation_of(const Plan& plan, double start, double finish, int steps,
                            const std::function<Pose(double)>& played);

// "played back, the camera is at most 0.3 mm (at 1.2 s) and 0.01 deg (at 3 s) from the plan"
std::string sentence_of(const TrackDeviation& deviation);

}  // namespace lapwing
