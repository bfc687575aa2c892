// SPDX-License-Identifier: Apache-2.0
// The plan flown by the whole quadrotor under control (vehicle/closed_loop.h), in still air.
#include "framework/vehicle/closed_loop.h"

#include <algorithm>

#include "framework/core/error.h"
#include "framework/verify/checks.h"

namespace lapwing {

namespace {

std::unique_ptr<Controller> opened(const ControllerChoice& choice,
                                   const ControllerSource& controllers) {
  if (choice.is_default()) return nullptr;
  if (!controllers)
    throw InputError({}, "the plan is to be flown by the controller '" + choice.name +
                             "', which nobody opened for this judgement");
  return controllers(choice);
}

// Whether a flight of the plan is as good when it is late: a course of gates among things at rest.
bool may_wait(const Plan& plan) {
  const Environment& surroundings = plan.environment;
  return !plan.task.gates.empty() && plan.task.keyframes.empty() && surroundings.subjects.empty() &&
         std::all_of(surroundings.obstacles.begin(), surroundings.obstacles.end(),
                     [](const Obstacle& obstacle) { return obstacle.still(); });
}

// A plan whose controller cannot fly it does not pass as if there was nothing to fly.
std::optional<FlownPath> not_flown(const Flight& flight, const std::string& why,
                                   Certificate& certificate) {
  Check tracking = judged(make_check("closed_loop"), std::numeric_limits<double>::infinity(),
                          tolerances::kTracking, 0, 0);
  tracking.detail = why;
  tracking.required = flight.plan.task.closed_loop_required;
  certificate.checks.push_back(tracking);
  for (const char* name : {"closed_loop_yaw", "rotors_saturated"})
    certificate.checks.push_back(skipped_check(name, why));
  return std::nullopt;
}

}  // namespace

std::optional<FlownPath> check_closed_loop(const Flight& flight, Certificate& certificate) {
  constexpr std::array kNames = {"closed_loop", "closed_loop_yaw", "rotors_saturated"};
  const Trajectory& trajectory = flight.plan.trajectory;
  std::string reason;
  if (!trajectory.motion.moves)
    reason = "a path has no inputs that a controller can track";
  else if (trajectory.motion.tracked == Tracking::none)
    reason = "the motion '" + trajectory.motion.name +
             "' has no inputs that a simulated quadrotor can track";
  else if (!flight.vehicle.has_rotors)
    reason = "the vehicle states no rotors: no simulated vehicle can fly this plan";
  else if (trajectory.samples.size() < 2)
    reason = "a single sample is not a flight";
  if (!reason.empty()) {
    for (const char* name : kNames) certificate.checks.push_back(skipped_check(name, reason));
    return std::nullopt;
  }
  FlownPath path;
  std::string controller;
  FlightConditions conditions;
  conditions.disturbances = flight.vehicle.disturbances;
  try {
    const ControllerChoice choice = controller_of(flight.vehicle);
    if (!choice.is_default()) controller = "flown by the controller '" + choice.name + "'";
    if (conditions.disturbances != Disturbances{})
      controller += (controller.empty() ? "flown" : "") +
                    std::string(" with the delays and errors of the vehicle's file");
    path = ControlledPlan(trajectory, flight.vehicle, opened(choice, flight.controllers))
               .fly(conditions, nullptr, [&flight](double share) { flight.watch.done(share); });
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& error) {
    return not_flown(flight, error.what(), certificate);
  }
  const double infinite = std::numeric_limits<double>::infinity();
  // A course may be flown late; what is timed may not.
  const bool timed = !may_wait(flight.plan);
  const double strayed = timed ? path.clock_error_worst : path.position_error_worst;
  const bool whole = !path.lost && path.finished;
  Check tracking =
      judged(make_check("closed_loop"), whole ? strayed : infinite, tolerances::kTracking, 0,
             timed ? path.clock_error_at : path.position_error_at);
  if (path.lost)
    tracking.detail = "the vehicle turns over, or is more than 100 m from the plan";
  else if (!path.finished)
    tracking.detail = "the vehicle does not reach the end within twice the time of the plan";
  if (!controller.empty())
    tracking.detail = controller + (tracking.detail.empty() ? "" : ": " + tracking.detail);
  Check yaw = judged(make_check("closed_loop_yaw"), path.yaw_error_worst, tolerances::kTrackingYaw,
                     0, path.yaw_error_at);
  tracking.required = yaw.required = flight.plan.task.closed_loop_required;
  certificate.checks.push_back(tracking);
  certificate.checks.push_back(yaw);
  certificate.checks.push_back(judged(make_check("rotors_saturated"), path.saturated_share,
                                      tolerances::kSaturated, 0, trajectory.samples.front().time));
  return path;
}

}  // namespace lapwing
