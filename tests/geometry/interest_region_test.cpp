// SPDX-License-Identifier: Apache-2.0
// Polygons and regions of prisms against known answers.
#include "framework/geometry/interest_region.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/polygon.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

const GroundPolygon kElbow{{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 10}, {0, 10}};
const GroundPolygon kCourt{{1, 1}, {3, 1}, {3, 3}, {1, 3}};

RegionPrism elbow() {
  return {.name = "elbow", .outline = kElbow, .holes = {kCourt}, .low = 0, .high = 5};
}

TEST(Polygon, FaultsAreNamedWithTheirPlace) {
  EXPECT_EQ(polygon_fault(kElbow), "");
  EXPECT_EQ(polygon_fault({kElbow.rbegin(), kElbow.rend()}), "");
  EXPECT_THAT(polygon_fault({{0, 0}, {4, 4}, {4, 0}, {0, 4}}),
              HasSubstr("edges 1 and 3 cross or touch near (2, 2)"));
  EXPECT_THAT(polygon_fault({{0, 0}, {4, 0}, {9, 0}}), HasSubstr("no area"));
  EXPECT_THAT(polygon_fault({{0, 0}, {0, 0}, {4, 0}, {4, 4}}),
              HasSubstr("corners 1 and 2 coincide at (0, 0)"));
  EXPECT_THAT(polygon_fault({{0, 0}, {4, 0}}), HasSubstr("2 corners"));
  EXPECT_THAT(polygon_fault({{0, 0}, {4, 0}, {4, 4}, {4, 0.0}, {2, 6}}), HasSubstr("edge"));
}

TEST(Polygon, IsSimpleWhereItHasNoFaultAndTheOtherWayRound) {
  Random random(5);
  int simple = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<Vector2d> corners;
    const int count = static_cast<int>(random.integer(3, 6));
    for (int k = 0; k < count; ++k)
      corners.emplace_back(static_cast<double>(random.integer(0, 4)),
                           static_cast<double>(random.integer(0, 4)));
    const bool sound = polygon_fault(corners).empty();
    EXPECT_EQ(sound, is_simple_polygon(corners) && polygon_area(corners) > 0);
    simple += sound;
  }
  EXPECT_GT(simple, 200);
}

TEST(Polygon, LiesWithinAnotherWhereItDoes) {
  EXPECT_EQ(fault_within(kCourt, kElbow), "");
  EXPECT_EQ(fault_within({{0, 0}, {4, 0}, {4, 4}}, kElbow), "") << "shared corners and edges";
  EXPECT_THAT(fault_within({{1, 1}, {6, 6}, {1, 6}}, kElbow), HasSubstr("corner 2 at (6, 6)"));
  // All corners inside, across the bay.
  EXPECT_THAT(fault_within({{9, 1}, {9, 3}, {3, 9}, {1, 9}}, kElbow), HasSubstr("edge 2"));
}

TEST(InterestRegion, OfPrismsContainsWhatSmallStepsSay) {
  const InterestRegion region({elbow()});
  EXPECT_NEAR(region.area(), 10 * 4 + 4 * 6 - 4, 1e-12);
  int inside = 0, all = 0;
  for (double x = -0.95; x < 11; x += 0.1)
    for (double y = -0.95; y < 11; y += 0.1) {
      const bool in_elbow = x > 0 && y > 0 && ((x < 10 && y < 4) || (x < 4 && y < 10));
      const bool in_court = x > 1 && x < 3 && y > 1 && y < 3;
      EXPECT_EQ(region.contains({x, y, 2}), in_elbow && !in_court) << x << " " << y;
      EXPECT_FALSE(region.contains({x, y, 5.1}));
      EXPECT_FALSE(region.contains({x, y, -0.1}));
      inside += region.contains({x, y, 2});
      ++all;
    }
  EXPECT_NEAR(inside * 0.01, region.area(), 1e-9);
}

TEST(InterestRegion, ABoxAsAPrismIsTheBox) {
  const Eigen::AlignedBox3d box(Vector3d(-1, -2, 0), Vector3d(3, 2, 4));
  const InterestRegion whole(box);
  const InterestRegion prism({RegionPrism{.name = "",
                                          .outline = {{-1, -2}, {3, -2}, {3, 2}, {-1, 2}},
                                          .holes = {},
                                          .low = 0,
                                          .high = 4}});
  EXPECT_EQ(prism.bounds().min(), box.min());
  EXPECT_EQ(prism.bounds().max(), box.max());
  Random random(1);
  for (int k = 0; k < 3000; ++k) {
    const Vector3d p(random.uniform(-2, 4), random.uniform(-3, 3), random.uniform(-1, 5));
    EXPECT_EQ(whole.contains(p), prism.contains(p));
    EXPECT_EQ(whole.heights_at(p.head<2>()), prism.heights_at(p.head<2>()));
  }
}

TEST(InterestRegion, TheLargestWeightOfOverlappingPrismsCounts) {
  RegionPrism heavy{.name = "heavy",
                    .outline = {{3, 0}, {12, 0}, {12, 2}, {3, 2}},
                    .holes = {},
                    .low = -1,
                    .high = 2,
                    .weight = 3};
  const InterestRegion region(std::vector{elbow(), heavy});
  EXPECT_EQ(region.weight({0.5, 0.5, 1}), 1);
  EXPECT_EQ(region.weight({5, 1, 1}), 3);
  EXPECT_EQ(region.weight({5, 1, 3}), 1);
  EXPECT_EQ(region.weight({11, 1, -0.5}), 3);
  EXPECT_EQ(region.weight({11, 1, 3}), 0);
  EXPECT_EQ(region.largest_weight(), 3);
  EXPECT_EQ(region.heights_at({5, 1}), std::pair(-1.0, 5.0));
  EXPECT_EQ(region.heights_at({2, 2}), std::nullopt) << "the hole";
}

TEST(InterestRegion, WhatBoundsNoneIsRefusedByName) {
  const auto refused = [](auto spoil) -> std::string {
    RegionPrism prism = elbow();
    spoil(prism);
    try {
      const InterestRegion region({prism});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refused([](RegionPrism& p) { std::swap(p.outline[1], p.outline[3]); }),
              HasSubstr("region 'elbow': its edges"));
  EXPECT_THAT(refused([](RegionPrism& p) {
                p.holes[0][2] = {20, 20};
              }),
              HasSubstr("hole 1: it must lie within the outline"));
  EXPECT_THAT(refused([](RegionPrism& p) { p.high = 0; }), HasSubstr("below its upper one"));
  EXPECT_THAT(refused([](RegionPrism& p) { p.weight = 0; }), HasSubstr("weight must be above 0"));
  EXPECT_THAT(refused([](RegionPrism& p) { p.outline[0].x() = 1e300; }), HasSubstr("1e6 m"));
  EXPECT_THAT(refused([](RegionPrism& p) { p.outline[0].x() = std::nan(""); }), HasSubstr("1e6 m"));
  EXPECT_THROW(InterestRegion(std::vector<RegionPrism>{}), InputError);
}

}  // namespace
}  // namespace lapwing
