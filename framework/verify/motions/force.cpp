// SPDX-License-Identifier: Apache-2.0
// A point mass under a force, with a heading under a torque (thesis 3.1); thesis 3.5.3 for the
// gimbal:
//
//   m r'' = F + m g,   I_psi psi'' = M_psi,   gimbal angle' = gimbal rate
#include "framework/core/units.h"
#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

Eigen::Vector3d force_of(const Sample& s) {
  return s.columns.vector3("force");
}
double torque_of(const Sample& s) {
  return s.columns.scalar("yaw_torque");
}

struct Inputs {
  Eigen::Vector3d force;
  double yaw_torque, gimbal_yaw_rate, gimbal_pitch_rate;
};

Inputs inputs_of(const Sample& s) {
  return {force_of(s), torque_of(s), s.gimbal_yaw_rate, s.gimbal_pitch_rate};
}

Inputs inputs_between(const Inputs& a, const Inputs& b, double share) {
  return {a.force + share * (b.force - a.force),
          a.yaw_torque + share * (b.yaw_torque - a.yaw_torque),
          a.gimbal_yaw_rate + share * (b.gimbal_yaw_rate - a.gimbal_yaw_rate),
          a.gimbal_pitch_rate + share * (b.gimbal_pitch_rate - a.gimbal_pitch_rate)};
}

struct State {
  Eigen::Vector3d position, velocity;
  double yaw, yaw_rate, gimbal_yaw, gimbal_pitch;
};

State advanced(const State& x, const State& rate, double h) {
  return {x.position + h * rate.position,
          x.velocity + h * rate.velocity,
          x.yaw + h * rate.yaw,
          x.yaw_rate + h * rate.yaw_rate,
          x.gimbal_yaw + h * rate.gimbal_yaw,
          x.gimbal_pitch + h * rate.gimbal_pitch};
}

class ForceIntegrator final : public MotionIntegrator {
 public:
  ForceIntegrator(const Trajectory& trajectory, const Vehicle& vehicle)
      : held_(trajectory.inputs_held), mass_(vehicle.mass), yaw_inertia_(vehicle.inertia.z()) {}

  double steps(const Sample& a, const Sample& b) const override {
    namespace tol = tolerances;
    const double h = b.time - a.time;
    const Eigen::Vector3d gravity(0, 0, -kGravity);
    const double acceleration =
        std::max((force_of(a) / mass_ + gravity).norm(), (force_of(b) / mass_ + gravity).norm());
    // With linear inputs a speed may peak between two points: by |change of acceleration| step / 8.
    const double change = held_ ? 0.0 : 1.0;
    const double hidden_speed = change * (force_of(b) - force_of(a)).norm() / mass_ * h / 8;
    const double hidden_yaw_rate =
        change * std::abs(torque_of(b) - torque_of(a)) / yaw_inertia_ * h / 8;
    const double hidden_gimbal = change * h / 8 *
                                 std::max(std::abs(b.gimbal_yaw_rate - a.gimbal_yaw_rate),
                                          std::abs(b.gimbal_pitch_rate - a.gimbal_pitch_rate));
    return std::ceil(
        std::max({1.0, h / tol::kStepMaximum, h * std::sqrt(acceleration / (8 * tol::kBulge)),
                  std::sqrt(hidden_speed / tol::kHiddenSpeed),
                  std::sqrt(hidden_yaw_rate / tol::kHiddenYawRate),
                  std::sqrt(hidden_gimbal / tol::kHiddenGimbal)}));
  }

  MotionPoint stated(const Sample& s) const override {
    const Eigen::Vector3d gravity(0, 0, -kGravity);
    return {.time = s.time,
            .position = s.position,
            .velocity = s.velocity,
            .acceleration = force_of(s) / mass_ + gravity,
            .force = force_of(s),
            .yaw = s.yaw,
            .yaw_rate = s.yaw_rate,
            .yaw_torque = torque_of(s),
            .gimbal_yaw = s.gimbal_yaw,
            .gimbal_pitch = s.gimbal_pitch,
            .gimbal_yaw_rate = s.gimbal_yaw_rate,
            .gimbal_pitch_rate = s.gimbal_pitch_rate};
  }

  void integrate(const Sample& a, const Sample& b, std::size_t count,
                 std::vector<MotionPoint>& points) const override {
    const Inputs first = inputs_of(a), last = held_ ? first : inputs_of(b);
    const Eigen::Vector3d gravity(0, 0, -kGravity);
    const auto rate = [&](const State& x, double share) -> State {
      const Inputs u = inputs_between(first, last, share);
      return {x.velocity,        u.force / mass_ + gravity, x.yaw_rate, u.yaw_torque / yaw_inertia_,
              u.gimbal_yaw_rate, u.gimbal_pitch_rate};
    };
    const double h = (b.time - a.time) / static_cast<double>(count);
    State x{a.position, a.velocity, a.yaw, a.yaw_rate, a.gimbal_yaw, a.gimbal_pitch};
    points.push_back(stated(a));
    for (std::size_t k = 0; k < count; ++k) {
      const auto share = [&](double part) {
        return (static_cast<double>(k) + part) / static_cast<double>(count);
      };
      const State k1 = rate(x, share(0));
      const State k2 = rate(advanced(x, k1, h / 2), share(0.5));
      const State k3 = rate(advanced(x, k2, h / 2), share(0.5));
      const State k4 = rate(advanced(x, k3, h), share(1));
      x = advanced(x, k1, h / 6);
      x = advanced(x, k2, h / 3);
      x = advanced(x, k3, h / 3);
      x = advanced(x, k4, h / 6);
      const Inputs u = inputs_between(first, last, share(1));
      points.push_back({.time = k + 1 == count ? b.time : a.time + h * static_cast<double>(k + 1),
                        .position = x.position,
                        .velocity = x.velocity,
                        .acceleration = u.force / mass_ + gravity,
                        .force = u.force,
                        .yaw = x.yaw,
                        .yaw_rate = x.yaw_rate,
                        .yaw_torque = u.yaw_torque,
                        .gimbal_yaw = x.gimbal_yaw,
                        .gimbal_pitch = x.gimbal_pitch,
                        .gimbal_yaw_rate = u.gimbal_yaw_rate,
                        .gimbal_pitch_rate = u.gimbal_pitch_rate});
    }
  }

 private:
  bool held_;
  double mass_, yaw_inertia_;
};

}  // namespace

KnownMotion force_integrator() {
  return {"force", force_motion().columns,
          [](const Trajectory& trajectory,
             const Vehicle& vehicle) -> std::unique_ptr<MotionIntegrator> {
            return std::make_unique<ForceIntegrator>(trajectory, vehicle);
          },
          [](const Vehicle& vehicle) -> std::string {
            return vehicle.has_rotors ? "" : "inertia and rotors";
          }};
}

}  // namespace lapwing
