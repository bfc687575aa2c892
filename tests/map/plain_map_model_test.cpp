// SPDX-License-Identifier: Apache-2.0
// Everything that maps are asked, against answers found voxel by voxel.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/map/ray_walk.h"
#include "framework/map/voxel.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kSide = 8;  // voxels along each axis that these tests fill, about the origin

VoxelKey key_at(int x, int y, int z) {
  const auto part = [](int i) { return static_cast<std::uint16_t>(kCenterKey + i); };
  return {part(x), part(y), part(z)};
}

// A block of voxels, each known with this chance, else left unknown.
std::vector<VoxelLeaf> random_block(Random& random, double known, double occupied) {
  std::vector<VoxelLeaf> leaves;
  for (int x = -kSide / 2; x < kSide / 2; ++x)
    for (int y = -kSide / 2; y < kSide / 2; ++y)
      for (int z = -kSide / 2; z < kSide / 2; ++z)
        if (random.uniform() < known)
          leaves.push_back({key_at(x, y, z), 0, static_cast<std::uint16_t>(random.integer(0, 9)),
                            random.uniform() < occupied ? 1.5f : -1.5f});
  return leaves;
}

TEST(VoxelGrids, KeysAndPlacesAreInverse) {
  Random random(1);
  for (const double resolution : {0.05, 0.1, 0.2, 0.3, 1.0, 7.0}) {
    const VoxelGrid grid(resolution);
    for (int k = 0; k < 500; ++k) {
      const VoxelKey key{static_cast<std::uint16_t>(random.integer(0, kKeyCount - 1)),
                         static_cast<std::uint16_t>(random.integer(0, kKeyCount - 1)),
                         static_cast<std::uint16_t>(random.integer(0, kKeyCount - 1))};
      EXPECT_EQ(grid.key(grid.center(key)), key);
      EXPECT_TRUE(grid.contains(grid.center(key)));
      const Vector3d p = grid.corner(key) + resolution * Vector3d(random.uniform(0.01, 0.99),
                                                                  random.uniform(0.01, 0.99),
                                                                  random.uniform(0.01, 0.99));
      EXPECT_EQ(grid.key(p), key) << "anywhere inside";
    }
    const double reach = grid.reach();
    EXPECT_DOUBLE_EQ(grid.face(0), -reach);
    EXPECT_EQ(grid.index(0), kCenterKey);
    EXPECT_EQ(grid.index(-1e-9), kCenterKey - 1) << "towards lower numbers, not towards 0";
    EXPECT_TRUE(grid.contains(Vector3d::Constant(-reach)));
    EXPECT_FALSE(grid.contains(Vector3d(0, reach, 0))) << "the upper end is outside";
    for (const double bad : {std::nan(""), 1.0 / 0.0, -1.0 / 0.0, 1e300})
      EXPECT_FALSE(grid.contains(Vector3d(0, 0, bad)));
  }
}

TEST(VoxelGrids, OddsAndProbabilitiesAreInverse) {
  for (const double p : {0.001, 0.1192, 0.4, 0.5, 0.7, 0.971, 0.999})
    EXPECT_NEAR(probability_of(log_odds_of(p)), p, 1e-6);
  EXPECT_EQ(log_odds_of(0.5), 0);
  EXPECT_NEAR(log_odds_of(0.7) + log_odds_of(0.3), 0, 1e-6);
  EXPECT_EQ(probability_of(std::numeric_limits<float>::infinity()), 1);
  EXPECT_EQ(probability_of(-std::numeric_limits<float>::infinity()), 0);
}

TEST(MortonNumbers, AreBitsInTurnAndOrderCubes) {
  Random random(2);
  for (int k = 0; k < 300; ++k) {
    const VoxelKey key{static_cast<std::uint16_t>(random.integer(0, 65535)),
                       static_cast<std::uint16_t>(random.integer(0, 65535)),
                       static_cast<std::uint16_t>(random.integer(0, 65535))};
    std::uint64_t expected = 0;
    for (int bit = 0; bit < 16; ++bit)
      for (int axis = 0; axis < 3; ++axis)
        expected |= static_cast<std::uint64_t>(key[axis] >> bit & 1) << (3 * bit + axis);
    EXPECT_EQ(key.morton(), expected);
  }
}

