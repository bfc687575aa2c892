// SPDX-License-Identifier: Apache-2.0
// Flying along straight lines by pure pursuit (thesis 4.7; reading 4.6): after a point that runs
// ahead on the path, fast on the way and slowly where images are taken.
//
// The result is a trajectory of the motion model `force`, from rest to rest: the reference that the
// controller follows (`fly` in closed_loop.h flies it by the whole quadrotor), and as good a plan
// as any for the verifier. As set here, right angles are missed by less than a metre; views, which
// stop the running point until they are reached, are not. World frame, SI.
#pragma once

#include <span>
#include <vector>

#include "framework/trajectory/polyline.h"
#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct PursuitSettings {
  double speed = 3;         // m/s, on the way
  double view_speed = 0.5;  // m/s, nearer than `slow_within` to the next view
  double slow_within = 3;   // m
  double lookahead = 2;     // m, by which the point that is pursued runs ahead
  double acceleration = 2;  // m/s^2, the most that is asked for
  bool stop = true;         // at every view, until the vehicle rests in it; else it is flown by
  double pause = 0;         // s, at rest in a view, for the image; with `stop`
  double step = 0.05;       // s, between samples
};

// An image is taken at this point of the path, with this heading.
struct PursuitView {
  std::size_t point = 0;  // which; rising from view to view
  double yaw = 0;         // rad, 0 along +x
  double least = 0;       // s, that the way from the view before takes at least: a camera turns
};

struct ViewPassed {
  double arrival = 0, departure = 0;  // s; equal where it is flown by
  double miss = 0;                    // m, the nearest that the vehicle comes
};

struct Pursuit {
  Trajectory trajectory;
  std::vector<ViewPassed> views;
};

// Between two views at one place the vehicle turns on the spot. InputError: fewer than two points,
// a path without length where it does not turn from one view to another, numbers that are not
// finite, views out of order, settings that are not positive, speeds and accelerations beyond the
// vehicle's, a lookahead shorter than three steps at full speed.
Pursuit pursue(const Points& path, std::span<const PursuitView> views, const Vehicle& vehicle,
               const PursuitSettings& settings = {});

}  // namespace lapwing
