// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/explore/trainable.h"
#include "framework/explore/view_grid.h"
#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

// A map that knows a few looks around.
std::unique_ptr<Map> seen(const YardWorld& world, MapMeans* means = nullptr) {
  auto map = YardWorld::new_map();
  for (const double yaw : {0.3, 1.9, -2.0})
    map->integrate(world.settings.sensor.look(world.truth.scene(), {{0, 0, 4}, yaw, -0.2}, 1));
  if (means) means->touch(*map->bounds());
  return map;
}

TEST(MapMeans, AreTheMapsOwn) {
  const YardWorld world;
  const auto map = seen(world);
  MapMeans means(*map);
  means.touch(*map->bounds());
  means.refresh(4);
  Random random(1);
  for (int level = 1; level <= 4; ++level) {
    const int middle = 32768 >> level;
    const int low[3] = {middle - 9, middle - 7, middle - 3}, size[3] = {17, 14, 9};
    std::vector<MeanReading> copied;
    means.copy(level, low, size, copied);
    for (int k = 0; k < 200; ++k) {
      const int at[3] = {static_cast<int>(random.integer(0, 16)),
                         static_cast<int>(random.integer(0, 13)),
                         static_cast<int>(random.integer(0, 8))};
      const VoxelKey key{static_cast<std::uint16_t>((low[0] + at[0]) << level),
                         static_cast<std::uint16_t>((low[1] + at[1]) << level),
                         static_cast<std::uint16_t>((low[2] + at[2]) << level)};
      MeanReading read;
      map->read_means(level, {&key, 1}, {&read, 1});
      const MeanReading& found =
          copied[static_cast<std::size_t>(at[0] + size[0] * (at[1] + size[1] * at[2]))];
      EXPECT_NEAR(found.occupancy, read.occupancy, 1e-5);
      EXPECT_NEAR(found.uncertainty, read.uncertainty, 1e-5);
    }
  }
}

TEST(MapMeans, FollowAMapThatGrows) {
  const YardWorld world;
  const auto map = YardWorld::new_map();
  MapMeans grown(*map);
  for (const double yaw : {0.3, 2.4}) {
    const Viewpoint view{{0, 0, 4}, yaw, -0.2};
    map->integrate(world.settings.sensor.look(world.truth.scene(), view, 1));
    grown.touch(reach_box(map->grid(), view, world.settings.sensor.pinhole, 20));
    grown.refresh(3);
  }
  MapMeans fresh(*map);
  fresh.touch(*map->bounds());
  fresh.refresh(3);
  const int low[3] = {4096 - 12, 4096 - 12, 4096 - 12}, size[3] = {24, 24, 24};
  std::vector<MeanReading> a, b;
  grown.copy(3, low, size, a);
  fresh.copy(3, low, size, b);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].occupancy, b[k].occupancy);
    EXPECT_EQ(a[k].uncertainty, b[k].uncertainty);
  }
}

TEST(ReachBox, HoldsAllThatAnImageMeasures) {
  const YardWorld world;
  Random random(4);
  for (int k = 0; k < 12; ++k) {
    const Viewpoint view{{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(2, 6)},
                         random.uniform(-3, 3),
                         random.uniform(-1.2, 0.5)};
    const auto map = YardWorld::new_map();
    map->integrate(world.settings.sensor.look(world.truth.scene(), view, 1));
    const VoxelBox box = reach_box(map->grid(), view, world.settings.sensor.pinhole, 20);
    const auto bounds = map->bounds();
    ASSERT_TRUE(bounds);
    EXPECT_TRUE(box.contains(bounds->lower) && box.contains(bounds->upper));
  }
}

