// SPDX-License-Identifier: Apache-2.0
// Openings to what nobody saw: their areas, places and widths; and what is none.
#include "framework/map/unknown_edge.h"

#include <gtest/gtest.h>

#include <functional>

#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/map/ray_walk.h"
#include "framework/map/voxel_balls.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

enum class Kind { never, air, wall };

// 16 m x 16 m x 12 m of voxels from the origin, as `kind` says of their middles.
SmallMap map_of(const std::function<Kind(const Vector3d&)>& kind, double edge = 0.5) {
  SmallMap map(edge);
  std::vector<VoxelLeaf> leaves;
  const VoxelGrid& grid = map.grid();
  for (double x = edge / 2; x < 16; x += edge)
    for (double y = edge / 2; y < 16; y += edge)
      for (double z = edge / 2; z < 12; z += edge) {
        const Kind is = kind({x, y, z});
        if (is != Kind::never)
          leaves.push_back({grid.key({x, y, z}), 0, 1, is == Kind::wall ? 2.0f : -2.0f});
      }
  map.import(leaves);
  return map;
}

const Eigen::AlignedBox3d kRegion(Vector3d(1, 1, 1), Vector3d(15, 15, 11));

double sum_of(const std::vector<Opening>& openings) {
  double sum = 0;
  for (const Opening& opening : openings) sum += opening.area;
  return sum;
}

double edge_of(const Map& map, const MeshScene* mesh = nullptr, int threads = 1) {
  EdgeSettings settings{kRegion, {}, 0, threads};
  return sum_of(unknown_openings(map, mesh, settings));
}

TEST(UnknownEdge, IsNoneWhereAllWasMeasured) {
  EXPECT_EQ(edge_of(map_of([](const Vector3d&) { return Kind::air; })), 0);
  // Nobody saw into the ground, but its surface.
  EXPECT_EQ(edge_of(map_of([](const Vector3d& p) {
              return p.z() > 4 ? Kind::air : p.z() > 3.5 ? Kind::wall : Kind::never;
            })),
            0);
}

TEST(UnknownEdge, IsAsLargeAsTheFaceThatHides) {
  const SmallMap level =
      map_of([](const Vector3d& p) { return p.z() > 4 ? Kind::air : Kind::never; });
  EXPECT_NEAR(edge_of(level), 14 * 14, 1e-9);
  // Not in stairs, which would have one and a half times the area.
  const SmallMap slope =
      map_of([](const Vector3d& p) { return p.z() > 2 + 0.5 * p.x() ? Kind::air : Kind::never; });
  EXPECT_NEAR(edge_of(slope, nullptr, 2), 14 * 14 * std::sqrt(1.25), 14);
  EXPECT_EQ(edge_of(slope), edge_of(slope, nullptr, 2));
}

TEST(UnknownEdge, CountsAPocketOnBothSidesAndNoSpeck) {
  // A closed box, wherever it lies among the cubes that faces are added in.
  for (const double moved : {0.0, 0.5, 1.5}) {
    const double edge = edge_of(map_of([&](const Vector3d& p) {
      const Vector3d from = p - Vector3d(5 + moved, 5, 5);
      return from.minCoeff() > 0 && from.maxCoeff() < 3 ? Kind::never : Kind::air;
    }));
    EXPECT_GT(edge, 0.5 * 6 * 9) << moved;
    EXPECT_LE(edge, 6 * 9) << moved;
  }
  EXPECT_EQ(edge_of(map_of([](const Vector3d& p) {
              return (p - Vector3d(6.25, 6.25, 6.25)).norm() < 0.1 ? Kind::never : Kind::air;
            })),
            0);
}

