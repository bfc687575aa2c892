// SPDX-License-Identifier: Apache-2.0
#include "framework/export/route.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/take_off_place.h"
#include "framework/export/waypoint_timing.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr double kApart = 0.5;     // m
constexpr double kFastest = 15;    // m/s
constexpr double kSettling = 0.5;  // s, after a turn on the spot

// s of a turn of the vehicle from one image to the next.
double turn_seconds(const RouteImage& from, const RouteImage& to, double rate) {
  const double angle = std::max(std::abs(std::remainder(to.yaw - from.yaw, 2 * M_PI)),
                                std::abs(to.pitch - from.pitch));
  return kSettling + angle / std::max(0.1, rate);
}

// Waypoints apart from each other; what is between is time to hold, and images.
std::vector<RoutePoint> points_of(const Plan& plan, const std::vector<PlannedWaypoint>& waypoints) {
  std::vector<RoutePoint> points;
  const double rate = vehicle_from_value(plan.vehicle).yaw_rate_max;
  for (const PlannedWaypoint& w : waypoints) {
    const Sample s = sample_at(plan.trajectory, w.time);
    const RouteImage image{s.yaw + s.gimbal_yaw, s.gimbal_pitch};
    if (!points.empty() && (w.position - points.back().at.position).norm() < kApart) {
      RoutePoint& last = points.back();
      last.at.hold += w.time - last.at.time;
      last.at.time = w.time;
      if (!w.photograph) continue;
      if (last.images.empty()) {  // it only led here
        last.at.position = w.position;
        last.yaw = image.yaw;
        last.pitch = image.pitch;
      }
      if (!last.images.empty())  // the turn on the spot takes its own time
        last.at.hold = std::max(0.0, last.at.hold - turn_seconds(last.images.back(), image, rate));
      last.images.push_back(image);
      continue;
    }
    RoutePoint point{w, image.yaw, image.pitch, {}};
    if (w.photograph) point.images.push_back(image);
    points.push_back(point);
  }
  return points;
}

void time_points(std::vector<RoutePoint>& points, const Plan& plan, double across) {
  std::vector<PlannedWaypoint> waypoints;
  for (std::size_t k = 0; k < points.size(); ++k) {
    PlannedWaypoint w = points[k].at;
    if (k > 0) {
      const double time = w.time - points[k - 1].at.time - w.hold;
      w.speed = (w.position - points[k - 1].at.position).norm() / std::max(0.1, time);
    }
    waypoints.push_back(w);
  }
  Vehicle vehicle = vehicle_from_value(plan.vehicle);
  vehicle.speed_across_max = std::min(vehicle.speed_across_max, kFastest);
  time_waypoints(waypoints, vehicle, across, true);
  for (std::size_t k = 0; k < points.size(); ++k) points[k].at = waypoints[k];
}

// First and last point of the part that was asked for.
std::pair<std::size_t, std::size_t> part_of(std::size_t count, const RouteOptions& options,
                                            const std::string& format, PlannedRoute& route) {
  const std::size_t lines = options.most - 1;
  const std::size_t parts = (count - 1 + lines - 1) / lines;
  route.parts = static_cast<int>(parts);
  if (options.part == 0 && parts > 1)
    throw InputError(format + ": " + std::to_string(count) + " points, and a file holds " +
                     std::to_string(options.most) + ": a larger `tolerance`, or " +
                     std::to_string(parts) + " files: part=1 to part=" + std::to_string(parts));
  if (options.part > route.parts)
    throw InputError(format + ": part=" + std::to_string(options.part) + ", and the plan has " +
                     std::to_string(parts) + " parts");
  route.part = std::max(1, options.part);
  const std::size_t first = static_cast<std::size_t>(route.part - 1) * lines;
  return {first, std::min(first + lines, count - 1)};
}

// A drone climbs to its first point, and no point lies in the ground where the origin tells where
// that is. A sentence on points below the take-off place; empty where there are none.
std::string check_heights(const PlannedRoute& route, const EarthFrame& frame,
                          const std::string& format) {
  std::vector<FilePlace> places;
  for (const RoutePoint& point : route.points) places.push_back({point.at.time, point.at.position});
  const double begin = height_above(route.home, frame, places.front().position);
  if (begin <= 0)
    throw InputError(format +
                     ": the first waypoint (z = " + plain_number(places.front().position.z(), 4) +
                     " m) is " + plain_number(0 - begin, 4) +
                     " m below the take-off place (z = " + plain_number(route.home_z, 4) +
                     " m); expected one above it: a lower `home_z`, or a `home` of the mission "
                     "that is lower");
  require_above_ground(places, frame, format);
  return below_take_off(places, frame, route.home);
}

}  // namespace

