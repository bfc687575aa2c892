// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/view/visible_voxels.h"
#include "tests/view/view_world.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

SightSettings sight_settings() {
  SightSettings s;
  s.pinhole = {200, 150, 115, 115, 99.5, 74.5};
  s.region = AlignedBox3d(Vector3d(-9, -9, 0), Vector3d(9, 9, 9));
  return s;
}

const Viewpoint kAhead{{-5, 0.2, 5.1}, 0, 0};

TEST(VisibleVoxels, OfAWallAreTheVoxelsInFrontAlone) {
  const auto map = walled_room();
  const VisibleVoxels visible(map, wall_face(), sight_settings());
  const std::vector<SeenVoxel> seen = visible.seen_from(kAhead);
  std::size_t wall = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (k > 0) {
      EXPECT_LT(seen[k - 1].voxel, seen[k].voxel);
    }
    const Vector3d center = map->grid().center(seen[k].voxel);
    EXPECT_TRUE(sight_settings().region.contains(center));
    // Nothing behind the wall and nothing free: only the wall, as the region ends inside the room.
    EXPECT_NEAR(center.x(), 5.25, 1e-9);
    EXPECT_LT(std::abs(center.y()), 4);
    ++wall;
  }
  // 16 across; within 10.25 m * 75 / 115 = 6.7 m up and down, so the whole height of the region.
  EXPECT_EQ(wall, 16u * 18u);
}

TEST(VisibleVoxels, AngleDistanceAndSizeAreThoseOfTheGeometry) {
  const auto map = walled_room();
  const VisibleVoxels visible(map, wall_face(), sight_settings());
  for (const SeenVoxel& seen : visible.seen_from(kAhead)) {
    const Vector3d towards = map->grid().center(seen.voxel) - kAhead.position;
    EXPECT_NEAR(seen.sight.distance, towards.norm(), 1e-5);
    EXPECT_NEAR(seen.sight.pixels, 115 * 0.5 / towards.norm(), 1e-5);
    ASSERT_TRUE(seen.sight.incidence.has_value());
    EXPECT_NEAR(*seen.sight.incidence, std::acos(towards.x() / towards.norm()), 1e-4);
  }
}

// Voxel by voxel the same as all at once, also of what is not seen, from near and far.
TEST(VisibleVoxels, OneVoxelIsSeenAsAmongAll) {
  const auto map = walled_room();
  SightSettings s = sight_settings();
  s.region = AlignedBox3d(Vector3d(-9, -9, 0.5), Vector3d(12, 9, 9));
  s.across = 50;
  s.usable_range = 14;
  s.usable_incidence = radians(50);
  const VisibleVoxels visible(map, wall_face(), s);
  const VoxelGrid& grid = map->grid();
  for (const Viewpoint& view : {kAhead, Viewpoint{{-8, -6, 8}, 0.4, -0.5},
                                Viewpoint{{4.9, 1.6, 3}, 0.3, -0.2}, Viewpoint{{8, 0, 5}, 0, 0}}) {
    const std::vector<SeenVoxel> all = visible.seen_from(view);
    EXPECT_FALSE(all.empty());
    std::size_t found = 0;
    for (double x = -8.75; x < 12; x += 0.5)
      for (double y = -8.75; y < 9; y += 0.5)
        for (double z = 0.75; z < 9; z += 0.5) {
          const VoxelKey key = grid.key({x, y, z});
          const auto one = visible.sight_of(view, key);
          if (!one) continue;
          ASSERT_LT(found, all.size());
          ASSERT_EQ(all[found].voxel, key);
          EXPECT_EQ(all[found].sight.distance, one->distance);
          EXPECT_EQ(all[found].sight.pixels, one->pixels);
          EXPECT_EQ(all[found].sight.incidence, one->incidence);
          ++found;
        }
    EXPECT_EQ(found, all.size());
  }
}

