// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/survey/site_reference.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

StatedReference stated_at(const Vector3d& sample) {
  StatedReference stated;
  stated.name = "site.las";
  stated.option = "cloud";
  stated.sample = sample;
  stated.lowest = sample.z();
  return stated;
}

std::string refusal_of_site(const StatedReference& stated) {
  try {
    refer_site(stated);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string all_notes(const SiteReference& reference) {
  std::string all;
  for (const std::string& note : reference.notes) all += note + "\n";
  return all;
}

#define NEEDS_PROJ_HERE() \
  if (!ReferenceSystem::available()) GTEST_SKIP() << "Lapwing was built without libproj-dev"

const Vector3d kDelft(84934.6, 447549.3, 0.17);

TEST(SiteFrame, WithoutASystem) {
  StatedReference stated = stated_at({10, 20, 30});
  EXPECT_EQ(refer_site(stated).frame.to_world({1, 2, 3}), Vector3d(1, 2, 3));
  stated.zero = Vector3d(100, 200, 10);
  stated.unit = 0.3048;
  const SiteFrame frame = refer_site(stated).frame;
  EXPECT_LT((frame.to_world({110, 200, 20}) - Vector3d(3.048, 0, 3.048)).norm(), 1e-12);
  EXPECT_LT((frame.from_world({3.048, 0, 3.048}) - Vector3d(110, 200, 20)).norm(), 1e-9);
}

TEST(SiteFrame, FarCoordinatesWantASystemOrAZero) {
  EXPECT_THAT(
      refusal_of_site(stated_at({1e6, 20, 30})),
      AllOf(HasSubstr("'site.las'"), HasSubstr("1e+06 m from the world's origin"),
            HasSubstr("cloud.system = \"EPSG:"), HasSubstr("cloud.zero = {1000000, 0, 0}")));
  StatedReference stated = stated_at({1e6, 20, 30});
  stated.zero = Vector3d(1e6, 0, 0);
  EXPECT_EQ(refer_site(stated).frame.to_world({1e6 + 1, 2, 3}), Vector3d(1, 2, 3));
}

TEST(SiteFrame, DegreesWithoutASystemAreRefused) {
  const StatedReference stated = stated_at({4.36, 52.01, 2});
  const auto refused = [&](const Vector3d& low, const Vector3d& high) -> std::string {
    try {
      require_no_degrees(stated, Eigen::AlignedBox3d(low, high));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused({4.36, 52.01, -1}, {4.363, 52.012, 20}),
              AllOf(HasSubstr("degrees of longitude and latitude"), HasSubstr("EPSG:4326")));
  EXPECT_EQ(refused({0, 0, 0}, {40, 30, 10}), "");
  EXPECT_EQ(refused({0, 0, 0}, {0.4, 0.3, 0.3}), "") << "a small thing in metres";
}

// The world axes at the origin: east, north and up of the ellipsoid, by the Dutch grid, whose north
// is turned there by less than half a degree.
TEST(SiteFrame, ByASystem) {
  NEEDS_PROJ_HERE();
  StatedReference stated = stated_at(kDelft);
  stated.system_of_data = "EPSG:28992";
  const SiteReference found = refer_site(stated);
  EXPECT_THAT(all_notes(found), AllOf(HasSubstr("Amersfoort / RD New"),
                                      HasSubstr("the world's origin is at latitude 52.01")));
  EXPECT_FALSE(found.origin) << "what heights are above is not known";
  const Vector3d at = found.frame.to_world(kDelft);
  EXPECT_LT(at.head<2>().norm(), 1);  // 1e-5 degrees
  EXPECT_NEAR(at.z(), 0.17, 1e-3);    // interpolated
  const Vector3d east = found.frame.to_world(kDelft + Vector3d(100, 0, 0)) - at;
  EXPECT_NEAR(east.norm(), 100, 0.02);  // the scale of the grid
  EXPECT_GT(east.x(), 99.9);
  EXPECT_NEAR(found.frame.to_world(kDelft + Vector3d(0, 0, 50)).z(), at.z() + 50, 1e-4);
}

TEST(SiteFrame, InterpolationIsExactToAMillimetre) {
  NEEDS_PROJ_HERE();
  for (const bool degrees : {false, true}) {
    StatedReference stated = stated_at(degrees ? Vector3d(4.36, 52.01, 0) : kDelft);
    stated.system_of_data = degrees ? "EPSG:4326" : "EPSG:28992";
    const SiteFrame frame = refer_site(stated).frame;
    for (int i = 0; i < 40; ++i) {
      const double t = i / 39.0;
      const Vector3d away = degrees ? Vector3d(0.01 * std::sin(9 * t), 0.01 * t, 200 * t)
                                    : Vector3d(1000 * std::sin(9 * t), 1000 * t, 200 * t);
      const Vector3d p = stated.sample + away, p_W = frame.to_world(p);
      EXPECT_LT((p_W - frame.exactly_to_world(p)).norm(), 1e-3);
      const double metres = degrees ? 1.2e5 : 1;
      EXPECT_LT((frame.from_world(p_W) - p).head<2>().norm() * metres, 3e-3);
      EXPECT_LT((frame.exactly_from_world(frame.exactly_to_world(p)) - p).head<2>().norm() * metres,
                1e-3);
    }
  }
}

TEST(SiteFrame, ByTheMissionsOrigin) {
  NEEDS_PROJ_HERE();
  StatedReference stated = stated_at(kDelft);
  stated.system = "EPSG:28992";
  const GeodeticPoint there = ReferenceSystem::of("EPSG:28992").to_geodetic(kDelft);
  stated.origin = stated_origin(there.latitude_deg, there.longitude_deg, 2, HeightOf::ellipsoid);
  const SiteReference found = refer_site(stated);
  EXPECT_LT((found.frame.to_world(kDelft) - Vector3d(0, 0, 0.17 - 2)).norm(), 1e-3);
  EXPECT_THAT(all_notes(found), HasSubstr("taken to be above the ellipsoid"));
  stated.origin = stated_origin(there.latitude_deg, there.longitude_deg, 2, HeightOf::ground);
  EXPECT_THAT(refusal_of_site(stated), HasSubstr("above the ground"));
}

// New York in US survey feet: x, y and, unless somebody says otherwise, z.
TEST(SiteFrame, Feet) {
  NEEDS_PROJ_HERE();
  const double foot = 1200.0 / 3937;
  const Vector3d there(987000, 211000, 100);
  StatedReference stated = stated_at(there);
  stated.system_of_data = "EPSG:2263";
  const SiteReference found = refer_site(stated);
  EXPECT_THAT(all_notes(found), HasSubstr("in the unit of x and y, 0.30480061 m"));
  const Vector3d up =
      found.frame.to_world(there + Vector3d(0, 0, 100)) - found.frame.to_world(there);
  EXPECT_NEAR(up.z(), 100 * foot, 1e-4);
  const Vector3d east =
      found.frame.to_world(there + Vector3d(100, 0, 0)) - found.frame.to_world(there);
  EXPECT_NEAR(east.norm(), 100 * foot, 0.01);
  stated.height_unit_of_data = 1;
  EXPECT_NEAR((refer_site(stated).frame.to_world(there + Vector3d(0, 0, 100)) -
               refer_site(stated).frame.to_world(there))
                  .z(),
              100, 1e-3);
  stated.height_unit = 2;
  EXPECT_NEAR((refer_site(stated).frame.to_world(there + Vector3d(0, 0, 100)) -
               refer_site(stated).frame.to_world(there))
                  .z(),
              200, 1e-2);
}

// Ellipsoidal heights say where the world's origin is.
TEST(SiteFrame, HeightsOfTheSystem) {
  NEEDS_PROJ_HERE();
  StatedReference stated = stated_at({4.36, 52.01, 45.5});
  stated.system = "EPSG:4979";
  const SiteReference found = refer_site(stated);
  ASSERT_TRUE(found.origin);
  EXPECT_EQ(found.origin->height, 45);
  EXPECT_EQ(found.origin->height_of, HeightOf::ellipsoid);
  EXPECT_NEAR(found.frame.to_world(stated.sample).z(), 0.5, 1e-3);
  // Heights above the sea whose grid may be missing: then as they are, and a note says so.
  stated = stated_at(kDelft);
  stated.system_of_data = "EPSG:28992+5709";
  const SiteReference dutch = refer_site(stated);
  if (!dutch.origin) {
    EXPECT_THAT(all_notes(dutch), HasSubstr("lacks the grid"));
  }
  EXPECT_LT(dutch.frame.to_world(kDelft).head<2>().norm(), 2);
}

TEST(SiteFrame, ContradictionsAreRefused) {
  NEEDS_PROJ_HERE();
  StatedReference stated = stated_at(kDelft);
  stated.system = "EPSG:28992";
  stated.zero = kDelft;
  EXPECT_THAT(refusal_of_site(stated), HasSubstr("give it or cloud.system"));
  stated.zero.reset();
  stated.unit = 1;
  EXPECT_THAT(refusal_of_site(stated), HasSubstr("leave unit out"));
  stated.unit.reset();
  std::swap(stated.sample.x(), stated.sample.y());
  EXPECT_THAT(refusal_of_site(stated), HasSubstr("x and y in this order"));
  stated.system = "EPSG:nonsense";
  EXPECT_THAT(refusal_of_site(stated), HasSubstr("EPSG:nonsense"));
}

}  // namespace
}  // namespace lapwing
