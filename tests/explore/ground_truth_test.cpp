// SPDX-License-Identifier: Apache-2.0
// The true surface, what has been observed of it, and starts in the space around it.
#include <gtest/gtest.h>

#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

TEST(GroundTruth, HoldsTheSurfaceThatTheSpaceAroundTouches) {
  const YardWorld world;
  EXPECT_TRUE(world.truth.in_space({0, 0, 4}));
  EXPECT_FALSE(world.truth.in_space({10, -3, 3}));  // in a house
  std::size_t ground = 0;
  for (const VoxelKey& key : world.truth.surface()) {
    const Eigen::Vector3d p = world.truth.grid().center(key);
    const bool under = p.x() > 6.6 && p.x() < 13.6 && p.y() > -7.6 && p.y() < 1.6 && p.z() < 0.4;
    EXPECT_FALSE(under) << "the floor of a house is seen by nobody: " << p.transpose();
    ground += p.z() < 0.4;
  }
  EXPECT_GT(ground, 7000u);  // of the 101 x 101 voxels
  EXPECT_LT(ground, 101u * 101u);
}

TEST(GroundTruth, RefusesARegionWithoutSpaceAndAWorldTooLarge) {
  EXPECT_NE(refusal([] { GroundTruth(yard(), {}, 0.01); }).find("2^29"), std::string::npos);
  const Eigen::Vector3d far(0, 0, 30);
  EXPECT_NE(refusal([&] { GroundTruth(yard(), {}, 0.4, far); }).find("far outside"),
            std::string::npos);
}

// The oracle's gain is what an image really adds to what was observed.
TEST(ObservedSurface, GainIsWhatTheImageAdds) {
  const YardWorld world;
  ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto map = YardWorld::new_map();
  double before = 0;
  for (const Viewpoint& view : {world.start, Viewpoint{{2, 1, 3}, 1.2, world.pitch}, world.start,
                                Viewpoint{{-3, 2, 5}, 2.9, world.pitch}}) {
    const double told = observed.gain(view);
    map->integrate(world.settings.sensor.look(world.truth.scene(), view, 1));
    observed.update(*map, view);
    EXPECT_GT(told, 10);
    EXPECT_NEAR(observed.observed() - before, told, 1e-6 * told);
    before = observed.observed();
  }
  // By hand: each voxel's certainty, summed up.
  double sum = 0;
  for (const VoxelKey& key : world.truth.surface())
    sum += 1 - std::exp(-0.5 * map->read(key).observations);
  EXPECT_NEAR(sum, observed.observed(), 1e-6 * sum);
}

TEST(RandomStart, LiesWhereTheBoxIsFree) {
  const YardWorld world;
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Viewpoint start = random_start(world.truth, 6, 10, world.pitch, random);
    EXPECT_TRUE(world.truth.in_space(start.position));
    EXPECT_FALSE(world.truth.scene().box_blocked(start.position, start.position,
                                                 Eigen::Vector3d::Constant(3)));
  }
  EXPECT_NE(
      refusal([&] { random_start(world.truth, 60, 10, world.pitch, random); }).find("100,000"),
      std::string::npos);
  // Where the explorer has to stay anyway.
  Eigen::AlignedBox3d bounds = world.truth.region();
  bounds.max().x() = bounds.center().x();
  for (int k = 0; k < 20; ++k)
    EXPECT_TRUE(
        bounds.contains(random_start(world.truth, 6, 10, world.pitch, random, bounds).position));
  bounds.translate(Eigen::Vector3d(500, 0, 0));
  EXPECT_NE(refusal([&] {
              random_start(world.truth, 6, 10, world.pitch, random, bounds);
            }).find("do not overlap the region"),
            std::string::npos);
}

}  // namespace
}  // namespace lapwing
