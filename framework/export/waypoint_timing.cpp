// SPDX-License-Identifier: Apache-2.0
#include "framework/export/waypoint_timing.h"

#include <algorithm>
#include <cmath>

#include "framework/export/waypoint_flight.h"

namespace lapwing {
namespace {

constexpr int kRounds = 20;
constexpr double kSlowest = 0.02;      // m/s
constexpr double kLeastRadius = 0.05;  // m
constexpr double kCurveShare = 0.49;   // of a line, that a curve may take
// Of a limit: places are rounded in files, which turns short lines a little.
constexpr double kShare = 0.99;

void set_radii(std::vector<PlannedWaypoint>& waypoints, double across) {
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    waypoints[k].radius = across;
    if (k == 0 || k + 1 == waypoints.size()) continue;
    const Eigen::Vector3d in = waypoints[k].position - waypoints[k - 1].position;
    const Eigen::Vector3d out = waypoints[k + 1].position - waypoints[k].position;
    if (in.norm() < 1e-6 || out.norm() < 1e-6) continue;
    const double turn = std::acos(std::clamp(in.normalized().dot(out.normalized()), -1.0, 1.0));
    // A corner that is cut r before and behind it is r sin(turn / 2) / 2 away, or less.
    const double bend = std::max(1e-6, std::sin(turn / 4));
    waypoints[k].radius = std::clamp(0.3 * across / bend, kLeastRadius, across);
  }
}

// Two curves on one line do not meet, after places and radii are rounded to centimetres.
void part_curves(std::vector<PlannedWaypoint>& waypoints) {
  for (std::size_t k = 1; k < waypoints.size(); ++k) {
    const double line = (waypoints[k].position - waypoints[k - 1].position).norm();
    const double most = std::floor(100 * kCurveShare * line) / 100;
    for (const std::size_t end : {k - 1, k})
      waypoints[end].radius = std::min(waypoints[end].radius, most);
  }
}

double fastest(const Eigen::Vector3d& way, const Vehicle& vehicle) {
  const Eigen::Vector3d direction = way.normalized();
  const double across = direction.head<2>().norm();
  double most = INFINITY;
  if (across > 1e-6) most = vehicle.speed_across_max / across;
  if (direction.z() > 1e-6) most = std::min(most, vehicle.climb_speed_max / direction.z());
  if (direction.z() < -1e-6) most = std::min(most, vehicle.descent_speed_max / -direction.z());
  return kShare * most;
}

}  // namespace

WaypointFlight flight_along(const std::vector<PlannedWaypoint>& waypoints) {
  WaypointFlight flight;
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    const PlannedWaypoint& w = waypoints[k];
    flight.points.push_back({w.position, std::max(w.speed, kSlowest), w.hold, w.radius, w.yaw});
  }
  return flight;
}

void time_waypoints(std::vector<PlannedWaypoint>& waypoints, const Vehicle& vehicle, double across,
                    bool curves) {
  set_radii(waypoints, across);
  if (curves) part_curves(waypoints);
  for (std::size_t k = 1; k < waypoints.size(); ++k)
    if (!waypoints[k].rests())
      waypoints[k].speed = std::min(
          waypoints[k].speed, fastest(waypoints[k].position - waypoints[k - 1].position, vehicle));
  std::vector<double> planned;
  for (const PlannedWaypoint& w : waypoints) planned.push_back(w.speed);
  for (int round = 0; round < kRounds; ++round) {
    const WaypointFlight flight = flight_along(waypoints);
    const FlownFile flown = fly_waypoints(flight, vehicle, false);
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
      PlannedWaypoint& w = waypoints[k];
      const double begun = flown.reached[k - 1] + flight.points[k - 1].hold;
      const double taken = flown.reached[k] - begun;
      if (w.rests() || taken < 1e-9) continue;
      // A flight that is late, or early, makes up for it on the lines that follow.
      // Holds that were rounded up may leave it no time.
      const double line = std::max(1e-3, w.time - waypoints[k - 1].time - w.hold);
      const double late = begun - (waypoints[k - 1].time - waypoints[0].time);
      const double wanted = std::clamp(line - late / 2, 0.6 * line, 1.5 * line);
      w.speed = std::clamp(w.speed * std::sqrt(taken / wanted), std::max(kSlowest, planned[k] / 2),
                           std::max(kSlowest, 2 * planned[k]));
      w.speed = std::min(w.speed, fastest(w.position - waypoints[k - 1].position, vehicle));
    }
  }
}

}  // namespace lapwing
