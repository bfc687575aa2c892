// The verifier's own integration of the motion model `force` (thesis 3.1), thesis 3.5.3 for the
// gimbal:
//
//   m r'' = F + m g,   I_psi psi'' = M_psi,   gimbal angle' = gimbal rate
//
// Between two samples the inputs F, M_psi and the gimbal rates are held or linear. Each interval
// starts from what its first sample states. Of the model `path`: straight lines at even speed from
// sample to sample, yaw and gimbal likewise.
//
// Of the model `rotors` (3.11) to (3.13), with the vehicle's linear drag: position, velocity, unit
// quaternion and body rates, thrusts held or linear. Its yaw is where the nose points, on the turn
// of the interval's first point; its yaw rate is the body rate about z.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct MotionPoint {
  double time = 0;                                                  // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, W
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s, W
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();           // m/s^2, W; from the force
  Eigen::Vector3d force = Eigen::Vector3d::Zero();                  // N, W
  double yaw = 0, yaw_rate = 0, yaw_torque = 0;                     // rad, rad/s, N m
  double gimbal_yaw = 0, gimbal_pitch = 0;                          // rad
  double gimbal_yaw_rate = 0, gimbal_pitch_rate = 0;                // rad/s
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB; model rotors
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();             // rad/s; model rotors
  Eigen::Vector4d rotor_thrusts = Eigen::Vector4d::Zero();          // N; model rotors
};

class Motion {
 public:
  // Keeps references; `trajectory` must have finite numbers and increasing times.
  Motion(const Trajectory& trajectory, const Vehicle& vehicle);

  std::size_t intervals() const { return trajectory_.samples.size() - 1; }
  // Steps of all intervals together, as a number: a hostile plan may ask for more than fit
  // anything.
  double total_steps() const;

  // The motion from sample `interval` to the time of the next one by Runge-Kutta 4, both ends
  // included. Steps are as tolerances.h says. Valid until the next call.
  std::span<const MotionPoint> integrate(std::size_t interval);

  // Told of every interval that `integrate` is asked for, beforehand; what it throws ends the call.
  void watch_by(std::function<void(std::size_t)> watcher) { watcher_ = std::move(watcher); }

  // What sample `index` itself states.
  MotionPoint stated(std::size_t index) const;

 private:
  double steps(std::size_t interval) const;
  std::span<const MotionPoint> follow_line(std::size_t interval);
  // motion_rotors.cpp
  struct Body;
  Body rates(const Body& body, const Eigen::Vector4d& thrusts) const;
  MotionPoint point_of(const Body& body, const Eigen::Vector4d& thrusts, double time) const;
  std::span<const MotionPoint> turn_rotors(std::size_t interval);
  MotionPoint stated_rotors(std::size_t index) const;

  const Trajectory& trajectory_;
  double mass_, yaw_inertia_, drag_;
  Eigen::Vector3d inertia_;
  Eigen::Matrix4d mixer_;
  std::vector<MotionPoint> points_;
  std::function<void(std::size_t)> watcher_;
};

}  // namespace lapwing
