// SPDX-License-Identifier: Apache-2.0
// Paths made of straight pieces: their distances, their smoothing, and how fast they can be flown.
// World frame, metres.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace lapwing {

using Points = std::vector<Eigen::Vector3d>;

double length_of(const Points& path);

// From a point to the nearest place on any of the paths; infinite where there is none. A path of
// one point is a point.
double distance_to(const std::vector<Points>& paths, const Eigen::Vector3d& p);

// Points `spacing` apart or a little less, corners not kept, both ends kept. At least two points
// and a length.
Points resampled(const Points& path, double spacing);

// Every point replaced by the mean of those within three `radius`, weighted by a Gaussian of that
// standard deviation along the path; both ends stay. For points evenly spaced.
Points rounded(const Points& path, double radius);

struct PathLimits {
  double speed = 1;         // m/s
  double acceleration = 1;  // m/s^2, along and across together
};

// What a vehicle can do along a path, m/s and m/s^2: across in every direction, up and down.
struct MotionLimits {
  double speed_across = 1, climb_speed = 1, descent_speed = 1;
  double acceleration_across = 1, acceleration_up = 1, acceleration_down = 1;
};

// The times at which the points are passed, from rest to rest, as fast as the limits allow: at
// every point the speed that its curvature leaves, lowered by a pass forwards and one backwards
// (Bobrow, Dubowsky, Gibson, Int. J. Robot. Res. 4(3), 1985, for this pair of limits). Points
// evenly spaced; the first time is 0.
std::vector<double> fastest_times(const Points& path, const PathLimits& limits);
// The same within the limits of each direction: at every point the acceleration along the path is
// what the bend, flown at that speed, leaves of them.
std::vector<double> fastest_times(const Points& path, const MotionLimits& limits);

}  // namespace lapwing
