// SPDX-License-Identifier: Apache-2.0
// A plan flown by the whole quadrotor under control (thesis 3.8): how far it strays.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "framework/core/progress.h"
#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/rotor_body.h"

namespace lapwing {

struct FlightConditions {
  double wind_mean = 0;       // m/s, along `wind_yaw`
  double wind_gust = 0;       // m/s, standard deviation of each horizontal axis; half of it upwards
  double wind_yaw = 0;        // rad, where the wind blows to; 0 along +x
  double mass_error = 0;      // share by which the true mass and inertia exceed the file's
  std::uint64_t seed = 1;     // of the gusts
  double step = 0.002;        // s, of the controller and of the integration
  double sample_step = 0.02;  // s, between the kept samples
};

struct FlownSample {
  double time = 0;  // s
  BodyState state;
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();  // m, world
  double position_error = 0;                         // m
  double yaw_error = 0;                              // rad, signed
};

struct FlownPath {
  std::vector<FlownSample> samples;
  double position_error_worst = 0, position_error_at = 0;  // m, s
  double position_error_mean = 0;                          // m
  double yaw_error_worst = 0, yaw_error_at = 0;            // rad, s
  double saturated_share = 0;                              // of the time
  double rotor_speed_worst = 0;  // share of the largest rotor speed, sqrt(F / F_max)
  bool lost = false;             // strayed beyond 100 m, or turned over; what follows is not flown
};

// Flies a trajectory of the motion model `force`, from its first sample. Throws InputError for
// another model, for wind on a vehicle that states no drag, and for conditions that make no sense;
// Cancelled when told to stop. `told` is called now and then with the share of the flight that is
// done; what it throws ends the flight.
FlownPath fly(const Trajectory& trajectory, const Vehicle& vehicle,
              const FlightConditions& conditions = {}, const CancellationToken* cancellation = {},
              const std::function<void(double)>& told = {});

}  // namespace lapwing
