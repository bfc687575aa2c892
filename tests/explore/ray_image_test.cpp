// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/explore/sample_file.h"
#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

// One ray along +x in voxels of 1 m, of a camera in the middle of a voxel.
struct OneRay {
  std::unique_ptr<Map> map;
  EpisodeView known;

  OneRay() {
    Value given = Value::map();
    given.set("resolution", 1.0);
    given.set("maximum_range", 10.0);
    given.set("observations", true);
    map = plugins().create<Map>("brick", given);
    known.map = map.get();
    known.pinhole = {2, 2, 1e6, 1e6, 0.5, 0.5};
    known.range = 10;
  }
  void set(int x, double log_odds, std::uint16_t observations) {
    const VoxelLeaf leaf{map->grid().key({x + 0.5, 0.5, 0.5}), 0, observations,
                         static_cast<float>(log_odds)};
    map->import({&leaf, 1});
  }
  // Of one of the four rays, which are all alike.
  std::vector<float> read() const {
    const RayShape shape{2, 2};
    std::vector<float> image(shape.size());
    sample_rays(known, {{0.5, 0.5, 0.5}, 0, 0}, shape, image);
    return {image.begin(), image.begin() + RayShape::kChannels};
  }
};

TEST(RayImage, TellsWhatARayMeets) {
  OneRay ray;
  const double free = -2, wall = 2;
  for (int x = 0; x < 4; ++x) ray.set(x, free, static_cast<std::uint16_t>(x));
  ray.set(4, wall, 3);
  ray.set(6, free, 1);
  ray.set(7, wall, 2);
  const std::vector<float> told = ray.read();
  const double p = 1 / (1 + std::exp(-2.0)), q = 1 - p;
  const double left2 = ray.map->uncertainty(2), left3 = ray.map->uncertainty(3);
  EXPECT_NEAR(told[0], 0.35, 1e-6);  // 3.5 m to the face of voxel 4, of 10 m
  EXPECT_EQ(told[1], 0);
  EXPECT_NEAR(told[2], p, 1e-6);
  EXPECT_NEAR(told[3], p * left3, 1e-6);
  EXPECT_NEAR(told[4], left3, 1e-6);  // of voxel 3
  EXPECT_NEAR(told[5], left2, 1e-6);  // of voxel 2
  const auto segment = [&](int s, int c) {
    return told[static_cast<std::size_t>(RayShape::kFirst + RayShape::kOfSegment * s + c)];
  };
  EXPECT_EQ(segment(0, 0), 1);  // voxel 5 was never measured
  EXPECT_EQ(segment(1, 0), 0);
  EXPECT_NEAR(segment(1, 1), q, 1e-6);  // voxel 6 is free
  EXPECT_NEAR(segment(2, 1), p, 1e-6);  // voxel 7 is a wall
  EXPECT_NEAR(segment(2, 2), p * left2, 1e-6);
  EXPECT_EQ(segment(3, 0), 1);          // voxel 8
  EXPECT_NEAR(segment(4, 0), 1, 1e-6);  // voxels 9 and 10, which begins at 9.5 m
  EXPECT_EQ(segment(5, 0), 0);          // beyond the range
}

TEST(RayImage, TellsOfNothingWhereAllIsFree) {
  OneRay ray;
  for (int x = 0; x < 12; ++x) ray.set(x, -2, 1);
  const std::vector<float> told = ray.read();
  EXPECT_EQ(told[0], 1);
  for (std::size_t k = 1; k < told.size(); ++k) EXPECT_EQ(told[k], 0) << k;
}

TEST(RayImage, WhatWasNeverMeasuredIsNoWall) {
  OneRay ray;
  const std::vector<float> told = ray.read();
  EXPECT_EQ(told[0], 0);
  EXPECT_EQ(told[1], 1);
  EXPECT_EQ(told[2], 0);
  for (int s = 0; s + 3 < RayShape::kSegments; ++s)
    EXPECT_GT(told[static_cast<std::size_t>(RayShape::kFirst + RayShape::kOfSegment * s)], 0) << s;
}

// What images see lies in the cells that show it, and is all that they gain.
TEST(RayImage, PartsOfAGainAreItsWhole) {
  const YardWorld world;
  ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto map = YardWorld::new_map();
  const RayShape shape;
  std::vector<float> cells(static_cast<std::size_t>(shape.rays()));
  for (const double yaw : {0.3, 0.5, 2.0}) {
    const Viewpoint view{{0, 0, 4}, yaw, world.pitch};
    const double gain = observed.gain(view);
    view_targets(observed, view, world.settings.sensor.pinhole, shape, cells);
    ASSERT_GT(gain, 10);
    EXPECT_NEAR(std::accumulate(cells.begin(), cells.end(), 0.0), gain, 1e-3);
    // The ground is seen in the lower half.
    const auto half = cells.begin() + shape.rays() / 2;
    EXPECT_GT(std::accumulate(half, cells.end(), 0.0), 0.5 * gain);
    map->integrate(world.settings.sensor.look(world.truth.scene(), view, 1));
    observed.update(*map, view);
  }
}

TEST(RayImage, CellsAreThoseOfTheRays) {
  const Pinhole pinhole = centered_pinhole(160, 120, EIGEN_PI / 2);
  const RayShape shape{20, 15};
  EXPECT_EQ(ray_cell(shape, pinhole, {-0.99, -0.74, 1}), 0);
  EXPECT_EQ(ray_cell(shape, pinhole, {0.99, 0.74, 1}), shape.rays() - 1);
  EXPECT_EQ(ray_cell(shape, pinhole, {0.05, 0, 1}), 7 * 20 + 10);
  EXPECT_EQ(ray_cell(shape, pinhole, {-5, -5, 1}), 0) << "outside: the nearest";
}

TEST(RayImage, ShapesWithoutSenseAreRefused) {
  EXPECT_THROW(require_sense(RayShape{1, 15}), InputError);
  EXPECT_THROW(require_sense(RayShape{20, 65}), InputError);
  EXPECT_TRUE(ray_shape_from(to_value(RayShape{7, 9})) == (RayShape{7, 9}));
  EXPECT_THROW(ray_shape_from(Value::map()), InputError);
}

TEST(Samples, OfRaysComeBackFromTheirFile) {
  SampleSet set;
  set.world = "yard 1";
  set.input = RayShape{3, 2};
  set.mapping = Value::map();
  set.mapping.set("resolution", 0.4);
  const std::vector<float> image(numbers_of(set.input), 0.25f);
  set.add(image, std::vector{1.0f, 2.0f, 0.0f, 0.0f, 0.5f, 0.0f});
  set.add(image, std::vector{0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 4.0f});
  EXPECT_THROW(set.add(image, std::vector{1.0f}), Error);
  const auto path = std::filesystem::path(testing::TempDir()) / "ray_samples.samples";
  write_samples(set, path);
  const SampleSet read = read_samples(path);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read.input == set.input);
  EXPECT_EQ(read.targets, set.targets);
  EXPECT_EQ(read.inputs, set.inputs);
  EXPECT_EQ(read.gains(), (std::vector{3.5f, 4.0f}));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace lapwing
