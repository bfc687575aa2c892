// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "framework/core/error.h"
#include "framework/survey/reference_system.h"

namespace lapwing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal_of(const std::string& text) {
  try {
    ReferenceSystem::of(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string refusal_of(const ReferenceSystem& system, const Eigen::Vector3d& p) {
  try {
    system.to_geodetic(p);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

#define NEEDS_PROJ() \
  if (!ReferenceSystem::available()) GTEST_SKIP() << "Lapwing was built without libproj-dev"

TEST(ReferenceSystem, WithoutProjItNamesThePackage) {
  const std::string said = refusal_of("EPSG:28992");
  if (ReferenceSystem::available())
    EXPECT_EQ(said, "");
  else
    EXPECT_THAT(said, AllOf(HasSubstr("EPSG:28992"), HasSubstr("libproj-dev")));
}

// The fundamental point of the Dutch network, Amersfoort: false origin 155 km, 463 km; latitude
// 52 09 18.62, longitude 5 23 13.93 in the system of the satellites (Kadaster).
TEST(ReferenceSystem, DutchGrid) {
  NEEDS_PROJ();
  const ReferenceSystem dutch = ReferenceSystem::of("EPSG:28992");
  EXPECT_EQ(dutch.name(), "Amersfoort / RD New");
  EXPECT_FALSE(dutch.geographic());
  EXPECT_FALSE(dutch.vertical());
  EXPECT_EQ(dutch.metres_per_unit(), 1);
  EXPECT_EQ(dutch.unit(), "metre");
  const GeodeticPoint p = dutch.to_geodetic({155000, 463000, 12.5});
  EXPECT_NEAR(p.latitude_deg, 52.155172, 1e-5);  // 1 m
  EXPECT_NEAR(p.longitude_deg, 5.387204, 1.5e-5);
  EXPECT_EQ(p.altitude, 12.5) << "passes unchanged";
  const Eigen::Vector3d back = dutch.from_geodetic(p);
  EXPECT_NEAR(back.x(), 155000, 1e-3);
  EXPECT_NEAR(back.y(), 463000, 1e-3);
  EXPECT_EQ(back.z(), 12.5);
}

// On the central meridian a transverse Mercator has its false easting, and north is 0.9996 of the
// arc from the equator: at 45 degrees 4,984,944.378 m of arc on WGS 84 (exact series).
TEST(ReferenceSystem, CentralMeridianOfUtm) {
  NEEDS_PROJ();
  for (const char* text : {"EPSG:32631", "+proj=utm +zone=31 +datum=WGS84"}) {
    const Eigen::Vector3d p = ReferenceSystem::of(text).from_geodetic({45, 3, 100});
    EXPECT_NEAR(p.x(), 500000, 1e-6) << text;
    EXPECT_NEAR(p.y(), 0.9996 * 4984944.378, 0.002) << text;
    EXPECT_EQ(p.z(), 100) << text;
  }
}

TEST(ReferenceSystem, GeographicOnesTakeLongitudeFirst) {
  NEEDS_PROJ();
  const ReferenceSystem flat = ReferenceSystem::of("EPSG:4326"),
                        high = ReferenceSystem::of("EPSG:4979");
  EXPECT_TRUE(flat.geographic());
  EXPECT_FALSE(flat.vertical());
  EXPECT_EQ(flat.unit(), "degree");
  EXPECT_EQ(flat.metres_per_unit(), 0);
  EXPECT_TRUE(high.vertical());
  const GeodeticPoint wanted{46.5, 6.6, 400};
  EXPECT_EQ(flat.to_geodetic({6.6, 46.5, 400}), wanted);
  EXPECT_EQ(high.to_geodetic({6.6, 46.5, 400}), wanted);
}

TEST(ReferenceSystem, UnitsOfFeet) {
  NEEDS_PROJ();
  const ReferenceSystem feet = ReferenceSystem::of("EPSG:2263");  // New York, US survey feet
  EXPECT_EQ(feet.unit(), "US survey foot");
  EXPECT_NEAR(feet.metres_per_unit(), 0.3048006096, 1e-10);
  const GeodeticPoint p{40.75, -73.98, 0};
  const Eigen::Vector3d a = feet.from_geodetic(p),
                        b = feet.from_geodetic({40.75 + 1e-5, -73.98, 0});
  EXPECT_NEAR((b - a).norm() * feet.metres_per_unit(), 1.1105, 2e-3) << "m of 1e-5 degrees";
}

TEST(ReferenceSystem, NamesWhatItCannotRead) {
  NEEDS_PROJ();
  EXPECT_THAT(refusal_of("EPSG:99999"), AllOf(HasSubstr("'EPSG:99999'"), HasSubstr("EPSG:28992")));
  EXPECT_THAT(refusal_of(""), HasSubstr("expected a code"));
  EXPECT_THAT(refusal_of("EPSG:4978"), HasSubstr("middle of the earth"));
  EXPECT_THAT(refusal_of("EPSG:5709"), HasSubstr("no places on the earth"));  // heights alone
  EXPECT_THAT(refusal_of("+proj=pipeline +step +proj=utm +zone=31"), HasSubstr("an operation"));
  EXPECT_THAT(refusal_of("+proj=utm +zone=31 +ellps=intl"), HasSubstr("state a datum"));
}

TEST(ReferenceSystem, HeightsWithoutTheirGridAreRefused) {
  NEEDS_PROJ();
  // Heights above Amsterdam's level need a grid of the geoid. Where it is installed they differ
  // from those above the ellipsoid by 43 m; they are never passed on as they are.
  std::string said = refusal_of("EPSG:7415");
  if (said.empty()) {
    const ReferenceSystem system = ReferenceSystem::of("EPSG:7415");
    EXPECT_TRUE(system.vertical());
    said = refusal_of(system, {155000, 463000, 0});
    if (said.empty()) {
      EXPECT_NEAR(system.to_geodetic({155000, 463000, 0}).altitude, 43.3, 1);
      return;
    }
  }
  EXPECT_THAT(said, AllOf(HasSubstr("EPSG:7415"), HasSubstr("grid")));
}

TEST(ReferenceSystem, RefusesPointsElsewhere) {
  NEEDS_PROJ();
  const ReferenceSystem dutch = ReferenceSystem::of("EPSG:28992");
  EXPECT_THAT(refusal_of(dutch, {463000, 155000, 0}),
              AllOf(HasSubstr("(463000, 155000, 0)"), HasSubstr("in this order")));
  EXPECT_NE(refusal_of(dutch, {1e30, 0, 0}), "");
  EXPECT_THAT(refusal_of(dutch, {std::nan(""), 0, 0}), HasSubstr("finite"));
  EXPECT_THROW(dutch.from_geodetic({46.5, 6.6, 0}), InputError);
  EXPECT_THAT(refusal_of(ReferenceSystem::of("EPSG:4326"), {46.5, 106.6, 0}),
              AllOf(HasSubstr("latitude 106.6"), HasSubstr("in this order")));
  // Fiji's grid reaches over the date line.
  const ReferenceSystem fiji = ReferenceSystem::of("EPSG:3460");
  for (const double longitude : {179.9, -179.9}) {
    const GeodeticPoint p{-17, longitude, 0};
    EXPECT_NEAR(fiji.to_geodetic(fiji.from_geodetic(p)).longitude_deg, longitude, 1e-7);
  }
}

TEST(ReferenceSystem, ServesSeveralThreads) {
  NEEDS_PROJ();
  const ReferenceSystem system = ReferenceSystem::of("EPSG:32631");
  const GeodeticPoint wanted = system.to_geodetic({500000, 5000000, 0});
  std::vector<std::thread> threads;
  std::vector<int> same(4, 0);
  for (std::size_t k = 0; k < same.size(); ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < 200; ++i) same[k] += system.to_geodetic({500000, 5000000, 0}) == wanted;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(same, testing::Each(200));
}

}  // namespace
}  // namespace lapwing
