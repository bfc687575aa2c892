// SPDX-License-Identifier: Apache-2.0
// A plan flown by the whole quadrotor under control (thesis 3.8): how far it strays.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "framework/core/progress.h"
#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/controller.h"
#include "framework/vehicle/disturbances.h"

namespace lapwing {

// s: a vehicle whose z axis is more than a right angle away from where it is to be has turned over
// after so long.
inline constexpr double kTumbling = 0.25;

struct FlightConditions {
  double wind_mean = 0;   // m/s, along `wind_yaw`
  double wind_gust = 0;   // m/s, standard deviation of each horizontal axis (dryden.h)
  double wind_yaw = 0;    // rad, where the wind blows to; 0 along +x
  double mass_error = 0;  // share by which the true mass and inertia exceed the file's
  Disturbances disturbances = {};
  std::uint64_t seed = 1;     // of gusts and noise
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

// Errors are those from the plan at the controller's progress, which is the time of the flight but
// for controllers that let the plan wait.
struct FlownPath {
  std::vector<FlownSample> samples;
  double position_error_worst = 0, position_error_at = 0;  // m, s
  double position_error_mean = 0;                          // m
  double yaw_error_worst = 0, yaw_error_at = 0;            // rad, s
  // From the plan at the time of the flight, to the plan's end: what moving things are near to.
  double clock_error_worst = 0, clock_error_at = 0;  // m, s
  double late_worst = 0;                             // s, of the progress behind the time
  bool finished = false;                             // the progress came to the plan's end
  double saturated_share = 0;                        // of the time
  double rotor_speed_worst = 0;  // share of the largest rotor speed, sqrt(F / F_max)
  // Strayed beyond 100 m or turned over: upside down where the plan is not, or, of a plan that
  // states attitudes, more than a right angle away from them for 0.25 s. What follows is not flown.
  bool lost = false;

  double duration() const {
    return samples.empty() ? 0 : samples.back().time - samples.front().time;
  }
};

// A plan that a controller is bound to; it may be flown several times, by several threads at once.
class ControlledPlan {
 public:
  // Keeps references to trajectory and vehicle. Null: the thesis's controller. Throws as
  // BodyReference and the controller do.
  ControlledPlan(const Trajectory& trajectory, const Vehicle& vehicle,
                 std::unique_ptr<Controller> controller = nullptr);

  // Flies from the first sample. Throws InputError for wind on a vehicle that states no drag and
  // for conditions that make no sense; Error where a command is not finite or beyond the rotors'
  // limits; Cancelled when told to stop. `told` is called now and then with the share of the flight
  // that is done; what it throws ends the flight.
  FlownPath fly(const FlightConditions& conditions = {}, const CancellationToken* cancellation = {},
                const std::function<void(double)>& told = {}) const;

  const BodyReference& reference() const { return reference_; }

 private:
  const Vehicle& vehicle_;
  BodyReference reference_;
  std::unique_ptr<Controller> controller_;
};

// The same with the thesis's controller, once.
FlownPath fly(const Trajectory& trajectory, const Vehicle& vehicle,
              const FlightConditions& conditions = {}, const CancellationToken* cancellation = {},
              const std::function<void(double)>& told = {});

}  // namespace lapwing
