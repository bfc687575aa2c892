// SPDX-License-Identifier: Apache-2.0
// The motions that join views: which are found, which are blocked, and what they do not depend on.
#include "framework/view/motions.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/conformance/path_worlds.h"
#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

std::vector<Viewpoint> viewpoints_in_a_row(int count) {
  std::vector<Viewpoint> views(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) views[static_cast<std::size_t>(k)].position = {3.0 * k, 0, 2};
  return views;
}

MotionSettings settings_for(int neighbours, int among, double alpha) {
  MotionSettings settings;
  settings.allowed = {Vector3d(-9, -9, 0), Vector3d(99, 9, 9)};
  settings.half = {0.5, 0.5, 0.5};
  settings.neighbours = neighbours;
  settings.among = among;
  settings.alpha = alpha;
  return settings;
}

TEST(Motions, JoinTheNearestThatAreFree) {
  // A wall between views 2 and 3.
  const BlockSpace space({Eigen::AlignedBox3d(Vector3d(7, -9, 0), Vector3d(8, 9, 9))});
  const std::vector<Viewpoint> views = viewpoints_in_a_row(6);
  const MotionGraph graph = find_motions(space, views, {}, settings_for(2, 2, 0), 1, 1);
  std::vector<std::pair<int, int>> joined;
  for (const ViewMotion& m : graph.motions) {
    joined.emplace_back(m.a, m.b);
    EXPECT_NEAR(m.length, (views[m.a].position - views[m.b].position).norm(), 1e-12);
    EXPECT_EQ(m.points.size(), 2u);
  }
  // Ends have both neighbours on one side; of 2 and 3 the other is one of the two nearest.
  const std::vector<std::pair<int, int>> expected = {{0, 1}, {0, 2}, {1, 2},
                                                     {3, 4}, {3, 5}, {4, 5}};
  EXPECT_EQ(joined, expected);
  EXPECT_EQ(graph.blocked, 1);
  EXPECT_EQ(graph.unmatched, 0);
  EXPECT_EQ(graph.planned, 0);
  EXPECT_EQ(graph.tried, 7);
}

// Only views 0, 2 and 4 show the same: each is joined with the nearest of its kind.
TEST(Motions, JoinOnlyWhatCanBeMatched) {
  const BlockSpace space(std::vector<Eigen::AlignedBox3d>{});
  const std::vector<Viewpoint> views = viewpoints_in_a_row(6);
  std::vector<std::vector<VoxelKey>> seen(6);
  for (int k = 0; k < 6; ++k)
    for (int x = 0; x < 10; ++x)
      seen[k].push_back({static_cast<std::uint16_t>(x + 20 * (k % 2)), 0, 0});
  seen[5].clear();  // sees nothing, and so can be matched with nothing
  const MotionGraph graph = find_motions(space, views, seen, settings_for(1, 5, 0.5), 1, 1);
  std::vector<std::pair<int, int>> joined;
  for (const ViewMotion& m : graph.motions) joined.emplace_back(m.a, m.b);
  const std::vector<std::pair<int, int>> expected = {{0, 2}, {1, 3}, {2, 4}};
  EXPECT_EQ(joined, expected);
  EXPECT_GT(graph.unmatched, 0);
  EXPECT_EQ(graph.tried, 3 + graph.unmatched);
  EXPECT_TRUE(matchable(seen[0], seen[2], 1));
  EXPECT_FALSE(matchable(seen[0], seen[1], 0.1));
  EXPECT_FALSE(matchable(seen[5], seen[5], 0.1)) << "two views of nothing";
  // Six of ten and ten: 6 of a mean of 8.
  const std::vector<VoxelKey> part(seen[0].begin(), seen[0].begin() + 6);
  EXPECT_TRUE(matchable(seen[0], part, 0.74));
  EXPECT_FALSE(matchable(seen[0], part, 0.76));
  EXPECT_EQ(matchable(part, seen[0], 0.74), matchable(seen[0], part, 0.74));
}

TEST(Motions, DoNotDependOnThreadsAndTellHowFarTheyAre) {
  Random random(8);
  std::vector<Eigen::AlignedBox3d> blocks;
  std::vector<Viewpoint> views(80);
  for (Viewpoint& v : views)
    v.position = {random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(0, 9)};
  for (int k = 0; k < 20; ++k) {
    const Vector3d p(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(0, 9));
    blocks.emplace_back(p - Vector3d::Ones(), p + Vector3d::Ones());
  }
  const BlockSpace space(blocks);
  std::size_t done = 0, of = 1;
  const auto graph_with = [&](int threads) {
    return find_motions(space, views, {}, settings_for(6, 20, 0), 3, threads, nullptr,
                        [&](std::size_t so_far, std::size_t all) { done = so_far, of = all; });
  };
  const MotionGraph one = graph_with(1), four = graph_with(4);
  EXPECT_EQ(done, of);
  ASSERT_EQ(one.motions.size(), four.motions.size());
  EXPECT_GT(one.blocked, 5);
  EXPECT_EQ(one.blocked, four.blocked);
  for (std::size_t k = 0; k < one.motions.size(); ++k) {
    EXPECT_EQ(one.motions[k].a, four.motions[k].a);
    EXPECT_EQ(one.motions[k].points, four.motions[k].points);
    EXPECT_LT(one.motions[k].a, one.motions[k].b);
  }
  CancellationToken token;
  token.cancel();
  EXPECT_THROW(find_motions(space, views, {}, settings_for(6, 20, 0), 3, 2, &token), Cancelled);
}

TEST(Motions, RefuseSettingsWithoutSense) {
  const BlockSpace space(std::vector<Eigen::AlignedBox3d>{});
  const std::vector<Viewpoint> views = viewpoints_in_a_row(3);
  const auto said = [&](const auto& spoil) -> std::string {
    MotionSettings settings = settings_for(2, 2, 0);
    spoil(settings);
    try {
      find_motions(space, views, {{}, {}, {}}, settings, 1, 1);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto holds = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(holds(said([](MotionSettings& s) { s.neighbours = 0; }), "neighbours must be"));
  EXPECT_TRUE(holds(said([](MotionSettings& s) { s.among = 1; }), "not 2 among 1"));
  for (const double alpha : {-0.1, 1.1, std::nan("")})
    EXPECT_TRUE(holds(said([&](MotionSettings& s) { s.alpha = alpha; }), "alpha must lie"));
  for (const double longest : {0.9, std::nan("")})
    EXPECT_TRUE(holds(said([&](MotionSettings& s) { s.longest_detour = longest; }), "detour"));
  EXPECT_THROW(find_motions(space, views, {{}}, settings_for(2, 2, 0.5), 1, 1), Error);
  EXPECT_TRUE(find_motions(space, {}, {}, settings_for(2, 2, 0), 1, 1).motions.empty());
  EXPECT_TRUE(
      find_motions(space, viewpoints_in_a_row(1), {}, settings_for(2, 2, 0), 1, 1).motions.empty());
}

}  // namespace
}  // namespace lapwing
