// SPDX-License-Identifier: Apache-2.0
// Ways between viewpoints against all of them written out; who is who; files of samples; ranks.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/random.h"
#include "framework/explore/sample_file.h"
#include "framework/explore/trainable.h"
#include "framework/explore/viewpoint_graph.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kNoWay = std::numeric_limits<double>::infinity();

// A free hall of 12 m x 12 m x 4 m about the origin, in voxels of half a metre.
void fill_hall(SmallMap& map) {
  std::vector<VoxelLeaf> leaves;
  for (double x = -5.75; x < 6; x += 0.5)
    for (double y = -5.75; y < 6; y += 0.5)
      for (double z = 0.25; z < 4; z += 0.5)
        leaves.push_back({map.grid().key({x, y, z}), 0, 1, -2.0f});
  map.import(leaves);
}

void set_wall(SmallMap& map, double x, float log_odds) {
  std::vector<VoxelLeaf> leaves;
  for (double y = -5.75; y < 6; y += 0.5)
    for (double z = 0.25; z < 4; z += 0.5)
      leaves.push_back({map.grid().key({x, y, z}), 0, 1, log_odds});
  map.import(leaves);
}

Viewpoint somewhere_in_hall(Random& random) {
  Viewpoint view;
  view.position = {random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(1, 3)};
  view.yaw = random.uniform(-4, 4);
  return view;
}

