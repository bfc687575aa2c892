// SPDX-License-Identifier: Apache-2.0
// What a trajectory asks of the controller at any time.
#pragma once

#include <optional>
#include <vector>

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct ReferencePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      // m, world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // m/s, world
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, world
  double yaw = 0, yaw_rate = 0;                            // rad, rad/s
};

// A trajectory of rotors as places, headings and the forces that they need, which is what the
// controller follows. The rest of the plan's attitude and its rotor thrusts are left to it.
Trajectory forces_of(const Trajectory& rotors, const Vehicle& vehicle);

// A trajectory of accelerations and yaw rates likewise: the force that gives a mass its
// acceleration, without drag, linear from sample to sample.
Trajectory forces_of_accelerations(const Trajectory& accelerations, const Vehicle& vehicle);

// Of a trajectory of the motion model `force`: from each sample on by its inputs, held or linear.
// Held accelerations jump from sample to sample; as feed-forward, which no body follows in jumps,
// they change along a ramp around the jump, as long as the shorter interval and 0.2 s at most.
// Before the start and after the end the vehicle hovers. Of the model `rotors`: of its forces_of.
class ReferenceMotion {
 public:
  // Keeps a reference. Throws InputError for another motion model or fewer than two samples.
  ReferenceMotion(const Trajectory& trajectory, const Vehicle& vehicle);
  ReferenceMotion(const ReferenceMotion&) = delete;
  ReferenceMotion& operator=(const ReferenceMotion&) = delete;

  ReferencePoint at(double time) const;
  // Thrust that the acceleration needs, N, world: m (a - g) and the drag of the velocity.
  Eigen::Vector3d force(const ReferencePoint& point) const;
  double start() const { return trajectory_.samples.front().time; }
  double finish() const { return trajectory_.samples.back().time; }

 private:
  std::size_t interval(double time) const;
  const Eigen::Vector3d& acceleration(std::size_t sample) const { return accelerations_[sample]; }
  Eigen::Vector3d smoothed_acceleration(std::size_t interval, double time) const;

  const std::optional<Trajectory> forces_;  // of a trajectory of rotors
  const Trajectory& trajectory_;            // that, or the one that was given
  double mass_, drag_;
  // Of each sample; a flight reads them at every step of the controller.
  std::vector<double> times_;                   // s
  std::vector<Eigen::Vector3d> accelerations_;  // m/s^2, world
  std::vector<double> spins_;                   // rad/s^2, of the yaw
};

}  // namespace lapwing
