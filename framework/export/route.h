// SPDX-License-Identifier: Apache-2.0
// A plan as a route of a consumer drone: places apart from each other, with heading and pitch that
// go evenly from one to the next, stops, and images at stops.
#pragma once

#include <string>
#include <vector>

#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/export/waypoint_flight.h"
#include "framework/export/waypoints.h"

namespace lapwing {

struct RouteImage {
  double yaw = 0, pitch = 0;  // rad, world, of the camera
};

struct RoutePoint {
  PlannedWaypoint at;         // speed on the way to it, hold, radius
  double yaw = 0, pitch = 0;  // rad, world, of the camera here
  std::vector<RouteImage> images;
};

struct RouteOptions {
  WaypointTolerance tolerance;
  std::size_t most = 99;         // points of a file
  std::optional<double> home_z;  // m, world, of the take-off place
  int part = 0;                  // counts from 1; 0: the plan must fit into one file
};
// `most`: the default of the parameter `most_points`.
ParameterTable route_parameters(std::int64_t most);
RouteOptions route_options(const Parameters& given);

struct PlannedRoute {
  std::vector<RoutePoint> points;
  EarthPoint home;               // the plan's, or below the first point
  double home_z = 0;             // m, world
  double start = 0, finish = 0;  // s of the plan
  int part = 1, parts = 1;
  std::vector<std::string> said;  // for the user

  // Above the take-off place, m.
  double height(const EarthPoint& point) const { return point.height - home.height; }
};

// No faster than 15 m/s, no two points nearer than 0.5 m: what lies between is a stop. Throws
// InputError beginning with `format`: no origin, no camera, no length, too many points (it says
// how many parts there are), heights beyond `lowest` and `highest` (m above the take-off place), a
// first point that is not above that place, points below the ground of the origin.
PlannedRoute route_of(const Plan& plan, const RouteOptions& options, const std::string& format,
                      double lowest, double highest);

// The flight of points that were read from a file: the speed of each is that of the way to it, yaw
// and pitch are those at it. `images`: of each point, further ones after turns on the spot.
struct ReadRoute {
  std::vector<FlownPoint> points;
  std::vector<std::vector<RouteImage>> images;
};
// InputError where the radii at both ends of a line are more than the line together.
FlownFile fly_route(const ReadRoute& route, const Plan& plan);

// Degrees clockwise from north in [0, 360).
double compass_deg(double yaw);

}  // namespace lapwing