// Against stepping along the ray in small strides: the same voxels in the same order, but for those
// that the strides miss.
TEST(RayWalks, PassTheVoxelsThatSmallStridesMeet) {
  Random random(3);
  const VoxelGrid grid(0.5);
  for (int k = 0; k < 200; ++k) {
    const Vector3d origin(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
    Vector3d way(random.normal(), random.normal(), random.normal());
    if (k % 4 == 1) way.x() = 0;
    if (k % 4 == 2) way.y() = way.z() = 0;
    way.normalize();
    RayWalk walk(grid, origin, way);
    EXPECT_EQ(walk.key(), grid.key(origin));
    std::vector<VoxelKey> walked{walk.key()};
    double before = 0;
    while (walk.entered < 6) {
      const VoxelKey last = walk.key();
      walk.advance();
      EXPECT_GE(walk.entered, before) << k;
      before = walk.entered;
      int moved = 0;
      for (int i = 0; i < 3; ++i) moved += std::abs(walk.key()[i] - last[i]);
      EXPECT_EQ(moved, 1) << "through one face at a time";
      walked.push_back(walk.key());
    }
    std::size_t at = 0;
    for (double s = 0; s < 6; s += 0.003) {
      const VoxelKey key = grid.key(origin + s * way);
      const auto found =
          std::find(walked.begin() + static_cast<std::ptrdiff_t>(at), walked.end(), key);
      ASSERT_NE(found, walked.end()) << k << " at " << s;
      at = static_cast<std::size_t>(found - walked.begin());
    }
  }
}

TEST(MapAnswers, ReadsCountsBoundsAndLeavesAreThoseImported) {
  Random random(4);
  for (int trial = 0; trial < 10; ++trial) {
    SmallMap map;
    EXPECT_FALSE(map.bounds());
    const std::vector<VoxelLeaf> leaves = random_block(random, 0.3, 0.4);
    map.import(leaves);
    std::map<VoxelKey, VoxelLeaf> model;
    VoxelCounts counts;
    VoxelBox box{key_at(99, 99, 99), key_at(-99, -99, -99)};
    for (const VoxelLeaf& leaf : leaves) {
      model[leaf.key] = leaf;
      ++counts.known;
      ++(leaf.log_odds > 0 ? counts.occupied : counts.free);
      box.lower = {std::min(box.lower.x, leaf.key.x), std::min(box.lower.y, leaf.key.y),
                   std::min(box.lower.z, leaf.key.z)};
      box.upper = {std::max(box.upper.x, leaf.key.x), std::max(box.upper.y, leaf.key.y),
                   std::max(box.upper.z, leaf.key.z)};
    }
    EXPECT_EQ(map.counts().known, counts.known);
    EXPECT_EQ(map.counts().free, counts.free);
    EXPECT_EQ(map.counts().occupied, counts.occupied);
    ASSERT_TRUE(map.bounds());
    EXPECT_EQ(*map.bounds(), box);
    std::size_t visited = 0;
    map.for_each_leaf([&](const VoxelLeaf& leaf) {
      ++visited;
      ASSERT_TRUE(model.count(leaf.key));
      EXPECT_EQ(leaf.log_odds, model[leaf.key].log_odds);
    });
    EXPECT_EQ(visited, model.size());
    for (int x = -5; x <= 5; ++x)
      for (int y = -5; y <= 5; ++y) {
        const VoxelKey key = key_at(x, y, 1);
        const VoxelReading reading = map.read(key);
        const auto known = model.find(key);
        EXPECT_EQ(reading.known, known != model.end());
        const VoxelState expected = known == model.end()         ? VoxelState::unknown
                                    : known->second.log_odds > 0 ? VoxelState::occupied
                                                                 : VoxelState::free;
        EXPECT_EQ(reading.state, expected);
        VoxelState state;
        map.read_states(std::span(&key, 1), std::span(&state, 1));
        EXPECT_EQ(state, expected);
      }
  }
}

// A leaf of a level holds (2^level)^3 voxels; of several leaves for a voxel the last one counts.
TEST(MapAnswers, LargeLeavesAreTheirVoxelsAndTheLastCounts) {
  SmallMap map;
  map.import(std::vector<VoxelLeaf>{{key_at(0, 0, 0), 2, 0, -1.5f}, {key_at(1, 2, 3), 0, 0, 1.5f}});
  EXPECT_EQ(map.counts().known, 64u);
  EXPECT_EQ(map.counts().occupied, 1u);
  EXPECT_EQ(map.read(key_at(1, 2, 3)).state, VoxelState::occupied);
  EXPECT_EQ(map.read(key_at(3, 3, 3)).state, VoxelState::free);
  EXPECT_FALSE(map.read(key_at(4, 3, 3)).known);
  EXPECT_FALSE(map.read(key_at(-1, 0, 0)).known);
  map.import(std::vector<VoxelLeaf>{{key_at(1, 2, 3), 0, 0, 1.5f}, {key_at(0, 0, 0), 2, 0, -1.5f}});
  EXPECT_EQ(map.counts().occupied, 0u);
  const float endless = std::numeric_limits<float>::infinity();
  map.import(
      std::vector<VoxelLeaf>{{key_at(0, 0, 0), 0, 0, endless}, {key_at(1, 0, 0), 0, 0, -endless}});
  EXPECT_EQ(map.read(key_at(0, 0, 0)).log_odds, map.settings().clamp_max);
  EXPECT_EQ(map.read(key_at(1, 0, 0)).log_odds, map.settings().clamp_min);
}

TEST(MapAnswers, BadLeavesAreRefusedAndNothingIsChanged) {
  SmallMap map;
  map.import(std::vector<VoxelLeaf>{{key_at(0, 0, 0), 0, 0, -1.0f}});
  const std::vector<VoxelLeaf> bad = {{key_at(5, 0, 0), 0, 0, std::nanf("")},
                                      {key_at(5, 0, 0), 17, 0, 1.0f},
                                      {key_at(5, 0, 0), 1, 0, 1.0f},
                                      {key_at(4, 4, 6), 2, 0, 1.0f}};
  for (std::size_t k = 0; k < bad.size(); ++k) {
    const std::vector<VoxelLeaf> leaves = {{key_at(1, 1, 1), 0, 0, 1.0f}, bad[k]};
    EXPECT_THROW(map.import(leaves), InputError) << k;
    EXPECT_EQ(map.counts().known, 1u) << k;
  }
}

TEST(MapAnswers, FreeBoxesAreThoseWithoutAVoxelInTheWay) {
  Random random(5);
  SmallMap map;
  map.import(random_block(random, 0.995, 0.01));
  const double r = map.grid().resolution();
  int free = 0, blocked = 0;
  for (int k = 0; k < 2000; ++k) {
    Vector3d low, high;
    bool expected = true;
    int from[3], to[3];
    for (int i = 0; i < 3; ++i) {
      double a = random.uniform(-2.3, 2.3), b = a + random.uniform(0, 1.4);
      if (k % 3 == 0) a = std::round(a / r) * r, b = std::max(a + r, std::round(b / r) * r);
      low(i) = a;
      high(i) = b;
      from[i] = static_cast<int>(std::floor(a / r + 1e-6));
      to[i] = static_cast<int>(std::ceil(b / r - 1e-6)) - 1;  // touching is free
    }
    for (int x = from[0]; x <= to[0]; ++x)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int z = from[2]; z <= to[2]; ++z)
          expected &= map.read(key_at(x, y, z)).state == VoxelState::free;
    (expected ? free : blocked) += 1;
    EXPECT_EQ(map.box_free(low, high), expected) << k;
    const Vector3d middle = (low + high) / 2;
    EXPECT_EQ(map.swept_box_free(middle, middle, (high - low) / 2), expected) << k;
  }
  EXPECT_GT(free, 200);
  EXPECT_GT(blocked, 200);
  EXPECT_THROW(map.box_free({0, 0, 0}, {-1, 1, 1}), InputError);
  EXPECT_THROW(map.box_free({0, 0, std::nan("")}, {1, 1, 1}), InputError);
  EXPECT_THROW(map.swept_box_free({0, 0, 0}, {1, 1, 1.0 / 0.0}, {1, 1, 1}), InputError);
}

