// SPDX-License-Identifier: Apache-2.0
// A plan with an origin, and where its places are on the earth by formulas written out here.
#pragma once

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "tests/plugins/exporters/planned_camera.h"

namespace lapwing {

inline constexpr double kLatitude = 46.5191, kLongitude = 6.5668;

// The planned camera with a place on the earth: z = 0 is 2 m above the ground of the origin.
inline Plan placed_plan(HeightOf reference = HeightOf::ground, double height = 2) {
  Plan plan = planned_camera();
  plan.geodetic_origin = GeodeticOrigin{kLatitude, kLongitude, height, reference};
  if (reference == HeightOf::sea) plan.geodetic_origin->geoid_height = 48;
  return plan;
}

// East, north and up of a point from another, from the two defining figures of WGS 84.
inline Eigen::Vector3d from_origin(const Eigen::Vector3d& origin, const Eigen::Vector3d& point) {
  const auto centred = [](const Eigen::Vector3d& p) {
    const double a = 6378137.0, f = 1 / 298.257223563, e2 = f * (2 - f);
    const double lat = p.x() * M_PI / 180, lon = p.y() * M_PI / 180;
    const double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
    return Eigen::Vector3d((n + p.z()) * std::cos(lat) * std::cos(lon),
                           (n + p.z()) * std::cos(lat) * std::sin(lon),
                           (n * (1 - e2) + p.z()) * std::sin(lat));
  };
  const double lat = origin.x() * M_PI / 180, lon = origin.y() * M_PI / 180;
  const Eigen::Vector3d east(-std::sin(lon), std::cos(lon), 0);
  const Eigen::Vector3d north(-std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon),
                              std::cos(lat));
  const Eigen::Vector3d d = centred(point) - centred(origin);
  return {east.dot(d), north.dot(d), east.cross(north).dot(d)};
}

inline Value with(const std::string& key, Value value) {
  Value given = Value::map();
  given.set(key, std::move(value));
  return given;
}

// What an exporter says when it refuses a plan; "" where it does not.
inline std::string refusal_of(const Exporter& exporter, const Plan& plan) {
  try {
    const std::string written = exporter.write(plan);
    exporter.losses(plan, written);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace lapwing
