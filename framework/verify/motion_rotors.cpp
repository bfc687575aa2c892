// The verifier's own rigid body with four rotors (thesis 3.11 to 3.13).
#include <numbers>

#include "framework/core/units.h"
#include "framework/verify/motion.h"
#include "framework/verify/tolerances.h"

namespace lapwing {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

struct Motion::Body {
  Vector3d position, velocity;
  Vector4d q;  // w, x, y, z
  Vector3d rates;

  Quaterniond orientation() const { return Quaterniond(q[0], q[1], q[2], q[3]).normalized(); }
  Body moved(const Body& along, double by) const {
    return {position + by * along.position, velocity + by * along.velocity, q + by * along.q,
            rates + by * along.rates};
  }
};

Motion::Body Motion::rates(const Body& body, const Vector4d& thrusts) const {
  const Vector4d wrench = mixer_ * thrusts;
  const Vector3d push = body.orientation() * Vector3d(0, 0, wrench[0]) - drag_ * body.velocity;
  const Quaterniond turn(0, body.rates.x(), body.rates.y(), body.rates.z());
  const Quaterniond q = Quaterniond(body.q[0], body.q[1], body.q[2], body.q[3]) * turn;
  const Vector3d spin = inertia_.cwiseProduct(body.rates);
  return {body.velocity, push / mass_ - Vector3d(0, 0, kGravity),
          0.5 * Vector4d(q.w(), q.x(), q.y(), q.z()),
          (wrench.tail<3>() - body.rates.cross(spin)).cwiseQuotient(inertia_)};
}

MotionPoint Motion::point_of(const Body& body, const Vector4d& thrusts, double time) const {
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

MotionPoint Motion::stated_rotors(std::size_t index) const {
  const Sample& s = trajectory_.samples[index];
  const Quaterniond& q = s.orientation;
  return point_of({s.position, s.velocity, {q.w(), q.x(), q.y(), q.z()}, s.body_rates},
                  s.rotor_thrusts, s.time);
}

std::span<const MotionPoint> Motion::turn_rotors(std::size_t interval) {
  const Sample& a = trajectory_.samples[interval];
  const Sample& b = trajectory_.samples[interval + 1];
  const auto count = static_cast<std::size_t>(steps(interval));
  const double h = (b.time - a.time) / static_cast<double>(count);
  const auto thrusts = [&](double steps_done) -> Vector4d {
    if (trajectory_.inputs_held) return a.rotor_thrusts;
    const double share = steps_done / static_cast<double>(count);
    return a.rotor_thrusts + share * (b.rotor_thrusts - a.rotor_thrusts);
  };
  const Quaterniond& q = a.orientation;
  Body x{a.position, a.velocity, {q.w(), q.x(), q.y(), q.z()}, a.body_rates};
  points_.clear();
  points_.push_back(point_of(x, thrusts(0), a.time));
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
    const double turns = std::round((points_.back().yaw - point.yaw) / (2 * std::numbers::pi));
    point.yaw += 2 * std::numbers::pi * turns;
    points_.push_back(point);
  }
  return points_;
}

}  // namespace lapwing