// Point by point, by the map's own means, interpolated the slow way.
TEST(ViewGrid, InterpolatesTheMeansAroundTheCamera) {
  const YardWorld world;
  const auto map = seen(world);
  MapMeans means(*map);
  means.touch(*map->bounds());
  EpisodeView known{map.get(), &means, world.settings.sensor.pinhole, 20, world.pitch, nullptr, 1};
  const GridShape shape{6, 4, 4, 2};
  means.refresh(2);
  const Viewpoint view{{0.7, -0.4, 3.1}, 0.9, world.pitch};
  std::vector<float> grid(shape.size());
  sample_grid(known, view, shape, grid);
  const CameraAxes<double> axes = camera_axes(view.yaw, view.pitch);
  const auto mean_at = [&](int level, const Eigen::Vector3d& p) {
    const VoxelKey key = map->grid().key(p);
    MeanReading read;
    map->read_means(level, {&key, 1}, {&read, 1});
    return read;
  };
  for (int level = 1; level <= 2; ++level)
    for (int k = 0; k < shape.up; ++k)
      for (int j = 0; j < shape.ahead; ++j)
        for (int i = 0; i < shape.across; ++i) {
          const double edge = 0.4 * (1 << level);
          const Eigen::Vector3d p =
              view.position +
              edge * ((i - 2.5) * axes.right + (j - 1.5) * axes.forward - (k - 1.5) * axes.down);
          double expected = 0;
          for (int corner = 0; corner < 8; ++corner) {
            Eigen::Vector3d middle;
            double weight = 1;
            for (int a = 0; a < 3; ++a) {
              const double cell = std::floor(p[a] / edge - 0.5) + (corner >> a & 1);
              middle[a] = (cell + 0.5) * edge;
              weight *= 1 - std::abs(p[a] - middle[a]) / edge;
            }
            expected += weight * static_cast<double>(mean_at(level, middle).occupancy);
          }
          const std::size_t place = static_cast<std::size_t>(
              ((k * shape.ahead + j) * shape.across + i) * shape.channels() + 2 * (level - 1));
          EXPECT_NEAR(grid[place], expected, 1e-5);
        }
}

TEST(ViewGrid, OfNothingIsUnknown) {
  const auto map = YardWorld::new_map();
  MapMeans means(*map);
  EpisodeView known{map.get(), &means, {80, 60, 40, 40, 39.5, 29.5}, 20, 0, nullptr, 1};
  means.refresh(3);
  const GridShape shape;
  std::vector<float> grid(shape.size());
  sample_grid(known, {{1e4, 3, 2}, 1, 0}, shape, grid);
  for (std::size_t k = 0; k < grid.size(); ++k) EXPECT_EQ(grid[k], k % 2 == 0 ? 0.5f : 1.0f);
}

TEST(Samples, ComeBackFromTheirFile) {
  SampleSet set;
  set.world = "yard 1";
  set.episode = 3;
  set.input = GridShape{2, 2, 2, 1};
  set.mapping = Value::map();
  set.mapping.set("resolution", 0.4);
  set.made_by = Value::map();
  set.made_by.set("explorer", "oracle");
  set.add(std::vector<float>(16, 0.5f), std::vector{12.5f});
  set.add(std::vector<float>(16, 1.0f), std::vector{0.0f});
  const auto path = std::filesystem::path(testing::TempDir()) / "explore_samples.samples";
  write_samples(set, path);
  const SampleSet read = read_samples(path);
  EXPECT_EQ(read.world, set.world);
  EXPECT_EQ(read.targets, set.targets);
  EXPECT_EQ(read.inputs, set.inputs);
  EXPECT_TRUE(read.mapping == set.mapping);
  EXPECT_TRUE(read.made_by == set.made_by);
  const std::string bytes = read_file(path);
  for (const std::size_t cut : {5u, 30u, 80u}) {
    write_file_atomically(path, std::string_view(bytes).substr(0, bytes.size() - cut));
    EXPECT_THROW(read_samples(path), InputError) << cut;
  }
  std::filesystem::remove(path);
}

TEST(RankCorrelation, HasItsKnownValues) {
  const std::vector<float> a{1, 2, 3, 4, 5}, down{5, 4, 3, 2, 1}, b{2, 1, 4, 3, 5};
  EXPECT_NEAR(rank_correlation(a, a), 1, 1e-12);
  EXPECT_NEAR(rank_correlation(a, down), -1, 1e-12);
  EXPECT_NEAR(rank_correlation(a, b), 0.8, 1e-12);  // 1 - 6 * 4 / (5 * 24)
  const std::vector<float> tied{1, 1, 2, 2}, other{1, 2, 3, 4};
  EXPECT_NEAR(rank_correlation(tied, other), 4 / std::sqrt(20.0), 1e-12);
  EXPECT_TRUE(std::isnan(rank_correlation(std::vector<float>{1, 1}, std::vector<float>{1, 2})));
  const std::vector<float> broken{1, 2, std::nanf(""), 4};
  EXPECT_TRUE(std::isnan(rank_correlation(broken, other)));
  EXPECT_TRUE(std::isnan(rank_correlation(other, broken)));
}

}  // namespace
}  // namespace lapwing
