// SPDX-License-Identifier: Apache-2.0
// Geodetic points and the local frame: east, north, up in metres at an origin on WGS 84.
#pragma once

#include <Eigen/Core>

namespace lapwing {

struct GeodeticPoint {
  double latitude_deg = 0;   // north positive, -90 to 90
  double longitude_deg = 0;  // east positive, -180 to 180
  double altitude = 0;       // m above the WGS 84 ellipsoid (not above the sea)
  bool operator==(const GeodeticPoint&) const = default;
};

// Throws InputError when a figure is not finite or out of range; `what` names the point.
void check_geodetic(const GeodeticPoint& point, const char* what);

// The point in the frame whose origin is `origin`: x east, y north, z up, m. Its ground is the
// plane that touches the ellipsoid at the origin, so a point far away at the same altitude lies
// below z = 0. Throws InputError as above.
Eigen::Vector3d to_local(const GeodeticPoint& origin, const GeodeticPoint& point);

// The inverse.
GeodeticPoint to_geodetic(const GeodeticPoint& origin, const Eigen::Vector3d& local);

}  // namespace lapwing