ParameterTable route_parameters(std::int64_t most) {
  return ParameterTable{}
      .number("tolerance", 0.5, "m", "largest distance of the lines from the path",
              between(0.05, 10))
      .number("time_tolerance", 2, "s", "largest difference in time on a line at constant speed",
              between(0.05, 1000))
      .number("angle_tolerance", 20, "deg", "half of the largest turn of the camera on a line",
              between(0.5, 90))
      .integer("most_points", most, "points that a file may hold", between(2, 65535))
      .optional_number("home_z", "m", kHomeParameter)
      .integer("part", 0, "part of a plan that is too long for one file; 0: it must fit",
               between(0, 10000));
}

RouteOptions route_options(const Parameters& given) {
  RouteOptions options;
  options.tolerance = {given.number("tolerance"), given.number("time_tolerance"),
                       radians(given.number("angle_tolerance"))};
  options.most = static_cast<std::size_t>(given.integer("most_points"));
  if (given.has("home_z")) options.home_z = given.number("home_z");
  options.part = static_cast<int>(given.integer("part"));
  return options;
}

PlannedRoute route_of(const Plan& plan, const RouteOptions& options, const std::string& format,
                      double lowest, double highest) {
  const EarthFrame frame(plan, std::nullopt, format);
  filming_camera(plan, format);
  PlannedRoute route;
  std::vector<RoutePoint> all = points_of(plan, fewest_waypoints(plan, options.tolerance, format));
  if (all.size() < 2)
    throw InputError(format + ": the flight of '" + plan.mission +
                     "' has no length: all of it lies within 0.5 m");
  time_points(all, plan, options.tolerance.across);
  const auto [first, last] = part_of(all.size(), options, format, route);
  route.points.assign(all.begin() + static_cast<std::ptrdiff_t>(first),
                      all.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  // Time to hold and images between two parts are of the one that comes to them.
  if (route.part > 1) {
    route.points.front().images.clear();
    route.points.front().at.hold = 0;
  }
  const Eigen::Vector3d home =
      take_off_place(plan, options.home_z, route.points.front().at.position);
  route.home_z = home.z();
  route.home = frame.at(home);
  route.start =
      route.part > 1 ? route.points.front().at.time + 1e-3 : plan.trajectory.samples.front().time;
  route.finish = route.points.back().at.time;
  std::vector<EarthPoint> places;
  double least = INFINITY, most = -INFINITY;
  for (const RoutePoint& point : route.points) {
    places.push_back(frame.at(point.at.position));
    least = std::min(least, route.height(places.back()));
    most = std::max(most, route.height(places.back()));
  }
  if (least < lowest || most > highest)
    throw InputError(format + ": heights from " + plain_number(least, 4) + " m to " +
                     plain_number(most, 4) + " m above the take-off place; the format has " +
                     plain_number(lowest) + " m to " + plain_number(highest) +
                     " m; `home_z` states another take-off place");
  const std::string below = check_heights(route, frame, format);
  route.said = {frame.sentence(places),
                "heights in the file are above the take-off place, which is at z = " +
                    plain_number(route.home_z) + " m of the plan: from " + plain_number(least, 4) +
                    " m to " + plain_number(most, 4) + " m",
                "part " + std::to_string(route.part) + " of " + std::to_string(route.parts) + ", " +
                    plain_number(route.start, 5) + " s to " + plain_number(route.finish, 5) +
                    " s of the plan; the vehicle turns with the camera; take-off and landing are "
                    "the application's"};
  if (!below.empty()) route.said.push_back(below);
  return route;
}

namespace {

// A drone refuses, or cuts as it likes, curves that meet on their line.
void check_curves(const std::vector<FlownPoint>& points) {
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double line = (points[k].position - points[k - 1].position).norm();
    const double before = points[k - 1].radius, behind = points[k].radius;
    if (before + behind <= line) continue;
    throw InputError("points " + std::to_string(k) + " and " + std::to_string(k + 1) +
                     ": curves of " + plain_number(before, 3) + " m and " +
                     plain_number(behind, 3) + " m on a line of " + plain_number(line, 3) +
                     " m; expected no more than the line together");
  }
}

}  // namespace

FlownFile fly_route(const ReadRoute& route, const Plan& plan) {
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  WaypointFlight flight;
  flight.evenly = true;
  check_curves(route.points);
  for (std::size_t k = 0; k < route.points.size(); ++k) {
    flight.points.push_back(route.points[k]);
    const auto& images = route.images[k];
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (i > 0) {  // a turn on the spot
        FlownPoint turned = flight.points.back();
        turned.hold = turn_seconds({*turned.yaw, turned.pitch}, images[i], vehicle.yaw_rate_max);
        turned.yaw = images[i].yaw;
        turned.pitch = images[i].pitch;
        flight.points.push_back(turned);
      }
      flight.photographs.push_back(flight.points.size() - 1);
    }
  }
  return fly_waypoints(flight, vehicle, plan.trajectory.has_gimbal);
}

double compass_deg(double yaw) {
  const double heading = std::fmod(90 - degrees(yaw), 360);
  return heading < 0 ? heading + 360 : heading;
}

}  // namespace lapwing
