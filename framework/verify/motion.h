// SPDX-License-Identifier: Apache-2.0
// The verifier's own integration of a plan's motion, interval by interval. Each interval starts
// from what its first sample states. motions/ holds an integrator for each motion that this version
// knows; another motion is integrated from the derivatives that the plan states.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

class MotionIntegrator;

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
  // Of motions that a plan states with their columns: their numbers, in the order of the columns.
  std::vector<double> columns = {};
};

class Motion {
 public:
  // Keeps references; `trajectory` must have finite numbers, increasing times and a motion without
  // problems (motions/motion_integrator.h).
  Motion(const Trajectory& trajectory, const Vehicle& vehicle);
  ~Motion();

  std::size_t intervals() const { return trajectory_.samples.size() - 1; }
  // Steps of all intervals together, as a number: a hostile plan may ask for more than fit
  // anything.
  double total_steps() const;

  // The motion from sample `interval` to the time of the next one, both ends included. Steps are as
  // tolerances.h says. Valid until the next call.
  std::span<const MotionPoint> integrate(std::size_t interval);

  // Told of every interval that `integrate` is asked for, beforehand; what it throws ends the call.
  void watch_by(std::function<void(std::size_t)> watcher) { watcher_ = std::move(watcher); }

  // What sample `index` itself states.
  MotionPoint stated(std::size_t index) const;

  const MotionIntegrator& integrator() const { return *integrator_; }

 private:
  double steps(std::size_t interval) const;

  const Trajectory& trajectory_;
  std::unique_ptr<MotionIntegrator> integrator_;
  std::vector<MotionPoint> points_;
  std::function<void(std::size_t)> watcher_;
};

}  // namespace lapwing
