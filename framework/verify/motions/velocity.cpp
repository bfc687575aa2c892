// SPDX-License-Identifier: Apache-2.0
// Position and yaw as a drone's own flight control follows them: nothing is known of its thrust.
//
//   r' = v,   v' = a,   a' = jerk,   psi' = yaw rate
//
// The jerk and the yaw rate are held or linear. Between two samples all of it is a polynomial of
// the time, which is evaluated as it stands.
#include <cmath>

#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class VelocityIntegrator final : public MotionIntegrator {
 public:
  explicit VelocityIntegrator(const Trajectory& trajectory) : held_(trajectory.inputs_held) {}

  double steps(const Sample& a, const Sample& b) const override {
    namespace tol = tolerances;
    const double h = b.time - a.time;
    const Vector3d jerk = jerk_of(a),
                   change = held_ ? Vector3d(Vector3d::Zero()) : jerk_of(b) - jerk;
    // The acceleration never exceeds this, and neither does its change over the interval.
    const double turned = h * (jerk.norm() + change.norm());
    const double acceleration = a.acceleration.norm() + turned;
    const double gimbal = held_ ? 0.0
                                : h / 8 *
                                      std::max(std::abs(b.gimbal_yaw_rate - a.gimbal_yaw_rate),
                                               std::abs(b.gimbal_pitch_rate - a.gimbal_pitch_rate));
    return std::ceil(std::max(
        {1.0, h / tol::kStepMaximum, h * std::sqrt(acceleration / (8 * tol::kBulge)),
         std::sqrt(turned * h / 8 / tol::kHiddenSpeed), std::sqrt(gimbal / tol::kHiddenGimbal)}));
  }

  MotionPoint stated(const Sample& s) const override {
    const Vector3d jerk = jerk_of(s);
    return {.time = s.time,
            .position = s.position,
            .velocity = s.velocity,
            .acceleration = s.acceleration,
            .yaw = s.yaw,
            .yaw_rate = s.yaw_rate,
            .gimbal_yaw = s.gimbal_yaw,
            .gimbal_pitch = s.gimbal_pitch,
            .gimbal_yaw_rate = s.gimbal_yaw_rate,
            .gimbal_pitch_rate = s.gimbal_pitch_rate,
            .columns = {jerk.x(), jerk.y(), jerk.z()}};
  }

  void integrate(const Sample& a, const Sample& b, std::size_t count,
                 std::vector<MotionPoint>& points) const override {
    const double h = b.time - a.time;
    const Vector3d first = jerk_of(a);
    const Vector3d snap = held_ ? Vector3d(Vector3d::Zero()) : Vector3d((jerk_of(b) - first) / h);
    const double spin = held_ ? 0 : (b.yaw_rate - a.yaw_rate) / h;
    for (std::size_t k = 0; k <= count; ++k) {
      const double t = k == count ? h : h * static_cast<double>(k) / static_cast<double>(count);
      const Vector3d jerk = first + t * snap;
      points.push_back(
          {.time = k == count ? b.time : a.time + t,
           .position = a.position + t * (a.velocity + t * (a.acceleration / 2 +
                                                           t * (first / 6 + t * snap / 24))),
           .velocity = a.velocity + t * (a.acceleration + t * (first / 2 + t * snap / 6)),
           .acceleration = a.acceleration + t * (first + t * snap / 2),
           .yaw = a.yaw + t * (a.yaw_rate + t * spin / 2),
           .yaw_rate = a.yaw_rate + t * spin,
           .columns = {jerk.x(), jerk.y(), jerk.z()}});
    }
    turn_gimbal(a, b, {held_}, points);
  }

  // The yaw rate is an input: the next sample may state another.
  std::array<double, 4> defects(const MotionPoint& reached,
                                const MotionPoint& stated) const override {
    std::array<double, 4> all = MotionIntegrator::defects(reached, stated);
    if (held_) all[3] = 0;
    return all;
  }

  double state_defect(const MotionPoint& reached, const MotionPoint& stated) const override {
    return (reached.acceleration - stated.acceleration).norm() / tolerances::kAcceleration;
  }

  std::vector<OwnLimit> limits(const Vehicle& vehicle) const override {
    if (!vehicle.jerk_max) return {};
    return {{"jerk", *vehicle.jerk_max, false, [](const MotionPoint& p) {
               return Vector3d(p.columns[0], p.columns[1], p.columns[2]).norm();
             }}};
  }

 private:
  static Vector3d jerk_of(const Sample& s) { return s.columns.vector3("jerk"); }

  bool held_;
};

}  // namespace

KnownMotion velocity_integrator() {
  return {"velocity",
          {{"jerk", "m/s^3", 3, true}},
          [](const Trajectory& trajectory, const Vehicle&) -> std::unique_ptr<MotionIntegrator> {
            return std::make_unique<VelocityIntegrator>(trajectory);
          },
          [](const Vehicle&) -> std::string { return ""; }};
}

}  // namespace lapwing
