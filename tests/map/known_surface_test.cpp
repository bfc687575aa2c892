// SPDX-License-Identifier: Apache-2.0
// How much surface is known and seen.
#include "framework/map/known_surface.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lapwing {
namespace {

using Eigen::Vector3d;

const Eigen::AlignedBox3d kSurfaceRegion(Vector3d(1, 1, 1), Vector3d(15, 15, 11));

TEST(SurfaceAreas, AreOfTrianglesByTheVoxelsThatTheyPass) {
  TriangleMesh mesh;  // three squares of 2 m in a row, and one outside the region
  for (const double x : {2.0, 5.0, 8.0, 20.0}) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const auto& [dx, dy] : {std::pair{0, 0}, {2, 0}, {2, 2}, {0, 2}})
      mesh.vertices.emplace_back(x + dx, 4 + dy, 4.1);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  const VoxelGrid grid(0.5);
  std::vector<VoxelShare> voxels;
  for (double x = 2.25; x < 7; x += 0.5)  // the first two are visible, the first is seen
    for (double y = 4.25; y < 6; y += 0.5)
      voxels.push_back({grid.key({x, y, 4.75}), x < 4 ? 0.5f : 0.0f});
  std::reverse(voxels.begin(), voxels.end());
  const std::vector<float> shares = shares_of_triangles(mesh, kSurfaceRegion, grid, voxels);
  EXPECT_EQ(shares, (std::vector<float>{0.5f, 0.5f, 0, 0, kNeverVisible, kNeverVisible,
                                        kOutsideRegion, kOutsideRegion}));
  const SurfaceAreas areas = areas_of(mesh, shares, kSurfaceRegion);
  EXPECT_DOUBLE_EQ(areas.known, 12);
  EXPECT_DOUBLE_EQ(areas.visible, 8);
  EXPECT_DOUBLE_EQ(areas.seen, 4);
  // What lies beside the region is another place; what lies over or under it is missing.
  EXPECT_DOUBLE_EQ(areas.above + areas.below, 0);
  const Eigen::AlignedBox3d low(Vector3d(1, 1, 1), Vector3d(15, 15, 4));
  const SurfaceAreas cut = areas_of(mesh, shares_of_triangles(mesh, low, grid, voxels), low);
  EXPECT_DOUBLE_EQ(cut.above, 12);
  EXPECT_DOUBLE_EQ(cut.below, 0);
  const Eigen::AlignedBox3d high(Vector3d(1, 1, 5), Vector3d(15, 15, 9));
  EXPECT_DOUBLE_EQ(areas_of(mesh, shares_of_triangles(mesh, high, grid, voxels), high).below, 12);
}

}  // namespace
}  // namespace lapwing
