// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/geometry/geodetic.h"

namespace lapwing {
namespace {

// Radii of curvature of WGS 84, from its two defining figures.
struct Radii {
  double meridian, transverse;
};
Radii radii_at(double latitude_deg) {
  const double a = 6378137.0, f = 1 / 298.257223563, e2 = f * (2 - f);
  const double s = std::sin(latitude_deg * M_PI / 180), w = std::sqrt(1 - e2 * s * s);
  return {a * (1 - e2) / (w * w * w), a / w};
}

TEST(Geodetic, OriginIsZero) {
  const GeodeticPoint origin{47.3769, 8.5417, 408};
  EXPECT_LT(to_local(origin, origin).norm(), 1e-8);
}

TEST(Geodetic, SmallStepsFollowTheRadiiOfCurvature) {
  const GeodeticPoint origin{47.3769, 8.5417, 408};
  const Radii r = radii_at(origin.latitude_deg);
  const double step = 1e-4, angle = step * M_PI / 180;
  GeodeticPoint north = origin, east = origin, up = origin;
  north.latitude_deg += step;
  east.longitude_deg += step;
  up.altitude += 12.5;
  EXPECT_NEAR(to_local(origin, north).y(), angle * (r.meridian + origin.altitude), 1e-3);
  EXPECT_NEAR(to_local(origin, east).x(),
              angle * (r.transverse + origin.altitude) * std::cos(origin.latitude_deg * M_PI / 180),
              1e-3);
  EXPECT_NEAR(to_local(origin, north).x(), 0, 1e-6);
  EXPECT_NEAR((to_local(origin, up) - Eigen::Vector3d(0, 0, 12.5)).norm(), 0, 1e-8);
}

TEST(Geodetic, DistantGroundSinksBelowThePlane) {
  const GeodeticPoint origin{0, 0, 0};
  const double distance = 10'000, a = 6378137.0;
  const GeodeticPoint far{0, distance / a * 180 / M_PI, 0};
  EXPECT_NEAR(to_local(origin, far).z(), -distance * distance / (2 * a), 1e-3);
}

TEST(Geodetic, RoundTripsToANanometre) {
  const GeodeticPoint origin{-33.86, 151.21, 20};
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(120, -340, 55), Eigen::Vector3d(-2000, 10, 0)}) {
    EXPECT_LT((to_local(origin, to_geodetic(origin, p)) - p).norm(), 1e-8);
  }
}

TEST(Geodetic, RefusesWhatIsNoPoint) {
  const GeodeticPoint good{1, 2, 3};
  EXPECT_THROW(to_local({91, 0, 0}, good), InputError);
  EXPECT_THROW(to_local(good, {0, 181, 0}), InputError);
  EXPECT_THROW(to_local(good, {0, 0, INFINITY}), InputError);
  EXPECT_THROW(to_local(good, {NAN, 0, 0}), InputError);
  EXPECT_THROW(to_geodetic(good, {NAN, 0, 0}), InputError);
}

}  // namespace
}  // namespace lapwing
