// A time-sampled trajectory: what every planner produces and every exporter and verifier reads.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lapwing {

// The motion model between samples.
//   force:  m r'' = F + m g, I_psi psi'' = M_psi (thesis 3.1); inputs force and yaw torque
//   rotors: rigid body with four rotors (3.11 to 3.13); inputs are rotor thrusts
//   path:   positions and yaw only, joined by straight lines; no inputs
enum class MotionModel { force, rotors, path };

// World frame W: x east, y north, z up. Yaw about z, 0 along +x, counter-clockwise, unwrapped.
struct Sample {
  double time = 0;                                                  // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, W
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s, W
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();           // m/s^2, W
  double yaw = 0;                                                   // rad
  double yaw_rate = 0;                                              // rad/s
  Eigen::Vector3d force = Eigen::Vector3d::Zero();                  // N, W; model force
  double yaw_torque = 0;                                            // N m; model force
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB; model rotors
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();             // rad/s, body; model rotors
  Eigen::Vector4d rotor_thrusts = Eigen::Vector4d::Zero();          // N; model rotors
  Eigen::Vector4d rotor_thrust_rates = Eigen::Vector4d::Zero();     // N/s; not in plans
  double gimbal_yaw = 0, gimbal_pitch = 0;                          // rad; where has_gimbal
  double gimbal_yaw_rate = 0, gimbal_pitch_rate = 0;                // rad/s; where has_gimbal
  Eigen::Vector3d target = Eigen::Vector3d::Zero();                 // m, W; where has_target
};

struct Trajectory {
  MotionModel model = MotionModel::force;
  bool inputs_held = true;  // held until the next sample, or linear between samples
  bool has_gimbal = false;
  bool has_target = false;
  std::vector<Sample> samples;  // at least one; first at 0, times strictly increasing

  double duration() const {
    return samples.empty() ? 0.0 : samples.back().time - samples.front().time;
  }
};

}  // namespace lapwing