TEST(VisibleVoxels, OfAPartOfTheRegionIsThatPartOfAll) {
  const auto map = walled_room();
  const std::vector<SeenVoxel> all =
      VisibleVoxels(map, wall_face(), sight_settings()).seen_from(kAhead);
  SightSettings s = sight_settings();
  s.within = AlignedBox3d(Vector3d(-20, 0, 2), Vector3d(20, 2.1, 20));
  const VisibleVoxels visible(map, wall_face(), s);
  std::vector<VoxelKey> expected, found;
  for (const SeenVoxel& seen : all) {
    const Vector3d center = map->grid().center(seen.voxel);
    if (center.y() > 0 && center.y() < 2.5 && center.z() > 2) expected.push_back(seen.voxel);
  }
  for (const SeenVoxel& seen : visible.seen_from(kAhead)) {
    found.push_back(seen.voxel);
    EXPECT_EQ(visible.weight(seen.voxel), 1);
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(visible.weight(all.front().voxel), 0) << "beside the part";
  s.within = AlignedBox3d(Vector3d(30, 0, 2), Vector3d(40, 2, 20));
  EXPECT_THROW(VisibleVoxels(map, wall_face(), s), InputError);
}

TEST(VisibleVoxels, OnlyWhatIsOfUseIsSeen) {
  const auto map = walled_room();
  const std::vector<SeenVoxel> all =
      VisibleVoxels(map, wall_face(), sight_settings()).seen_from(kAhead);
  SightSettings s = sight_settings();
  s.usable_range = 11;
  s.usable_incidence = radians(20);
  const VisibleVoxels visible(map, wall_face(), s);
  std::vector<VoxelKey> expected, found;
  for (const SeenVoxel& seen : all)
    if (seen.sight.distance <= 11 && *seen.sight.incidence <= radians(20))
      expected.push_back(seen.voxel);
  for (const SeenVoxel& seen : visible.seen_from(kAhead)) found.push_back(seen.voxel);
  EXPECT_EQ(found, expected);
  EXPECT_GT(expected.size(), 20u);
  EXPECT_LT(expected.size(), all.size());
  EXPECT_EQ(visible.voxels_from(kAhead).size(), all.size()) << "of use or not";
  // Where the angle is not known it says nothing.
  s.usable_range = std::numeric_limits<double>::infinity();
  EXPECT_EQ(VisibleVoxels(map, nullptr, s).seen_from(kAhead).size(), all.size());
  for (double SightSettings::*limit :
       {&SightSettings::usable_range, &SightSettings::usable_incidence}) {
    SightSettings none = sight_settings();
    none.*limit = 0;
    EXPECT_THROW(VisibleVoxels(map, nullptr, none), InputError);
  }
}

TEST(VisibleVoxels, WithoutASurfaceNearbyTheAngleIsNotKnown) {
  const auto map = walled_room();
  for (const auto& prior : {std::shared_ptr<MeshScene>(), wall_face(-1), wall_face(2)})
    for (const SeenVoxel& seen : VisibleVoxels(map, prior, sight_settings()).seen_from(kAhead))
      EXPECT_FALSE(seen.sight.incidence.has_value());
}

TEST(VisibleVoxels, TheUnknownIsSeenTooAndTheFreeIsNot) {
  const auto map = walled_room();
  SightSettings s = sight_settings();
  s.region = AlignedBox3d(Vector3d(-30, -30, -5), Vector3d(30, 30, 30));
  int unknown = 0;
  for (const SeenVoxel& seen : VisibleVoxels(map, nullptr, s).seen_from(kAhead)) {
    const VoxelState state = map->read(seen.voxel).state;
    EXPECT_NE(state, VoxelState::free);
    unknown += state == VoxelState::unknown;
  }
  EXPECT_GT(unknown, 100);
}

TEST(VisibleVoxels, CoarseViewsSeeAPartOfTheSame) {
  const VisibleVoxels visible(walled_room(), nullptr, sight_settings());
  std::vector<VoxelKey> fine;
  for (const SeenVoxel& seen : visible.seen_from(kAhead)) fine.push_back(seen.voxel);
  const std::vector<VoxelKey> coarse = visible.seen_coarsely_from(kAhead, 40);
  EXPECT_GT(coarse.size(), fine.size() / 2);
  EXPECT_TRUE(std::includes(fine.begin(), fine.end(), coarse.begin(), coarse.end()));
}

TEST(Matchable, IsTheShareOfWhatBothSee) {
  const auto keys = [](int from, int to) {
    std::vector<VoxelKey> list;
    for (int k = from; k < to; ++k) list.push_back({static_cast<std::uint16_t>(k), 0, 0});
    return list;
  };
  EXPECT_TRUE(matchable(keys(0, 10), keys(6, 16), 0.4));   // 4 of 10
  EXPECT_FALSE(matchable(keys(0, 10), keys(7, 17), 0.4));  // 3 of 10
  EXPECT_TRUE(matchable(keys(0, 4), keys(0, 16), 0.4));    // 4 of a mean of 10
  EXPECT_FALSE(matchable(keys(0, 3), keys(0, 16), 0.4));
  EXPECT_FALSE(matchable({}, {}, 0.4));
}

TEST(VisibleVoxels, WhatMakesNoSenseIsRefused) {
  const auto map = walled_room();
  SightSettings s = sight_settings();
  s.region = AlignedBox3d();
  EXPECT_THROW(VisibleVoxels(map, nullptr, s), InputError);
  s = sight_settings();
  s.range = 0;
  EXPECT_THROW(VisibleVoxels(map, nullptr, s), InputError);
  s = sight_settings();
  s.region = AlignedBox3d(Vector3d(0.3, 0, 0), Vector3d(0.4, 9, 9));  // no voxel's centre
  EXPECT_THROW(VisibleVoxels(map, nullptr, s), InputError);
  EXPECT_THROW(VisibleVoxels(map, nullptr, sight_settings()).seen_coarsely_from(kAhead, 0),
               InputError);
}

}  // namespace
}  // namespace lapwing
