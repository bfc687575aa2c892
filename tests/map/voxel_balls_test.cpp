// SPDX-License-Identifier: Apache-2.0
// Openings by balls: what is narrower than they are goes, what is wider stays.
#include "framework/map/voxel_balls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace lapwing {
namespace {

VoxelBlock block_of(int edge, const std::function<bool(int, int, int)>& marked) {
  VoxelBlock block{{edge, edge, edge}, {}};
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) block.marked.push_back(marked(x, y, z));
  return block;
}

long marked_of(const VoxelBlock& block) {
  return std::count(block.marked.begin(), block.marked.end(), 1);
}

TEST(VoxelBalls, SlabsStayWhereABallFits) {
  for (int thick = 1; thick <= 6; ++thick)
    for (const float radius : {0.5f, 1.5f, 2.5f}) {
      const VoxelBlock slab =
          block_of(16, [&](int, int y, int) { return y >= 5 && y < 5 + thick; });
      VoxelBlock kept = slab;
      keep_balls(kept, std::vector<float>(kept.count(), radius));
      // From the middle voxel's middle to the next one outside.
      const bool fits = (thick + 1) / 2 > radius;
      EXPECT_EQ(marked_of(kept), fits ? 16 * 16 * thick : 0) << thick << ", " << radius;
    }
}

// By all balls, one by one.
TEST(VoxelBalls, AreThoseThatHoldNoOtherVoxel) {
  unsigned state = 7;
  const auto random = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
  const int edge = 12;
  const VoxelBlock given = block_of(edge, [&](int, int, int) { return random() % 40 != 0; });
  std::vector<float> radius;
  for (std::size_t k = 0; k < given.count(); ++k)
    radius.push_back(static_cast<float>(random() % 30) / 10);
  VoxelBlock kept = given;
  keep_balls(kept, radius);
  std::vector<std::uint8_t> expected(given.count(), 0);
  const auto within = [&](const auto& visit, int x, int y, int z, float r) {
    for (int c = 0; c < edge; ++c)
      for (int b = 0; b < edge; ++b)
        for (int a = 0; a < edge; ++a)
          if (static_cast<float>((a - x) * (a - x) + (b - y) * (b - y) + (c - z) * (c - z)) <=
              r * r)
            visit(given.place(a, b, c));
  };
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) {
        const float r = radius[given.place(x, y, z)];
        bool fits = true;
        within([&](std::size_t k) { fits = fits && given.marked[k]; }, x, y, z, r);
        if (fits) within([&](std::size_t k) { expected[k] = 1; }, x, y, z, r);
      }
  EXPECT_EQ(kept.marked, expected);
  EXPECT_GT(marked_of(kept), 0);
  EXPECT_LT(marked_of(kept), marked_of(given));
}

}  // namespace
}  // namespace lapwing
