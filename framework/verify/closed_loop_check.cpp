// SPDX-License-Identifier: Apache-2.0
// The plan flown by the whole quadrotor under control (vehicle/closed_loop.h), in still air.
#include "framework/vehicle/closed_loop.h"

#include "framework/verify/checks.h"

namespace lapwing {
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
  FlownPath path = fly(trajectory, flight.vehicle, {}, nullptr,
                       [&flight](double share) { flight.watch.done(share); });
  const double infinite = std::numeric_limits<double>::infinity();
  Check tracking =
      judged(make_check("closed_loop"), path.lost ? infinite : path.position_error_worst,
             tolerances::kTracking, 0, path.position_error_at);
  if (path.lost) tracking.detail = "the vehicle turns over, or is more than 100 m from the plan";
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
