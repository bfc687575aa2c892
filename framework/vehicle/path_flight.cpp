// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/path_flight.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/vehicle/pursuit.h"

namespace lapwing {

namespace {

constexpr double kApart = 1e-6;      // m, of places that are two
constexpr double kLeastSpeed = 0.1;  // m/s
constexpr double kGentle = 0.5;      // share of the vehicle's acceleration
constexpr double kStrongest = 2;     // m/s^2

}  // namespace

Trajectory flight_along(const Trajectory& path, const Vehicle& vehicle) {
  if (!vehicle.has_rotors)
    throw InputError({}, "vehicle '" + vehicle.name +
                             "' states no rotors: there is no simulated vehicle to fly this plan "
                             "with. A vehicle file with inertia and rotors has one");
  Points points;
  std::vector<PursuitView> views;
  std::vector<double> pitches;
  double quickest = 0, pause = 0;
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    const Sample& s = path.samples[i];
    if (points.empty() || (s.position - points.back()).norm() > kApart) {
      if (i > 0) {
        const Sample& before = path.samples[i - 1];
        quickest = std::max(
            quickest, (s.position - before.position).norm() / std::max(1e-3, s.time - before.time));
      }
      views.push_back({points.size(), s.yaw, 0});
      points.push_back(s.position);
      pitches.push_back(s.gimbal_pitch);
    } else {
      // Turned on the spot: the last heading there counts.
      pause = std::max(pause, s.time - path.samples[i - 1].time);
      views.back().yaw = s.yaw;
      pitches.back() = s.gimbal_pitch;
    }
  }
  if (points.size() < 2) throw InputError({}, "the path has no length: there is nothing to fly");
  PursuitSettings settings;
  settings.speed = std::clamp(quickest, kLeastSpeed, vehicle.speed_across_max);
  settings.view_speed = std::min(settings.view_speed, settings.speed);
  settings.acceleration = std::min(kStrongest, kGentle * vehicle.acceleration_across_max);
  settings.lookahead = std::max(settings.lookahead, 4 * settings.step * settings.speed);
  settings.pause = std::min(pause, 3600.0);
  Pursuit pursuit = pursue(points, views, vehicle, settings);
  Trajectory& flight = pursuit.trajectory;
  flight.has_gimbal = path.has_gimbal;
  if (flight.has_gimbal) {
    std::size_t view = 0;
    for (Sample& s : flight.samples) {
      while (view + 1 < views.size() && s.time > pursuit.views[view].departure) ++view;
      s.gimbal_pitch = pitches[view];
    }
  }
  return flight;
}

}  // namespace lapwing
