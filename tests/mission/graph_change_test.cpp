// SPDX-License-Identifier: Apache-2.0
// What is known of a region that was dragged, before an estimate is made.
#include "framework/mission/graph_change.h"

#include <gtest/gtest.h>

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// Vertices every 0.5 m over a square of 64 m.
TriangleMesh level_ground() {
  TriangleMesh mesh;
  for (int x = 0; x <= 128; ++x)
    for (int y = 0; y <= 128; ++y) mesh.vertices.emplace_back(0.5 * x, 0.5 * y, 0);
  return mesh;
}

double unknown_in(double left, double right) {
  return ground_without(level_ground(),
                        AlignedBox3d(Vector3d(left, 10, -1), Vector3d(right, 20, 5)));
}

TEST(GroundWithout, ASmallRegionIsAsKnownAsALargeOne) {
  EXPECT_EQ(unknown_in(0, 64), 0);
  EXPECT_EQ(unknown_in(20, 28), 0);
  EXPECT_EQ(unknown_in(20, 20.7), 0);
}

TEST(TimeLimit, IsThatOfTheTourThatItBeginsWith) {
  TourReport initial, found;
  found.status = TourStatus::feasible;
  for (const TourStatus status : {TourStatus::feasible, TourStatus::optimal}) {
    initial.status = status;
    take_over_time_limit(initial, found);
    EXPECT_EQ(found.status, TourStatus::feasible);
  }
  initial.status = TourStatus::time_limit;
  take_over_time_limit(initial, found);
  EXPECT_EQ(found.status, TourStatus::time_limit);
  EXPECT_NE(found.message.find("time limit"), std::string::npos);
}

TEST(GroundWithout, WhatLiesBesideTheMeshIsUnknown) {
  EXPECT_NEAR(unknown_in(54, 74), 0.5, 0.06);
  EXPECT_EQ(unknown_in(200, 220), 1);
}

}  // namespace
}  // namespace lapwing
