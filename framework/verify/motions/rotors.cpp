// SPDX-License-Identifier: Apache-2.0
// A rigid body with four rotors (thesis 3.11 to 3.13), with the vehicle's linear drag: position,
// velocity, unit quaternion and body rates. Thrusts are held or linear. Its yaw is where the nose
// points, on the turn of the interval's first point; its yaw rate is the body rate about z.
#include <numbers>

#include "framework/core/units.h"
#include "framework/vehicle/rotor_body.h"
#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

struct Body {
  Vector3d position, velocity;
  Vector4d q;  // w, x, y, z
  Vector3d rates;

  Quaterniond orientation() const { return Quaterniond(q[0], q[1], q[2], q[3]).normalized(); }
  Body moved(const Body& along, double by) const {
    return {position + by * along.position, velocity + by * along.velocity, q + by * along.q,
            rates + by * along.rates};
  }
};

class RotorsIntegrator final : public MotionIntegrator {
 public:
  RotorsIntegrator(const Trajectory& trajectory, const Vehicle& vehicle)
      : held_(trajectory.inputs_held),
        mass_(vehicle.mass),
        drag_(vehicle.drag),
        inertia_(vehicle.inertia),
        mixer_(mixer_of(vehicle.rotors)) {}

  double steps(const Sample& a, const Sample& b) const override {
    return std::ceil(std::max(1.0, (b.time - a.time) / tolerances::kRotorStep));
  }

  MotionPoint stated(const Sample& s) const override {
    const Quaterniond q = s.columns.quaternion("orientation");
    return point_of(
        {s.position, s.velocity, {q.w(), q.x(), q.y(), q.z()}, s.columns.vector3("body_rates")},
        s.columns.vector<4>("rotor_thrusts"), s.time);
  }

  // The angle between both orientations, the difference of body rates.
  std::array<double, 4> defects(const MotionPoint& reached,
                                const MotionPoint& stated) const override {
    return {(reached.position - stated.position).norm(),
            (reached.velocity - stated.velocity).norm(),
            reached.orientation.angularDistance(stated.orientation),
            (reached.body_rates - stated.body_rates).norm()};
  }

  void integrate(const Sample& a, const Sample& b, std::size_t count,
                 std::vector<MotionPoint>& points) const override {
    const double h = (b.time - a.time) / static_cast<double>(count);
    const Vector4d from = a.columns.vector<4>("rotor_thrusts"),
                   to = b.columns.vector<4>("rotor_thrusts");
    const auto thrusts = [&](double steps_done) -> Vector4d {
      if (held_) return from;
      const double share = steps_done / static_cast<double>(count);
      return from + share * (to - from);
    };
    const Quaterniond q = a.columns.quaternion("orientation");
    Body x{a.position, a.velocity, {q.w(), q.x(), q.y(), q.z()}, a.columns.vector3("body_rates")};
    points.push_back(point_of(x, thrusts(0), a.time));
    for (std::size_t k = 0; k < count; ++k) {
      const double at = static_cast<double>(k);
      const Body k1 = rates(x, thrusts(at));
      const Body k2 = rates(x.moved(k1, h / 2), thrusts(at + 0.5));
      const Body k3 = rates(x.moved(k2, h / 2), thrusts(at + 0.5));
      const Body k4 = rates(x.moved(k3, h), thrusts(at + 1));
      x = x.moved(k1, h / 6).moved(k2, h / 3).moved(k3, h / 3).moved(k4, h / 6);
      x.q.normalize();
      MotionPoint point =
          point_of(x, thrusts(at + 1), k + 1 == count ? b.time : a.time + h * (at + 1));
      // On the turn of the point before.
      const double turns = std::round((points.back().yaw - point.yaw) / (2 * std::numbers::pi));
      point.yaw += 2 * std::numbers::pi * turns;
      points.push_back(point);
    }
  }

 private:
  Body rates(const Body& body, const Vector4d& thrusts) const {
    const Vector4d wrench = mixer_ * thrusts;
    const Vector3d push = body.orientation() * Vector3d(0, 0, wrench[0]) - drag_ * body.velocity;
    const Quaterniond turn(0, body.rates.x(), body.rates.y(), body.rates.z());
    const Quaterniond q = Quaterniond(body.q[0], body.q[1], body.q[2], body.q[3]) * turn;
    const Vector3d spin = inertia_.cwiseProduct(body.rates);
    return {body.velocity, push / mass_ - Vector3d(0, 0, kGravity),
            0.5 * Vector4d(q.w(), q.x(), q.y(), q.z()),
            (wrench.tail<3>() - body.rates.cross(spin)).cwiseQuotient(inertia_)};
  }

  MotionPoint point_of(const Body& body, const Vector4d& thrusts, double time) const {
    const Quaterniond orientation = body.orientation();
    const Vector3d nose = orientation * Vector3d::UnitX();
    MotionPoint point;
    point.time = time;
    point.position = body.position;
    point.velocity = body.velocity;
    point.force = orientation * Vector3d(0, 0, thrusts.sum());
    point.acceleration = (point.force - drag_ * body.velocity) / mass_ - Vector3d(0, 0, kGravity);
    point.orientation = orientation;
    point.body_rates = body.rates;
    point.rotor_thrusts = thrusts;
    point.yaw = std::atan2(nose.y(), nose.x());
    point.yaw_rate = body.rates.z();
    return point;
  }

  bool held_;
  double mass_, drag_;
  Eigen::Vector3d inertia_;
  Eigen::Matrix4d mixer_;
};

}  // namespace

KnownMotion rotors_integrator() {
  return {"rotors", rotors_motion().columns,
          [](const Trajectory& trajectory,
             const Vehicle& vehicle) -> std::unique_ptr<MotionIntegrator> {
            return std::make_unique<RotorsIntegrator>(trajectory, vehicle);
          },
          [](const Vehicle& vehicle) -> std::string {
            return vehicle.has_rotors ? "" : "inertia and rotors";
          }};
}

}  // namespace lapwing
