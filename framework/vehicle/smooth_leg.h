// SPDX-License-Identifier: Apache-2.0
// How long a leg takes that is flown smoothly, from rest to rest: past its corners, not from stop
// to stop as pursuit.h does it. A trajectory solver finds the flight itself.
#pragma once

#include "framework/trajectory/polyline.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// What a vehicle can do along a path, a share of it. Half of the thrust above hovering is left for
// what goes across.
MotionLimits motion_limits(const Vehicle& vehicle, double share = 1);

// The tighter of both.
MotionLimits within(MotionLimits limits, const PathLimits& others);

struct SmoothLegSettings {
  double speed = 3;         // m/s, at most
  double acceleration = 2;  // m/s^2, at most
  double stray = 0.1;       // m, that the flight may leave the straight lines at corners
};

// Seconds that a leg of this way needs, while the heading turns by `turn` and the camera by `tilt`,
// rad: what the limits allow along the rounded way, and a third more, in which the acceleration
// rises and falls. The way may have no length.
double smooth_leg_seconds(const Points& way, double turn, double tilt, const Vehicle& vehicle,
                          const SmoothLegSettings& settings);

}  // namespace lapwing
