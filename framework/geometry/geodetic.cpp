// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/geodetic.h"

#include <GeographicLib/LocalCartesian.hpp>

#include "framework/core/error.h"

namespace lapwing {
namespace {

GeographicLib::LocalCartesian frame_at(const GeodeticPoint& origin) {
  check_geodetic(origin, "geodetic origin");
  return {origin.latitude_deg, origin.longitude_deg, origin.altitude,
          GeographicLib::Geocentric::WGS84()};
}

}  // namespace

void check_geodetic(const GeodeticPoint& point, const char* what) {
  // Comparisons with NaN are false, so each condition is written for the good case.
  const std::string name(what);
  if (!(std::abs(point.latitude_deg) <= 90)) {
    throw InputError(name + ": latitude must lie between -90 and 90 degrees");
  }
  if (!(std::abs(point.longitude_deg) <= 180)) {
    throw InputError(name + ": longitude must lie between -180 and 180 degrees");
  }
  if (!(std::abs(point.altitude) <= 1e6)) {
    throw InputError(name + ": altitude must lie within 1000 km of the ellipsoid");
  }
}

Eigen::Vector3d to_local(const GeodeticPoint& origin, const GeodeticPoint& point) {
  const GeographicLib::LocalCartesian frame = frame_at(origin);
  check_geodetic(point, "geodetic point");
  Eigen::Vector3d local;
  frame.Forward(point.latitude_deg, point.longitude_deg, point.altitude, local.x(), local.y(),
                local.z());
  return local;
}

GeodeticPoint to_geodetic(const GeodeticPoint& origin, const Eigen::Vector3d& local) {
  const GeographicLib::LocalCartesian frame = frame_at(origin);
  if (!local.allFinite()) throw InputError("local point: expected finite numbers");
  GeodeticPoint point;
  frame.Reverse(local.x(), local.y(), local.z(), point.latitude_deg, point.longitude_deg,
                point.altitude);
  return point;
}

}  // namespace lapwing
