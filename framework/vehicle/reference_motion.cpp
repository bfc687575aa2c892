// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/reference_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/units.h"

namespace lapwing {

using Eigen::Vector3d;

namespace {
constexpr double kLongestRamp = 0.2;  // s
}

Trajectory forces_of(const Trajectory& rotors, const Vehicle& vehicle) {
  Trajectory forces = rotors;
  forces.motion = force_motion();
  double before = 0;
  for (Sample& s : forces.samples) {
    const Eigen::Quaterniond attitude = s.columns.quaternion("orientation").normalized();
    // m r'' - m g: the thrust less the drag, which the controller adds again.
    const double thrust = s.columns.vector<4>("rotor_thrusts").sum();
    const Vector3d force = attitude * Vector3d(0, 0, thrust) - vehicle.drag * s.velocity;
    s.columns = {};
    s.columns.set("force", force);
    // The heading at right angles to the y axis (reading 3.7): with it the controller asks for the
    // planned attitude itself. Where the nose points differs by the product of two tilts.
    const Vector3d y = attitude * Vector3d::UnitY();
    const double yaw = std::atan2(-y.x(), y.y());
    const double turns = std::round((before - yaw) / (2 * std::numbers::pi));
    s.yaw = before = yaw + 2 * std::numbers::pi * turns;
    s.columns.set("yaw_torque", 0.0);
  }
  for (std::size_t i = 0; i + 1 < forces.samples.size(); ++i)
    forces.samples[i].yaw_rate = (forces.samples[i + 1].yaw - forces.samples[i].yaw) /
                                 (forces.samples[i + 1].time - forces.samples[i].time);
  return forces;
}

Trajectory forces_of_accelerations(const Trajectory& accelerations, const Vehicle& vehicle) {
  Trajectory forces = accelerations;
  forces.motion = force_motion();
  for (Sample& s : forces.samples) {
    s.columns = {};
    s.columns.set("force", Vector3d(vehicle.mass * (s.acceleration + Vector3d(0, 0, kGravity))));
    s.columns.set("yaw_torque", 0.0);
  }
  // Accelerations change from sample to sample: they are no inputs that are held.
  forces.inputs_held = false;
  return forces;
}

namespace {

// The trajectory as forces where its own columns are others. An error where no controller can
// follow it.
std::optional<Trajectory> as_forces(const Trajectory& trajectory, const Vehicle& vehicle) {
  if (!vehicle.has_rotors)
    throw InputError({}, "vehicle '" + vehicle.name +
                             "' states no rotors: no simulated vehicle can fly this plan"
                             "; a vehicle file with inertia and rotors is needed");
  switch (trajectory.motion.tracked) {
    case Tracking::force:
      return std::nullopt;
    case Tracking::rotors:
      return forces_of(trajectory, vehicle);
    case Tracking::acceleration:
      return forces_of_accelerations(trajectory, vehicle);
    case Tracking::none:
      break;
  }
  if (!trajectory.motion.moves)
    throw InputError(
        {},
        "this plan is an exploration: straight lines without forces, which a controller "
        "cannot track. Films, races, light paintings and scans can be simulated; a scan "
        "may begin with an exploration (examples/explore/explore_then_scan.lua)");
  throw InputError({}, "the motion '" + trajectory.motion.name +
                           "' has no inputs that a simulated quadrotor can track");
}

}  // namespace

ReferenceMotion::ReferenceMotion(const Trajectory& trajectory, const Vehicle& vehicle)
    : forces_(as_forces(trajectory, vehicle)),
      trajectory_(forces_ ? *forces_ : trajectory),
      mass_(vehicle.mass),
      drag_(vehicle.drag) {
  if (trajectory.samples.size() < 2) throw InputError({}, "a flight needs two samples at least");
  for (const Sample& s : trajectory_.samples) {
    times_.push_back(s.time);
    accelerations_.push_back(s.columns.vector3("force") / mass_ - Vector3d(0, 0, kGravity));
    spins_.push_back(s.columns.scalar("yaw_torque") / vehicle.inertia.z());
  }
}

std::size_t ReferenceMotion::interval(double time) const {
  const auto next = std::upper_bound(times_.begin() + 1, times_.end() - 1, time);
  return static_cast<std::size_t>(next - times_.begin()) - 1;
}

Vector3d ReferenceMotion::smoothed_acceleration(std::size_t interval, double time) const {
  const auto length = [&](std::size_t i) { return times_[i + 1] - times_[i]; };
  const bool early = 2 * (time - times_[interval]) < length(interval);
  if ((early && interval == 0) || (!early && interval + 2 == times_.size()))
    return acceleration(interval);
  const std::size_t from = early ? interval - 1 : interval;  // the ramp's jump comes after it
  const double ramp = std::min({length(from), length(from + 1), kLongestRamp});
  const double share = std::clamp((time - times_[from + 1]) / ramp + 0.5, 0.0, 1.0);
  return acceleration(from) + share * (acceleration(from + 1) - acceleration(from));
}

ReferencePoint ReferenceMotion::at(double time) const {
  const auto& samples = trajectory_.samples;
  ReferencePoint point;
  if (time <= start() || time >= finish()) {
    const Sample& end = time <= start() ? samples.front() : samples.back();
    point.position = end.position;
    point.yaw = end.yaw;
    if (time == start() || time == finish()) {
      point.velocity = end.velocity;
      point.yaw_rate = end.yaw_rate;
      point.acceleration = acceleration(time == start() ? 0 : samples.size() - 2);
    }
    return point;
  }
  const std::size_t i = interval(time);
  const Sample& s = samples[i];
  const double t = time - s.time, h = samples[i + 1].time - s.time;
  const Vector3d a = acceleration(i);
  const double spin = spins_[i];
  Vector3d jerk = Vector3d::Zero();
  double spin_rate = 0;
  if (!trajectory_.inputs_held) {
    jerk = (acceleration(i + 1) - a) / h;
    spin_rate = (spins_[i + 1] - spin) / h;
  }
  point.position = s.position + t * (s.velocity + t * (a / 2 + t * jerk / 6));
  point.velocity = s.velocity + t * (a + t * jerk / 2);
  point.acceleration =
      trajectory_.inputs_held ? smoothed_acceleration(i, time) : Vector3d(a + t * jerk);
  point.yaw = s.yaw + t * (s.yaw_rate + t * (spin / 2 + t * spin_rate / 6));
  point.yaw_rate = s.yaw_rate + t * (spin + t * spin_rate / 2);
  return point;
}

Vector3d ReferenceMotion::force(const ReferencePoint& point) const {
  return mass_ * (point.acceleration + Vector3d(0, 0, kGravity)) + drag_ * point.velocity;
}

}  // namespace lapwing
