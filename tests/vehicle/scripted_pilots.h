// SPDX-License-Identifier: Apache-2.0
// Pilots that are programs: their sticks answer to the flight. The logs that examples/racing ships
// are theirs.
#pragma once

#include "framework/vehicle/race_flight.h"
#include "framework/vehicle/reference_motion.h"

namespace lapwing {

// What the course asks of the stick at `progress`: its acceleration along and to the left of it, in
// full deflections of `strength` m/s^2.
inline Eigen::Vector2d asked_of_stick(const ReferenceMotion& course, double progress,
                                      double strength) {
  const ReferencePoint here = course.at(progress);
  const Eigen::Vector2d along = here.velocity.head<2>().normalized();
  const Eigen::Vector2d a = here.acceleration.head<2>() / strength;
  return {along.dot(a), along.x() * a.y() - along.y() * a.x()};
}

inline constexpr double kHurry = 0.2;  // m/s^2, beyond what the course asks

inline Eigen::Vector2d within_the_frame(const Eigen::Vector2d& stick) {
  return stick.cwiseMax(-1).cwiseMin(1);
}

// As the course asks of who flies it at a share of its speed.
inline StickSource timid_pilot(const ReferenceMotion& course, double strength, double speed) {
  return [&course, strength, speed](double, const BodyState&, double progress) {
    return within_the_frame(speed * speed * asked_of_stick(course, progress, strength));
  };
}

// Faster, into every bend before it comes, and with an eye on a line on its inner side.
inline StickSource corner_cutter(const ReferenceMotion& course, double strength) {
  return [&course, strength](double, const BodyState& state, double progress) {
    constexpr double kInside = 1.0, kEager = 7;  // m; m/s^2 for every metre
    const Eigen::Vector2d now = asked_of_stick(course, progress, strength);
    const Eigen::Vector2d soon = asked_of_stick(course, progress + 0.15, strength);
    const ReferencePoint here = course.at(progress);
    const Eigen::Vector2d along = here.velocity.head<2>().normalized();
    const Eigen::Vector2d off = (state.position - here.position).head<2>();
    const double left = along.x() * off.y() - along.y() * off.x();
    const double inward = now.y() < 0 ? -kInside : kInside;
    return within_the_frame({now.x() + kHurry / strength,
                             0.6 * now.y() + 0.7 * soon.y() + kEager * (inward - left) / strength});
  };
}

// Straight on where the course bends.
inline StickSource leaver(const ReferenceMotion& course, double strength) {
  return [&course, strength](double, const BodyState&, double progress) {
    return within_the_frame({0.5, -2 * asked_of_stick(course, progress, strength).y()});
  };
}

}  // namespace lapwing