TEST(UnknownEdge, IsNotWhereTheMeshKnowsTheSurface) {
  const SmallMap level =
      map_of([](const Vector3d& p) { return p.z() > 4 ? Kind::air : Kind::never; });
  TriangleMesh mesh;  // over half of it
  mesh.vertices = {{0, 0, 4}, {8, 0, 4}, {8, 16, 4}, {0, 16, 4}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const MeshScene known(mesh);
  EXPECT_NEAR(edge_of(level, &known), 14 * 7, 14);
}

// A wall along x = 10 with a gate of 4 m x 3 m and a slit of 8 m x 0.75 m.
TEST(UnknownEdge, TellsTheOpeningsApartWithPlaceSizeAndWidth) {
  const SmallMap wall = map_of(
      [](const Vector3d& p) {
        const bool gate = p.y() > 2 && p.y() < 6 && p.z() > 2 && p.z() < 5;
        const bool slit = p.y() > 5 && p.y() < 13 && p.z() > 8 && p.z() < 8.75;
        if (p.x() < 10) return Kind::air;
        return p.x() < 10.5 && !gate && !slit ? Kind::wall : Kind::never;
      },
      0.25);
  EdgeSettings settings{kRegion, {}, 2, 2};
  const std::vector<Opening> openings = unknown_openings(wall, nullptr, settings);
  ASSERT_EQ(openings.size(), 2u);
  // One voxel beside the wall is left out on every side.
  EXPECT_NEAR(openings[0].area, 3.5 * 2.5, 1e-9);
  EXPECT_NEAR(openings[1].area, 7.5 * 0.25, 1e-9);
  EXPECT_LT((openings[0].place - Vector3d(10.125, 4, 3.5)).norm(), 0.5);
  EXPECT_TRUE(openings[0].passable);
  EXPECT_FALSE(openings[1].passable);
  EXPECT_EQ(openings[0].voxels.size(), 14u * 10u);
  settings.width = 5;
  EXPECT_FALSE(unknown_openings(wall, nullptr, settings)[0].passable);
}

// A solid block with its skin, and behind a corner of the skin half a metre of air that is none: a
// vehicle that fits into the block does not fit between the skin and what was never measured.
TEST(UnknownEdge, AirThatLeaksIntoASolidIsNoPassage) {
  const auto leaking = [](double leak) {
    return map_of(
        [leak](const Vector3d& p) {
          const double in = (p - Vector3d(8, 8, 2)).minCoeff();
          if (in < 0) return Kind::air;
          if (in < 0.125) return Kind::wall;
          const bool corner = std::max(p.x(), p.y()) < 8.125 + leak && p.z() > 4 && p.z() < 8;
          return corner ? Kind::air : Kind::never;
        },
        0.125);
  };
  EdgeSettings settings{kRegion, {}, 2, 2};
  const std::vector<Opening> small = unknown_openings(leaking(0.5), nullptr, settings);
  ASSERT_EQ(small.size(), 1u);
  EXPECT_GT(small[0].area, 1);
  EXPECT_FALSE(small[0].passable);
  const std::vector<Opening> room = unknown_openings(leaking(3), nullptr, settings);
  ASSERT_EQ(room.size(), 1u);
  EXPECT_TRUE(room[0].passable);
}

// Never measured all round, so that the mean of its faces lies within: the place is on the largest.
TEST(UnknownEdge, ThePlaceOfWhatGoesRoundLiesOnItsLargestFace) {
  const SmallMap box = map_of([](const Vector3d& p) {
    const Vector3d from = p - Vector3d(5, 5, 3), to = Vector3d(11, 8, 7) - p;
    return from.minCoeff() > 0 && to.minCoeff() > 0 ? Kind::never : Kind::air;
  });
  const EdgeSettings settings{kRegion, {}, 0, 1};
  const std::vector<Opening> found = unknown_openings(box, nullptr, settings);
  ASSERT_EQ(found.size(), 1u);
  const Vector3d& place = found[0].place;  // 6 m x 4 m, to the south
  EXPECT_NEAR(place.y(), 5.25, 1e-9);
  EXPECT_NEAR(place.x(), 8, 0.5);
  EXPECT_NEAR(place.z(), 5, 0.5);
}

// Sheets that no ray came to, one of 0.5 m and one of 2 m, across an image's axis.
TEST(UnknownEdge, IsNotAGapBetweenRays) {
  const SmallMap sheets = map_of(
      [](const Vector3d& p) {
        const bool thin = p.y() > 4 && p.y()<4.5, thick = p.y()> 8 && p.y() < 10;
        return thin || thick ? Kind::never : Kind::air;
      },
      0.25);
  EdgeSettings settings{kRegion, {}, 0, 1};
  EXPECT_NEAR(sum_of(unknown_openings(sheets, nullptr, settings)), 4 * 14 * 10, 1);
  // Gaps are 0.5 m wide at 7 m, in the middle, and 1.1 m at the far end; 0.3 m beside the image.
  const Pinhole few{60, 45, 20, 20, 29.5, 22};
  settings.rays.images = {{camera_pose({-0.5, 7, 6}, 0, 0), few, 60}};
  settings.rays.elsewhere = 0.3;
  EXPECT_NEAR(sum_of(unknown_openings(sheets, nullptr, settings)), 2 * 14 * 10, 1);
  // Where all gaps may be as wide as the thick one, nothing can be told.
  settings.rays = {{}, 2};
  EXPECT_EQ(sum_of(unknown_openings(sheets, nullptr, settings)), 0);
}

TEST(UnknownEdge, RefusesARegionThatIsTooLarge) {
  const SmallMap air = map_of([](const Vector3d&) { return Kind::air; });
  EdgeSettings settings{
      Eigen::AlignedBox3d(Vector3d::Constant(-500), Vector3d::Constant(500)), {}, 0, 1};
  EXPECT_THROW(unknown_openings(air, nullptr, settings), InputError);
}

// What exact rays leave of a box: air where they pass, surface where they end.
class RayMap final : public PlainMap {
 public:
  RayMap(double resolution, const Eigen::AlignedBox3d& box)
      : PlainMap(settings_with(resolution)), lower_(grid().key(box.min())) {
    const VoxelKey upper = grid().key(box.max());
    for (int axis = 0; axis < 3; ++axis) block_.size[axis] = upper[axis] - lower_[axis] + 1;
    block_.marked.resize(block_.count() + 1);
  }

  void look(const MeshScene& scene, const MeasuringImage& image) {
    for (const Vector3d& ray : tiled_pixel_rays(image.pinhole)) {
      const Vector3d direction = image.camera.orientation * ray;
      const double end = scene.cast({image.camera.position, direction}).distance;
      RayWalk walk(grid(), image.camera.position, direction);
      VoxelKey last = walk.key();
      for (; walk.entered < std::min(end, 60.0); walk.advance()) set(last = walk.key(), kPassed);
      if (end < 60) set(last, kEnded);
    }
  }
  VoxelReading read(const VoxelKey& key) const override {
    const std::uint8_t mark = block_.marked[place_of(key)];
    if (mark == 0) return {};
    return {true, VoxelState::unknown, mark == kEnded ? 2.0f : -2.0f, 1};
  }

 private:
  static constexpr std::uint8_t kPassed = 1, kEnded = 2;

  // The last one, which is never marked, for all outside the box.
  std::size_t place_of(const VoxelKey& key) const {
    int at[3];
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = key[axis] - lower_[axis];
      if (at[axis] < 0 || at[axis] >= block_.size[axis]) return block_.count();
    }
    return block_.place(at[0], at[1], at[2]);
  }
  void set(const VoxelKey& key, std::uint8_t seen) {
    const std::size_t place = place_of(key);
    if (place < block_.count()) block_.marked[place] = std::max(block_.marked[place], seen);
  }

  VoxelKey lower_;
  VoxelBlock block_;
};

