// Pilots that are programs: their sticks answer to the flight. The logs that examples/racing ships
// are theirs.
#pragma once

#include "framework/vehicle/race_flight.h"
#include "framework/vehicle/reference_motion.h"

namespace lapwing {

// Left of where the course leads at `progress`, m, of a place `ahead` seconds on.
inline double bend_ahead(const ReferenceMotion& course, double progress, double ahead) {
  const ReferencePoint here = course.at(progress);
  const Eigen::Vector3d to = course.at(progress + ahead).position - here.position;
  Eigen::Vector2d along = here.velocity.head<2>();
  if (along.norm() < 1e-6) return 0;
  along.normalize();
  return along.x() * to.y() - along.y() * to.x();
}

// Slower than planned wherever the course bends.
inline StickSource timid_pilot(const ReferenceMotion& course) {
  return [&course](double, const BodyState&, double progress) -> Eigen::Vector2d {
    return {std::abs(bend_ahead(course, progress, 0.6)) > 0.4 ? -0.8 : -0.4, 0};
  };
}

// Faster than planned, towards the inside of every bend.
inline StickSource corner_cutter(const ReferenceMotion& course) {
  return [&course](double, const BodyState&, double progress) -> Eigen::Vector2d {
    return {0.6, std::clamp(0.25 * bend_ahead(course, progress, 0.8), -0.5, 0.5)};
  };
}

// Straight on where the course bends, for good.
inline StickSource leaver(const ReferenceMotion& course) {
  return [&course](double time, const BodyState&, double progress) -> Eigen::Vector2d {
    if (time < 2) return {0.2, 0};
    return {1, bend_ahead(course, progress, 0.8) > 0 ? -1.0 : 1.0};
  };
}

}  // namespace lapwing