TEST(MapAnswers, RaysEndAtTheFirstVoxelThatIsNotFree) {
  Random random(6);
  SmallMap map;
  map.import(random_block(random, 0.97, 0.03));
  const VoxelGrid& grid = map.grid();
  std::vector<MapRay> rays;
  for (int k = 0; k < 1500; ++k) {
    const Vector3d origin(random.uniform(-1.9, 1.9), random.uniform(-1.9, 1.9),
                          random.uniform(-1.9, 1.9));
    const Vector3d way = Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    rays.push_back({origin, way, random.uniform(0.2, 6)});
  }
  std::vector<MapRayHit> hits(rays.size());
  map.cast(rays, hits);
  int within = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    RayWalk walk(grid, rays[k].origin, rays[k].direction);
    while (map.read(walk.key()).state == VoxelState::free && walk.entered < rays[k].range)
      walk.advance();
    if (walk.entered >= rays[k].range) {
      ++within;
      EXPECT_EQ(hits[k].state, VoxelState::free) << k;
      EXPECT_EQ(hits[k].distance, static_cast<float>(rays[k].range));
      continue;
    }
    EXPECT_EQ(hits[k].state, map.read(walk.key()).state) << k;
    EXPECT_NE(hits[k].state, VoxelState::free);
    EXPECT_EQ(hits[k].voxel, walk.key()) << k;
    EXPECT_EQ(hits[k].distance, static_cast<float>(walk.entered)) << k;
  }
  EXPECT_GT(within, 100);
  map.set_threads(3);
  std::vector<MapRayHit> again(rays.size());
  map.cast(rays, again);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    EXPECT_EQ(again[k].voxel, hits[k].voxel);
    EXPECT_EQ(again[k].distance, hits[k].distance);
  }
}