// A court of 20 m x 20 m between walls of 8 m; to the east a block, with a hall of 8 m behind a
// gate of 4 m x 3 m where there is one.
struct Court {
  std::shared_ptr<const MeshScene> all, known;  // known: without the inside of the hall
  EdgeSettings settings{
      Eigen::AlignedBox3d(Vector3d(-10.5, -10.5, -0.5), Vector3d(19.5, 10.5, 9)), {}, 2, 2};

  explicit Court(bool hall) {
    MeshBuilder outside;
    outside.quad({-90, -90, 0}, {90, -90, 0}, {90, 90, 0}, {-90, 90, 0});
    outside.box({-11, -11, 0}, {-10, 11, 8});
    outside.box({-10, -11, 0}, {20, -10, 8});
    outside.box({-10, 10, 0}, {20, 11, 8});
    outside.quad({10, -10, 8}, {20, -10, 8}, {20, 10, 8}, {10, 10, 8});
    outside.quad({20, -10, 0}, {20, 10, 0}, {20, 10, 8}, {20, -10, 8});
    const auto front = [&](double y0, double y1, double z0, double z1) {
      outside.quad({10, y0, z0}, {10, y1, z0}, {10, y1, z1}, {10, y0, z1});
    };
    front(-10, -2, 0, 8);
    front(2, 10, 0, 8);
    front(-2, 2, 3, 8);
    if (!hall) front(-2, 2, 0, 3);
    known = std::make_shared<MeshScene>(outside.take());
    TriangleMesh mesh = known->mesh();
    if (hall) {
      MeshBuilder inside;
      inside.box({10, -3, 0}, {18, -2, 4});
      inside.box({10, 2, 0}, {18, 3, 4});
      inside.box({10, -2, 3}, {18, 2, 4});
      inside.box({17.5, -2, 0}, {18, 2, 3});
      const TriangleMesh more = inside.take();
      const auto first = static_cast<std::int32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
      for (const auto& t : more.triangles)
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
      mesh.colors.clear();
    }
    all = std::make_shared<MeshScene>(std::move(mesh));
  }

