// SPDX-License-Identifier: Apache-2.0
// Which views motions join, and from where most of them are reached.
#include "framework/view/tour_start.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"

namespace lapwing {
namespace {

ViewMotion joining(int a, int b) {
  ViewMotion motion;
  motion.a = a;
  motion.b = b;
  return motion;
}

std::vector<Viewpoint> in_a_row(int count) {
  std::vector<Viewpoint> views(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) views[static_cast<std::size_t>(k)].position.x() = k;
  return views;
}

// 0 - 1 in a closed court; 2 alone; 3 to 8 outside, joined in an order that merges islands late.
const std::vector<ViewMotion> kMotions{joining(0, 1), joining(3, 4), joining(5, 6),
                                       joining(7, 8), joining(4, 5), joining(6, 7)};

TEST(ViewIslands, CountWhatIsJoinedDirectlyOrThroughOthers) {
  const ViewIslands islands(9, kMotions);
  EXPECT_EQ(islands.joined(0), 2);
  EXPECT_EQ(islands.joined(1), 2);
  EXPECT_EQ(islands.joined(2), 1);
  for (int v = 3; v < 9; ++v) EXPECT_EQ(islands.joined(v), 6) << v;
}

TEST(ViewIslands, TheStartIsTheFirstThatMostAreJoinedTo) {
  const ViewIslands islands(9, kMotions);
  EXPECT_EQ(islands.best_start(9), 3);
  EXPECT_EQ(islands.best_start(3), 0);  // of the first three
  EXPECT_EQ(ViewIslands(2, {}).best_start(2), 0);
  EXPECT_THROW(islands.best_start(0), Error);
  EXPECT_THROW(islands.best_start(10), Error);
}

TEST(ViewIslands, TheLargestOtherIslandIsNamedByAViewInItsMiddle) {
  const ViewIslands islands(9, kMotions);
  const auto outside = islands.largest_beside(0, in_a_row(9));
  ASSERT_TRUE(outside);
  EXPECT_EQ(outside->views, 6);
  EXPECT_EQ(outside->middle, 5);  // 5.5 is the mean; the first of two that are as near
  const auto court = islands.largest_beside(4, in_a_row(9));
  ASSERT_TRUE(court);
  EXPECT_EQ(court->views, 2);
  EXPECT_FALSE(ViewIslands(2, std::vector{joining(0, 1)}).largest_beside(0, in_a_row(2)));
}

}  // namespace
}  // namespace lapwing