TEST(MapAnswers, BadRaysAreNamed) {
  SmallMap map;
  const auto said = [&](const std::function<void(MapRay&)>& spoil) -> std::string {
    std::vector<MapRay> rays(3, {Vector3d::Zero(), Vector3d::UnitX(), 5});
    spoil(rays[1]);
    std::vector<MapRayHit> hits(3);
    try {
      map.cast(rays, hits);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said([](MapRay&) {}), "");
  const std::vector<std::function<void(MapRay&)>> mistakes = {
      [](MapRay& r) { r.origin.x() = std::nan(""); },
      [](MapRay& r) { r.origin.y() = 1e9; },
      [](MapRay& r) {
        r.direction = {1, 1, 0};
      },
      [](MapRay& r) { r.direction = Vector3d::Zero(); },
      [](MapRay& r) { r.direction.z() = std::nan(""); },
      [](MapRay& r) { r.range = 0; },
      [](MapRay& r) { r.range = -1; },
      [](MapRay& r) { r.range = std::nan(""); },
      [](MapRay& r) { r.range = 1.0 / 0.0; }};
  for (std::size_t k = 0; k < mistakes.size(); ++k)
    EXPECT_NE(said(mistakes[k]).find("ray"), std::string::npos)
        << k << ": '" << said(mistakes[k]) << "'";
}

// By definition: voxel by voxel, what is unknown with 0.5 and 1.
TEST(MapAnswers, MeansAreOfAllVoxelsOfTheCube) {
  Random random(7);
  SmallMap map;
  map.import(random_block(random, 0.5, 0.5));
  for (const int level : {0, 1, 2, 3, 4}) {
    const int size = 1 << level;
    std::vector<VoxelKey> keys;
    std::vector<MeanReading> expected;
    for (int k = 0; k < 20; ++k) {
      const int at[3] = {static_cast<int>(random.integer(-10, 9)),
                         static_cast<int>(random.integer(-10, 9)),
                         static_cast<int>(random.integer(-10, 9))};
      keys.push_back(key_at(at[0], at[1], at[2]));
      double occupancy = 0, uncertainty = 0;
      int low[3];
      for (int i = 0; i < 3; ++i)
        low[i] = static_cast<int>(std::floor(static_cast<double>(at[i]) / size)) * size;
      for (int x = low[0]; x < low[0] + size; ++x)
        for (int y = low[1]; y < low[1] + size; ++y)
          for (int z = low[2]; z < low[2] + size; ++z) {
            const VoxelReading reading = map.read(key_at(x, y, z));
            occupancy += reading.known ? probability_of(reading.log_odds) : 0.5;
            uncertainty += reading.known ? map.uncertainty(reading.observations) : 1;
          }
      const double volume = std::pow(size, 3);
      expected.push_back(
          {static_cast<float>(occupancy / volume), static_cast<float>(uncertainty / volume)});
    }
    std::vector<MeanReading> means(keys.size());
    map.read_means(level, keys, means);
    for (std::size_t k = 0; k < keys.size(); ++k) {
      EXPECT_NEAR(means[k].occupancy, expected[k].occupancy, 1e-5) << level;
      EXPECT_NEAR(means[k].uncertainty, expected[k].uncertainty, 1e-5) << level;
    }
  }
}

// Reading 2.3: a voxel with a point is hit once, however many rays pass it or end in it.
TEST(MapAnswers, AScanUpdatesEachVoxelOnce) {
  SmallMap map;
  const Eigen::Vector3f eye(0.25f, 0.25f, 0.25f);
  std::vector<Eigen::Vector3f> points;
  for (int k = 0; k < 9; ++k)  // nine points in one voxel 2.5 m ahead, along one row of voxels
    points.emplace_back(2.55f + 0.04f * static_cast<float>(k), 0.25f, 0.25f);
  map.integrate(points, eye);
  const MapSettings& s = map.settings();
  EXPECT_EQ(map.read(key_at(5, 0, 0)).log_odds, s.hit);
  for (int x = 1; x < 5; ++x) EXPECT_EQ(map.read(key_at(x, 0, 0)).log_odds, s.miss) << x;
  EXPECT_FALSE(map.read(key_at(6, 0, 0)).known) << "nothing is known of what lies behind";
  map.integrate(points, eye);
  EXPECT_EQ(map.read(key_at(5, 0, 0)).log_odds, s.hit + s.hit);
  for (int k = 0; k < 50; ++k) map.integrate(points, eye);
  EXPECT_EQ(map.read(key_at(5, 0, 0)).log_odds, s.clamp_max);
  EXPECT_EQ(map.read(key_at(2, 0, 0)).log_odds, s.clamp_min);
  const VoxelCounts before = map.counts();
  const float nan = std::nanf("");
  for (const Eigen::Vector3f& bad : {Eigen::Vector3f(nan, 0, 0), Eigen::Vector3f(1e9f, 0, 0)}) {
    EXPECT_THROW(map.integrate(std::vector<Eigen::Vector3f>{points[0], bad}, eye), InputError);
    EXPECT_THROW(map.integrate(points, bad), InputError);
  }
  EXPECT_EQ(map.counts().known, before.known);
}

}  // namespace
}  // namespace lapwing