  // Looked into from above, four ways, through so many pixels a row.
  std::vector<Opening> seen(int across, double resolution, bool told = true) {
    const Pinhole pinhole = centered_pinhole(across, across * 3 / 4, 1.4);
    RayMap map(resolution, {Vector3d(-12, -12, -2), Vector3d(22, 12, 16)});
    settings.rays.images.clear();
    for (const double x : {-9.0, -3.0, 3.0, 9.0, 15.0})
      for (const double y : {-9.0, 0.0, 9.0})
        for (int k = 0; k < 4; ++k) {
          const MeasuringImage image{camera_pose({x, y, 15}, k * EIGEN_PI / 2, -0.9), pinhole, 90};
          map.look(*all, image);
          if (told) settings.rays.images.push_back(image);
        }
    return unknown_openings(map, known.get(), settings);
  }
};

TEST(UnknownEdge, AClosedCourtSeenByFewPixelsHidesNothing) {
  Court court(false);
  for (const double resolution : {0.2, 0.4})
    EXPECT_LT(sum_of(court.seen(60, resolution)), 1) << resolution;
  // Where nothing is told of the rays, gaps between them are taken for openings.
  EXPECT_GT(sum_of(court.seen(60, 0.2, false)), 10);
}

TEST(UnknownEdge, ADarkHallStaysWhateverTheResolutionAndThePixels) {
  Court court(true);
  // Light comes in under the lintel at the slope of the lowest view: from (-9, 15) past (10, 3).
  const double deep = 3 * 19 / 12.0;
  const double mouth = 4 * std::hypot(3, deep);
  for (const auto& [resolution, across] : {std::pair{0.2, 60}, {0.2, 160}, {0.4, 60}}) {
    const std::vector<Opening> openings = court.seen(across, resolution);
    ASSERT_FALSE(openings.empty());
    EXPECT_GT(openings[0].area, 0.5 * mouth) << resolution << " m, " << across << " pixels";
    EXPECT_LT(openings[0].area, 1.1 * mouth) << resolution << " m, " << across << " pixels";
    EXPECT_LT(sum_of(openings), openings[0].area + 1);
    EXPECT_TRUE(openings[0].passable);
    EXPECT_LT((openings[0].place - Vector3d(10 + deep / 2, 0, 1.5)).norm(), 1.5)
        << openings[0].place.transpose();
  }
}

}  // namespace
}  // namespace lapwing
