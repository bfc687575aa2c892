// How much surface is known, seen, and not known at all.
#include "framework/map/known_surface.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/map/small_map.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

enum class Kind { never, air, wall };

// 16 m x 16 m x 12 m of voxels of 0.5 m from the origin, as `kind` says of their middles.
SmallMap map_of(const std::function<Kind(const Vector3d&)>& kind) {
  SmallMap map(0.5);
  std::vector<VoxelLeaf> leaves;
  const VoxelGrid& grid = map.grid();
  for (double x = 0.25; x < 16; x += 0.5)
    for (double y = 0.25; y < 16; y += 0.5)
      for (double z = 0.25; z < 12; z += 0.5) {
        const Kind is = kind({x, y, z});
        if (is != Kind::never)
          leaves.push_back({grid.key({x, y, z}), 0, 1, is == Kind::wall ? 2.0f : -2.0f});
      }
  map.import(leaves);
  return map;
}

const Eigen::AlignedBox3d kRegion(Vector3d(1, 1, 1), Vector3d(15, 15, 11));

TEST(UnknownEdge, IsNoneWhereAllWasMeasured) {
  const SmallMap open = map_of([](const Vector3d&) { return Kind::air; });
  EXPECT_EQ(unknown_edge(open, nullptr, kRegion, 1), 0);
  // Nobody saw into the ground, but its surface.
  const SmallMap ground = map_of([](const Vector3d& p) {
    return p.z() > 4 ? Kind::air : p.z() > 3.5 ? Kind::wall : Kind::never;
  });
  EXPECT_EQ(unknown_edge(ground, nullptr, kRegion, 1), 0);
}

TEST(UnknownEdge, IsAsLargeAsTheFaceThatHides) {
  const SmallMap level =
      map_of([](const Vector3d& p) { return p.z() > 4 ? Kind::air : Kind::never; });
  EXPECT_NEAR(unknown_edge(level, nullptr, kRegion, 1), 14 * 14, 1e-9);
  // Not in stairs, which would have one and a half times the area.
  const SmallMap slope =
      map_of([](const Vector3d& p) { return p.z() > 2 + 0.5 * p.x() ? Kind::air : Kind::never; });
  EXPECT_NEAR(unknown_edge(slope, nullptr, kRegion, 2), 14 * 14 * std::sqrt(1.25), 14);
  EXPECT_EQ(unknown_edge(slope, nullptr, kRegion, 1), unknown_edge(slope, nullptr, kRegion, 2));
}

TEST(UnknownEdge, CountsAPocketOnBothSidesAndNoSpeck) {
  // A closed box, wherever it lies among the cubes that faces are added in.
  for (const double moved : {0.0, 0.5, 1.5}) {
    const SmallMap pocket = map_of([&](const Vector3d& p) {
      const Vector3d from = p - Vector3d(5 + moved, 5, 5);
      return from.minCoeff() > 0 && from.maxCoeff() < 3 ? Kind::never : Kind::air;
    });
    const double edge = unknown_edge(pocket, nullptr, kRegion, 1);
    EXPECT_GT(edge, 0.5 * 6 * 9) << moved;
    EXPECT_LE(edge, 6 * 9) << moved;
  }
  const SmallMap speck = map_of([](const Vector3d& p) {
    return (p - Vector3d(6.25, 6.25, 6.25)).norm() < 0.1 ? Kind::never : Kind::air;
  });
  EXPECT_EQ(unknown_edge(speck, nullptr, kRegion, 1), 0);
}

TEST(UnknownEdge, IsNotWhereTheMeshKnowsTheSurface) {
  const SmallMap level =
      map_of([](const Vector3d& p) { return p.z() > 4 ? Kind::air : Kind::never; });
  TriangleMesh mesh;  // over half of it
  mesh.vertices = {{0, 0, 4}, {8, 0, 4}, {8, 16, 4}, {0, 16, 4}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const MeshScene known(mesh);
  EXPECT_NEAR(unknown_edge(level, &known, kRegion, 1), 14 * 7, 14);
}

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
  const std::vector<float> shares = shares_of_triangles(mesh, kRegion, grid, voxels);
  EXPECT_EQ(shares, (std::vector<float>{0.5f, 0.5f, 0, 0, kNeverVisible, kNeverVisible,
                                        kOutsideRegion, kOutsideRegion}));
  const SurfaceAreas areas = areas_of(mesh, shares, kRegion);
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
