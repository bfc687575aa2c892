// SPDX-License-Identifier: Apache-2.0
// The vehicle's limits along the continuous motion, whether or not the problem had such
// constraints.
#include "framework/verify/checks.h"
#include "framework/verify/motions/motion_integrator.h"

namespace lapwing {
namespace {

// The smallest norm on the straight line from a to b: a force that changes linearly moves on one.
double smallest_norm(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double length2 = d.squaredNorm();
  const double s = length2 > 0 ? std::clamp(-a.dot(d) / length2, 0.0, 1.0) : 0.0;
  return (a + s * d).norm();
}

// The side of a two-sided limit that the values come nearer to, or pass further.
Check nearer(const Worst& low, const Worst& high) {
  return low.excess() > high.excess() ? low.check() : high.check();
}

class Limits {
 public:
  Limits(const Vehicle& v, const MotionRecord& motion)
      : v_(v),
        motion_(motion),
        path_(!motion.moves),
        rotors_(motion.name == rotors_motion().name),
        force_(motion.name == force_motion().name),
        thrust_max_("thrust_max", v.thrust_max()),
        thrust_min_("thrust_min", v.thrust_min(), tolerance_of(v.thrust_min()), true),
        force_up_("force_up", 0, tolerances::kLimitFloor, true),
        yaw_torque_("yaw_torque", v.yaw_torque_max()),
        speed_across_("speed_across", v.speed_across_max),
        climb_("climb_speed", v.climb_speed_max),
        descent_("descent_speed", v.descent_speed_max),
        acceleration_across_("acceleration_across", v.acceleration_across_max),
        acceleration_up_("acceleration_up", v.acceleration_up_max.value_or(0)),
        acceleration_down_("acceleration_down", v.acceleration_down_max.value_or(0)),
        yaw_rate_("yaw_rate", v.yaw_rate_max),
        tilt_rate_("tilt_rate", v.tilt_rate_max.value_or(0)),
        rotor_high_("rotor_thrust", v.rotors.thrust_max),
        rotor_low_("rotor_thrust", v.rotors.thrust_min, tolerance_of(v.rotors.thrust_max), true) {}

  void see(const MotionPoint& p) {
    const double t = p.time;
    thrust_max_.see(p.force.norm(), t);
    thrust_min_.see(p.force.norm(), t);
    force_up_.see(p.force.z(), t);
    yaw_torque_.see(std::abs(p.yaw_torque), t);
    speed_across_.see(p.velocity.head<2>().norm(), t);
    climb_.see(std::max(p.velocity.z(), 0.0), t);
    descent_.see(std::max(-p.velocity.z(), 0.0), t);
    acceleration_across_.see(p.acceleration.head<2>().norm(), t);
    acceleration_up_.see(std::max(p.acceleration.z(), 0.0), t);
    acceleration_down_.see(std::max(-p.acceleration.z(), 0.0), t);
    yaw_rate_.see(std::abs(p.yaw_rate), t);
    tilt_rate_.see(p.body_rates.head<2>().cwiseAbs().maxCoeff(), t);
    rotor_high_.see(p.rotor_thrusts.maxCoeff(), t);
    rotor_low_.see(p.rotor_thrusts.minCoeff(), t);
  }

  void see_between(const MotionPoint& a, const MotionPoint& b) {
    thrust_min_.see(smallest_norm(a.force, b.force), a.time);
  }

  void append_to(Certificate& certificate) const {
    auto& checks = certificate.checks;
    if (path_) return append_speeds_to(checks);
    if (rotors_) {
      for (const char* name : {"thrust_max", "thrust_min", "force_up", "yaw_torque"})
        checks.push_back(skipped_check(name, "for the model 'rotors' each rotor is checked"));
      checks.push_back(nearer(rotor_low_, rotor_high_));
    } else if (!force_) {
      for (const char* name :
           {"thrust_max", "thrust_min", "force_up", "yaw_torque", "rotor_thrust"})
        checks.push_back(
            skipped_check(name, "the thrust is not known in the motion '" + motion_.name + "'"));
    } else {
      for (const Worst* worst : {&thrust_max_, &thrust_min_, &force_up_, &yaw_torque_})
        checks.push_back(worst->check());
      checks.push_back(skipped_check(
          "rotor_thrust", "for the model 'force' the bounds of thrust and yaw torque imply it"));
    }
    for (const Worst* worst : {&speed_across_, &climb_, &descent_, &acceleration_across_}) {
      checks.push_back(worst->check());
    }
    const std::string reason = v_.has_rotors
                                   ? "the vehicle states no such limit; its thrust bounds apply"
                                   : "the vehicle states no such limit";
    checks.push_back(v_.acceleration_up_max ? acceleration_up_.check()
                                            : skipped_check("acceleration_up", reason));
    checks.push_back(v_.acceleration_down_max ? acceleration_down_.check()
                                              : skipped_check("acceleration_down", reason));
    checks.push_back(yaw_rate_.check());
    if (!rotors_)
      checks.push_back(skipped_check("tilt_rate", "only the model 'rotors' has body rates"));
    else
      checks.push_back(v_.tilt_rate_max
                           ? tilt_rate_.check()
                           : skipped_check("tilt_rate", "the vehicle states no such limit"));
  }