TEST(MoveTime, IsOfTheWayAndTheShorterTurn) {
  const MoveTimes times{2, 0.5};
  const Viewpoint a{{0, 0, 0}, 3.1, 0}, b{{0, 3, 4}, -3.1, 0};
  EXPECT_NEAR(times.of(a, b), 2.5 + (2 * std::numbers::pi - 6.2) / 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(times.of(a, b), times.of(b, a));
  EXPECT_EQ(times.of(a, a), 0);
  const Viewpoint wound{{0, 0, 0}, 3.1 + 20 * std::numbers::pi, 0};
  EXPECT_NEAR(times.of(a, wound), 0, 1e-9) << "whole turns are none";
}

TEST(ViewpointWays, EqualTheShortestOfAllPairs) {
  Random random(1);
  int ways = 0, none = 0;
  for (int trial = 0; trial < 15; ++trial) {
    SmallMap map;
    fill_hall(map);
    const MoveTimes times{1, 1};
    ViewpointGraph graph(map, {0.3, 0.3, 0.3}, times);
    const int count = 14;
    for (int k = 0; k < count; ++k) EXPECT_EQ(graph.add(somewhere_in_hall(random)), k);
    std::vector<std::vector<double>> least(count, std::vector<double>(count, kNoWay));
    for (int k = 0; k < count; ++k) least[k][k] = 0;
    for (int k = 0; k < 18; ++k) {
      const int a = static_cast<int>(random.integer(0, count - 1));
      const int b = static_cast<int>(random.integer(0, count - 1));
      graph.join(a, b);
      if (a != b) least[a][b] = least[b][a] = times.of(graph[a], graph[b]);
      EXPECT_EQ(graph.joined(a, b), a != b);
      EXPECT_EQ(graph.joined(b, a), a != b);
    }
    for (int m = 0; m < count; ++m)  // Floyd and Warshall
      for (int a = 0; a < count; ++a)
        for (int b = 0; b < count; ++b)
          least[a][b] = std::min(least[a][b], least[a][m] + least[m][b]);
    for (int a = 0; a < count; ++a) {
      const std::vector<bool> reached = graph.reached_from(a);
      for (int b = 0; b < count; ++b) {
        const std::vector<int> way = graph.way(a, b);
        EXPECT_EQ(reached[b], std::isfinite(least[a][b]));
        if (a == b || !std::isfinite(least[a][b])) {
          EXPECT_TRUE(way.empty());
          none += a != b;
          continue;
        }
        ++ways;
        double seconds = 0;
        int at = a;
        for (const int next : way) {
          EXPECT_TRUE(graph.joined(at, next));
          seconds += times.of(graph[at], graph[next]);
          at = next;
        }
        EXPECT_EQ(at, b);
        EXPECT_NEAR(seconds, least[a][b], 1e-9);
      }
    }
  }
  EXPECT_GT(ways, 300);
  EXPECT_GT(none, 100);
}

// A wall that appears between two neighbours sends the way round, and its going brings it back.
TEST(ViewpointWays, GoRoundWhatIsNoLongerFreeUntilItIsAgain) {
  SmallMap map;
  fill_hall(map);
  ViewpointGraph graph(map, {0.3, 0.3, 0.3}, {1, 1});
  const int a = graph.add({{-4, 0, 2}, 0, 0}), b = graph.add({{4, 0, 2}, 0, 0}),
            left = graph.add({{-4, 4, 2}, 0, 0}), right = graph.add({{4, 4, 2}, 0, 0});
  graph.join(a, b);
  graph.join(a, left);
  graph.join(left, right);
  graph.join(right, b);
  EXPECT_EQ(graph.way(a, b), std::vector<int>{b});
  const VoxelKey block = map.grid().key({0.25, 0.25, 2.25});
  map.import(std::vector<VoxelLeaf>{{block, 0, 1, 2.0f}});
  EXPECT_EQ(graph.way(a, b), (std::vector<int>{left, right, b}));
  EXPECT_FALSE(graph.free(graph[a], graph[b]));
  map.import(std::vector<VoxelLeaf>{{block, 0, 1, -2.0f}});
  EXPECT_EQ(graph.way(a, b), (std::vector<int>{left, right, b})) << "nobody has looked again";
  graph.look_again();
  EXPECT_EQ(graph.way(a, b), std::vector<int>{b});
  set_wall(map, 0.25, 2.0f);
  graph.look_again();
  EXPECT_TRUE(graph.way(a, b).empty());
  EXPECT_EQ(graph.way(a, left), std::vector<int>{left});
  const std::vector<bool> reached = graph.reached_from(a);
  EXPECT_EQ(reached, (std::vector<bool>{true, false, true, false}));
  set_wall(map, 0.25, -2.0f);
  EXPECT_TRUE(graph.way(a, b).empty());
  graph.look_again();
  EXPECT_EQ(graph.way(a, b), std::vector<int>{b});
}

// By definition: the first of all views so far that is the same within the tolerances.
TEST(ViewpointIndices, FindWhatASearchThroughAllFinds) {
  Random random(2);
  ViewpointIndex index;
  std::vector<Viewpoint> known;
  const auto same = [](const Viewpoint& a, const Viewpoint& b) {
    return (a.position - b.position).cwiseAbs().maxCoeff() <= ViewpointIndex::kSamePlace &&
           std::abs(std::remainder(a.yaw - b.yaw, 2 * std::numbers::pi)) <=
               ViewpointIndex::kSameYaw &&
           std::abs(a.pitch - b.pitch) <= ViewpointIndex::kSameYaw;
  };
  int again = 0;
  for (int k = 0; k < 600; ++k) {
    Viewpoint view;
    // On and about the faces of cells, where a search by cells goes wrong first.
    for (double& x : view.position)
      x = 0.5 * static_cast<double>(random.integer(-3, 3)) + 9e-4 * random.uniform(-1, 1);
    view.yaw = 0.5 * static_cast<double>(random.integer(0, 1)) +
               2 * std::numbers::pi * static_cast<double>(random.integer(-1, 1)) +
               6e-5 * random.uniform(-1, 1);
    const bool met = std::any_of(known.begin(), known.end(),
                                 [&](const Viewpoint& other) { return same(other, view); });
    const int found = index.find(view);
    ASSERT_EQ(found >= 0, met) << k;
    if (found >= 0) {
      EXPECT_TRUE(same(index[found], view)) << k;
    }
    const int place = index.add(view);
    EXPECT_EQ(place, met ? found : static_cast<int>(known.size())) << k;
    if (!met) known.push_back(view);
    again += met;
    EXPECT_EQ(index.size(), static_cast<int>(known.size()));
  }
  EXPECT_GT(again, 20);
}

class SampleFolder : public ::testing::Test {
 protected:
  SampleFolder()
      : folder_(std::filesystem::temp_directory_path() /
                ("lapwing_samples_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~SampleFolder() override { std::filesystem::remove_all(folder_); }

  static SampleSet samples_of(int count) {
    SampleSet samples;
    samples.world = "downtown 3";
    samples.episode = 7;
    samples.input = GridShape{2, 3, 2, 1};
    samples.mapping = Value::map();
    samples.mapping.set("resolution", 0.4);
    std::vector<float> grid(numbers_of(samples.input));
    for (int k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < grid.size(); ++i)
        grid[i] = static_cast<float>((static_cast<std::size_t>(k) * 7 + i * 11) % 256) / 255;
      samples.add(grid, std::vector{0.5f * static_cast<float>(k)});
    }
    return samples;
  }
  static std::string refusal(const std::filesystem::path& path) {
    try {
      read_samples(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(SampleFolder, EveryChangedByteOfTheDataAndEveryCutAreNoticed) {
  const auto path = folder_ / "a.samples";
  const SampleSet samples = samples_of(3);
  write_samples(samples, path);
  const std::string good = read_file(path, 1 << 20);
  EXPECT_EQ(read_samples(path).targets, samples.targets);
  EXPECT_EQ(read_samples(path).inputs, samples.inputs);
  const std::size_t data = good.find('\n', good.find('\n') + 1) + 1;
  ASSERT_EQ(good.size() - data, samples.size() * (4 + numbers_of(samples.input)));
  for (std::size_t k = data; k < good.size(); ++k) {
    std::string bad = good;
    bad[k] = static_cast<char>(bad[k] ^ 0x10);
    write_file_atomically(path, bad);
    EXPECT_NE(refusal(path).find("checksum"), std::string::npos) << "byte " << k;
  }
  for (std::size_t k = 0; k < good.size(); ++k) {
    write_file_atomically(path, good.substr(0, k));
    EXPECT_NE(refusal(path), "") << "cut at " << k;
  }
  write_file_atomically(path, good + "x");
  EXPECT_NE(refusal(path).find("hold another number"), std::string::npos);
  std::string other = good;
  other[other.find('4')] = '9';
  write_file_atomically(path, other);
  EXPECT_NE(refusal(path).find("another format than 4"), std::string::npos) << refusal(path);
  EXPECT_NE(refusal(path).find("a.samples"), std::string::npos) << "names the file";
  EXPECT_NE(refusal(folder_ / "none.samples"), "");
}

TEST_F(SampleFolder, ValuesOutsideAreADefectAndRoundingIsNone) {
  SampleSet samples = samples_of(0);
  std::vector<float> grid(numbers_of(samples.input), 0.5f);
  EXPECT_THROW(samples.add(std::vector<float>(3), std::vector{1.0f}), Error);
  for (const float bad : {-0.01f, 1.01f, std::nanf("")}) {
    grid[1] = bad;
    EXPECT_THROW(samples.add(grid, std::vector{1.0f}), Error) << bad;
  }
  SampleSet fresh = samples_of(0);
  grid[1] = 1.00005f;
  grid[2] = -0.00005f;
  fresh.add(grid, std::vector{1.0f});
  EXPECT_EQ(fresh.inputs[1], 255);
  EXPECT_EQ(fresh.inputs[2], 0);
  EXPECT_EQ(fresh.inputs[0], 128);
}

TEST_F(SampleFolder, FilesAreListedByNameAndOnceEach) {
  for (const char* name : {"b.samples", "a.samples", "c.samples"})
    write_samples(samples_of(1), folder_ / name);
  write_file_atomically(folder_ / "notes.txt", "no samples");
  const auto all = sample_files({folder_});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].filename(), "a.samples");
  EXPECT_EQ(all[2].filename(), "c.samples");
  const auto chosen = sample_files({folder_ / "c.samples", folder_ / "a.samples"});
  EXPECT_EQ(chosen[0].filename(), "c.samples") << "in the order given";
  const auto refused = [](const std::vector<std::filesystem::path>& given) -> std::string {
    try {
      sample_files(given);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refused({folder_, folder_ / "." / "a.samples"}).find("named twice"), std::string::npos);
  EXPECT_NE(refused({folder_ / "notes.txt"}).find("notes.txt"), std::string::npos);
  EXPECT_NE(refused({folder_ / "nowhere"}).find("nowhere"), std::string::npos);
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_NE(refused({folder_ / "empty"}).find("holds no file NAME.samples"), std::string::npos);
}

// Without ties: 1 - 6 sum d^2 / (n (n^2 - 1)) (Spearman 1904). Monotone maps change no rank.
TEST(RankCorrelations, EqualSpearmansFormula) {
  Random random(3);
  for (const int n : {2, 3, 10, 101}) {
    std::vector<float> a(n), b(n);
    std::vector<int> rank_of_b(n);
    std::iota(rank_of_b.begin(), rank_of_b.end(), 0);
    for (int k = n; k > 1; --k)
      std::swap(rank_of_b[k - 1], rank_of_b[static_cast<std::size_t>(random.integer(0, k - 1))]);
    double squares = 0;
    for (int k = 0; k < n; ++k) {
      a[k] = static_cast<float>(k);
      b[k] = static_cast<float>(std::exp(0.05 * rank_of_b[k]) - 7);
      squares += (k - rank_of_b[k]) * (k - rank_of_b[k]);
    }
    const double expected = 1 - 6 * squares / (n * (static_cast<double>(n) * n - 1));
    EXPECT_NEAR(rank_correlation(a, b), expected, 1e-12) << n;
    EXPECT_NEAR(rank_correlation(b, a), expected, 1e-12) << n;
    std::vector<float> negative = b;
    for (float& x : negative) x = -x;
    EXPECT_NEAR(rank_correlation(a, negative), -expected, 1e-12) << n;
    EXPECT_NEAR(rank_correlation(b, b), 1, 1e-12) << n;
  }
  EXPECT_THROW(rank_correlation(std::vector<float>(2), std::vector<float>(3)), Error);
  EXPECT_TRUE(
      std::isnan(rank_correlation(std::vector<float>{1, std::nanf("")}, std::vector<float>{1, 2})));
  EXPECT_TRUE(std::isnan(rank_correlation(std::vector<float>{1, 1}, std::vector<float>{1, 2})))
      << "all alike: there is no order";
}

}  // namespace
}  // namespace lapwing
