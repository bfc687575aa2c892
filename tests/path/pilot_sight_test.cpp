// SPDX-License-Identifier: Apache-2.0
// A line of sight to a pilot as a space, beside rays in small steps.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/path/pilot_sight.h"
#include "tests/view/view_world.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

const Vector3d kBody(1, 1, 0.5);

// Whether known free voxels alone lie on the line, from 1 m before the eye on.
bool seen_in_small_steps(const Map& map, const Vector3d& eye, const Vector3d& p) {
  const Vector3d line = p - eye;
  for (double along = 1; along < line.norm(); along += 0.01)
    if (map.read(map.grid().key(eye + along * line.normalized())).state != VoxelState::free)
      return false;
  return true;
}

TEST(PilotSight, WallsUnknownSpaceAndTheRangeHide) {
  const auto map = walled_room();
  const auto sight = in_sight_of(map, {{-8, 0, 2}, 18, 1});
  EXPECT_TRUE(sight->point_free({0, 0, 5}));
  EXPECT_FALSE(sight->point_free({7, 0, 5})) << "behind the wall";
  EXPECT_TRUE(sight->point_free({6, 7, 5})) << "past its end";
  EXPECT_FALSE(sight->point_free({0, 12, 5})) << "beyond the map nothing is known";
  EXPECT_FALSE(sight->point_free({8, 7, 5})) << "beyond the range";
  EXPECT_TRUE(sight->swept_box_free({0, 0, 5}, {0, 0, 5}, kBody));
  EXPECT_FALSE(sight->swept_box_free({6, 8, 5}, {6, -8, 5}, kBody)) << "passes behind the wall";
  EXPECT_TRUE(sight->swept_box_free({0, 8, 5}, {0, -8, 5}, kBody));
}

TEST(PilotSight, NothingHidesBesideTheEye) {
  const auto map = walled_room();
  // The eye is in the wall.
  const auto sight = in_sight_of(map, {{5.25, 0, 5}, 30, 1});
  EXPECT_TRUE(sight->point_free({4.5, 0, 5}));
  EXPECT_TRUE(sight->point_free({1, 0, 5}));
  EXPECT_FALSE(in_sight_of(map, {{5.25, 0, 5}, 30, 0})->point_free({1, 0, 5}));
}

// What is seen with room beside the line is seen along the line; most of that is seen with room.
TEST(PilotSight, AgreesWithRaysInSmallSteps) {
  const auto map = walled_room();
  Random random(3);
  int seen = 0, only_along_the_line = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d eye(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(1, 9));
    const Vector3d p(random.uniform(-11, 11), random.uniform(-11, 11), random.uniform(0, 11));
    if (eye.x() > 4.5 && eye.x() < 6) continue;
    const bool here = in_sight_of(map, {eye, 100, 1})->point_free(p);
    const bool there = seen_in_small_steps(*map, eye, p);
    EXPECT_TRUE(there || !here) << eye.transpose() << " to " << p.transpose();
    seen += here;
    only_along_the_line += there && !here;
  }
  EXPECT_GT(seen, 800);
  EXPECT_LT(only_along_the_line, 300);
}

}  // namespace
}  // namespace lapwing