 private:
  // A path has no inputs, and turns on the spot where its lines meet.
  void append_speeds_to(std::vector<Check>& checks) const {
    const auto skip = [&](std::initializer_list<const char*> names) {
      for (const char* name : names) {
        checks.push_back(skipped_check(name, "the motion model 'path' has no inputs"));
      }
    };
    skip({"thrust_max", "thrust_min", "force_up", "yaw_torque", "rotor_thrust"});
    for (const Worst* worst : {&speed_across_, &climb_, &descent_})
      checks.push_back(worst->check());
    skip({"acceleration_across", "acceleration_up", "acceleration_down"});
    checks.push_back(yaw_rate_.check());
    skip({"tilt_rate"});
  }

  const Vehicle& v_;
  const MotionRecord& motion_;
  bool path_, rotors_, force_;
  Worst thrust_max_, thrust_min_, force_up_, yaw_torque_;
  Worst speed_across_, climb_, descent_;
  Worst acceleration_across_, acceleration_up_, acceleration_down_;
  Worst yaw_rate_, tilt_rate_, rotor_high_, rotor_low_;
};

class Gimbal {
 public:
  explicit Gimbal(const GimbalLimits& g)
      : yaw_low_("gimbal_yaw", g.yaw_min, tolerances::kGimbalAngle, true),
        yaw_high_("gimbal_yaw", g.yaw_max, tolerances::kGimbalAngle),
        pitch_low_("gimbal_pitch", g.pitch_min, tolerances::kGimbalAngle, true),
        pitch_high_("gimbal_pitch", g.pitch_max, tolerances::kGimbalAngle),
        yaw_rate_("gimbal_yaw_rate", g.yaw_rate_max),
        pitch_rate_("gimbal_pitch_rate", g.pitch_rate_max) {}

  void see(const MotionPoint& p) {
    yaw_low_.see(p.gimbal_yaw, p.time);
    yaw_high_.see(p.gimbal_yaw, p.time);
    pitch_low_.see(p.gimbal_pitch, p.time);
    pitch_high_.see(p.gimbal_pitch, p.time);
    yaw_rate_.see(std::abs(p.gimbal_yaw_rate), p.time);
    pitch_rate_.see(std::abs(p.gimbal_pitch_rate), p.time);
  }

  void append_to(Certificate& certificate) const {
    certificate.checks.push_back(nearer(yaw_low_, yaw_high_));
    certificate.checks.push_back(nearer(pitch_low_, pitch_high_));
    certificate.checks.push_back(yaw_rate_.check());
    certificate.checks.push_back(pitch_rate_.check());
  }

 private:
  Worst yaw_low_, yaw_high_, pitch_low_, pitch_high_, yaw_rate_, pitch_rate_;
};

// Every integrated point and every stated sample.
template <class See, class SeeBetween>
void walk(const Flight& flight, See see, SeeBetween see_between) {
  Motion& motion = flight.motion;
  for (std::size_t i = 0; i <= motion.intervals(); ++i) see(motion.stated(i));
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (const MotionPoint& point : points) see(point);
    for (std::size_t k = 1; k < points.size(); ++k) see_between(points[k - 1], points[k]);
  }
}

}  // namespace

void check_limits(const Flight& flight, Certificate& certificate) {
  Limits limits(flight.vehicle, flight.plan.trajectory.motion);
  const std::vector<OwnLimit> own = flight.motion.integrator().limits(flight.vehicle);
  std::vector<Worst> worst;
  for (const OwnLimit& limit : own)
    worst.emplace_back(limit.check, limit.limit, tolerance_of(limit.limit), limit.at_least);
  walk(
      flight,
      [&](const MotionPoint& p) {
        limits.see(p);
        for (std::size_t i = 0; i < own.size(); ++i) worst[i].see(own[i].value(p), p.time);
      },
      [&](const MotionPoint& a, const MotionPoint& b) { limits.see_between(a, b); });
  limits.append_to(certificate);
  for (const Worst& one : worst) certificate.checks.push_back(one.check());
  if (!flight.plan.trajectory.has_gimbal) {
    for (const char* name :
         {"gimbal_yaw", "gimbal_pitch", "gimbal_yaw_rate", "gimbal_pitch_rate"}) {
      certificate.checks.push_back(skipped_check(name, "the plan moves no gimbal"));
    }
    return;
  }
  Gimbal gimbal(*flight.vehicle.gimbal);
  walk(
      flight, [&](const MotionPoint& p) { gimbal.see(p); },
      [](const MotionPoint&, const MotionPoint&) {});
  gimbal.append_to(certificate);
}

void check_time(const Flight& flight, Certificate& certificate) {
  const double duration = flight.plan.trajectory.duration();
  const auto check = [&](const char* name, double limit) {
    certificate.checks.push_back(
        judged(make_check(name), duration, limit, tolerance_of(limit), duration));
  };
  check("flight_time", flight.vehicle.flight_time);
  if (flight.plan.budget) {
    check("budget", *flight.plan.budget);
  } else {
    certificate.checks.push_back(skipped_check("budget", "the plan states no budget"));
  }
}

}  // namespace lapwing
