// SPDX-License-Identifier: Apache-2.0
// The map of an episode after any of its images, forward, backward and at a jump: each voxel has
// the numbers that the explorer knew.
#include "framework/explore/episode_replay.h"

#include <map>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

using Known = std::map<std::array<int, 3>, std::pair<float, int>>;

// Of every known voxel its log odds and observations.
Known known_of(const Map& map) {
  Known known;
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    const int size = 1 << leaf.level;
    for (int z = 0; z < size; ++z)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
          known[{leaf.key.x + x, leaf.key.y + y, leaf.key.z + z}] = {leaf.log_odds,
                                                                     leaf.observations};
  });
  return known;
}

class Replayed : public testing::TestWithParam<bool> {};

TEST_P(Replayed, HasEveryVoxelAsTheExplorerKnewIt) {
  YardWorld world(20);
  if (GetParam()) {
    world.settings.sensor.noise = DepthNoise{0.05, 0.3};
    world.settings.sensor.smooth_to = 0.1;
  }
  const auto utility = plugins().create<ViewUtility>("proximity_count", Value::map());
  EpisodeReplay replay(
      {world.settings, world.start, world.truth.shared_scene(), YardWorld::new_map});
  std::vector<Known> maps(1);  // before the first image it is told by the choice
  ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto map = YardWorld::new_map();
  explore(
      world.settings, world.start, world.truth, observed, *utility, *map,
      [&](const EpisodeMoment& moment) {
        replay.took(moment.taken.view);
        maps.push_back(known_of(*map));
        // It follows the episode that goes on.
        EXPECT_EQ(known_of(replay.after(moment.step + 1)), maps.back());
      },
      [&](const EpisodeChoice& choice) {
        if (choice.step == 0) maps[0] = known_of(*map);
      });
  ASSERT_EQ(replay.images(), 20);
  for (const int images : {20, 0, 3, 2, 19, 8, 9, 7, 16, 1, 20})
    EXPECT_EQ(known_of(replay.after(images)), maps[static_cast<std::size_t>(images)]) << images;
  // Since when a voxel is known: the first map that has it.
  int asked = 0;
  for (const auto& [key, reading] : maps.back()) {
    if (asked++ % 4001 != 0) continue;
    int first = 0;
    while (!maps[static_cast<std::size_t>(first)].contains(key)) ++first;
    const VoxelKey voxel{static_cast<std::uint16_t>(key[0]), static_cast<std::uint16_t>(key[1]),
                         static_cast<std::uint16_t>(key[2])};
    EXPECT_EQ(replay.known_from(voxel, 20), first);
    EXPECT_FALSE(first > 0 && replay.known_from(voxel, first - 1));
  }
  EXPECT_GT(asked, 4001);
  EXPECT_THROW(replay.after(21), InputError);
  EXPECT_THROW(replay.after(-1), InputError);
}

INSTANTIATE_TEST_SUITE_P(Cameras, Replayed, testing::Bool(),
                         [](const auto& noisy) { return noisy.param ? "Noisy" : "Exact"; });

}  // namespace
}  // namespace lapwing
