// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/live_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/fly/setpoint_audit.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/path_flight.h"
#include "framework/vehicle/reference_motion.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

constexpr double kLeastDuration = 0.1;    // s
constexpr double kSetpointPeriod = 0.02;  // s

// The flight along a path is a flight that nobody has judged yet.
void fly_along(LiveFlight& flight, const std::filesystem::path& folder) {
  flight.plan.trajectory = flight_along(flight.plan.trajectory, flight.vehicle);
  Plan judged = flight.plan;
  judged.task = {};
  judged.task.closed_loop_required = false;
  judged.constraints.clear();
  judged.lights.clear();
  judged.budget.reset();
  const Certificate certificate = verify(judged, folder);
  for (const Check& check : certificate.failures())
    if (check.group == CheckGroup::safety)
      throw InputError("the path of '" + flight.plan.mission +
                       "', flown with a stop in every place: " + to_line(check));
  flight.said.push_back(
      "the plan is a path without velocities: flown with a stop in every place, "
      "in " +
      plain_number(flight.trajectory().duration(), 4) + " s");
}

// Headings that turn faster than the vehicle may, as those of a flight upside down, follow as fast
// as it may. Interpolation passes the rates of samples by up to a half.
bool slow_headings(Trajectory& trajectory, double fastest) {
  constexpr double kTurn = 2 * std::numbers::pi, kShare = 0.6, kNearLimit = 0.9;
  std::vector<Sample>& samples = trajectory.samples;
  std::vector<double> slow{samples.front().yaw};
  bool slowed = false;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double step = samples[i].time - samples[i - 1].time;
    const double turn = std::remainder(samples[i].yaw - slow.back(), kTurn);
    const double rate = std::max(std::abs(samples[i].yaw_rate), std::abs(turn) / step);
    slowed = slowed || rate > kNearLimit * fastest;
    const double most = kShare * fastest * step;
    slow.push_back(slow.back() + std::clamp(turn, -most, most));
  }
  if (!slowed) return false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, samples.size() - 1);
    samples[i].yaw = slow[i];
    samples[i].yaw_rate = (slow[b] - slow[a]) / (samples[b].time - samples[a].time);
  }
  return true;
}

// Setpoints know places and headings; of a plan that states rotor thrusts, those that its forces
// ask for.
void fly_forces(LiveFlight& flight) {
  if (flight.trajectory().motion.tracked != Tracking::rotors) return;
  flight.plan.trajectory = forces_of(flight.trajectory(), flight.vehicle);
  flight.said.push_back(
      "the plan states rotor thrusts: its places, headings and accelerations are "
      "sent, and the vehicle finds the thrusts itself");
  if (slow_headings(flight.plan.trajectory, flight.vehicle.yaw_rate_max))
    flight.said.push_back(
        "headings of the plan turn faster than can be streamed: slower ones are sent");
}

void require_finite(const Trajectory& trajectory) {
  for (const Sample& s : trajectory.samples)
    if (!s.position.allFinite() || !s.velocity.allFinite() || !s.acceleration.allFinite() ||
        !std::isfinite(s.yaw) || !std::isfinite(s.yaw_rate))
      throw InputError("a sample of the plan is not finite");
}

// As the vehicle would see them.
void require_limits(const LiveFlight& flight) {
  SetpointAudit audit(flight.vehicle);
  const Trajectory& trajectory = flight.trajectory();
  const double begin = trajectory.samples.front().time, end = trajectory.samples.back().time;
  for (int i = 0; begin + i * kSetpointPeriod <= end; ++i) {
    const double time = begin + i * kSetpointPeriod;
    const Sample s = sample_at(trajectory, time);
    audit.take({time, 1, s.position, s.velocity, s.acceleration, s.yaw, s.yaw_rate}, time, time);
    if (audit.beyond() > 0)
      throw InputError("the setpoint for " + plain_number(time, 4) +
                       " s of the plan is beyond the vehicle's limits (" + audit.in_words() +
                       "): a stream of places and headings cannot fly this plan");
  }
}

// The subject of the mission that is filmed as it moves; empty where there is none.
std::string live_subject(const Plan& plan) {
  const Value* subjects = plan.configuration.find("subjects");
  if (!subjects || !subjects->is_list()) return "";
  for (const Value& subject : subjects->as_list()) {
    const Value* live = subject.is_map() ? subject.find("live") : nullptr;
    const Value* name = subject.is_map() ? subject.find("name") : nullptr;
    if (live && live->type() == Value::Type::boolean && live->as_boolean())
      return name && name->is_text() ? name->as_text() : "?";
  }
  return "";
}

}  // namespace

LiveFlight live_flight_of(const Plan& plan, const std::filesystem::path& folder) {
  LiveFlight flight{plan, vehicle_from_value(plan.vehicle), {}, folder};
  if (flight.vehicle.wing)
    throw InputError("'" + flight.vehicle.name +
                     "' has a wing: live flights are for vehicles that can stop in the air; export "
                     "the plan as a mission");
  if (plan.trajectory.samples.size() < 2 || plan.trajectory.duration() < kLeastDuration)
    throw InputError("the plan has no length: there is nothing to fly");
  if (!plan.trajectory.motion.moves) fly_along(flight, folder);
  fly_forces(flight);
  require_finite(flight.trajectory());
  require_limits(flight);
  for (const Obstacle& obstacle : plan.environment.obstacles)
    if (!obstacle.still()) {
      flight.said.push_back(
          "the plan has moving obstacles: a pause or an abort leaves the times for "
          "which it keeps clear of them");
      break;
    }
  if (const std::string name = live_subject(plan); !name.empty())
    flight.said.push_back("the subject '" + name +
                          "' is live in the mission: this flight repeats the plan, made from the "
                          "track in the mission, and does not follow the subject");
  return flight;
}

}  // namespace lapwing
