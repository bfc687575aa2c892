// SPDX-License-Identifier: Apache-2.0
// Hand-made utilities on small maps whose answers can be counted.
#include <gtest/gtest.h>

#include "framework/conformance/check.h"
#include "framework/core/error.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

const Registry& registry() {
  static const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  return registry;
}

// A corridor of free voxels of 1 m along x, 1 x 1, from x = 0 to `length`; what is at its end is
// said by `end`; a camera with so narrow a view that all rays stay in it.
struct Corridor {
  SmallMap map{1.0};
  std::unique_ptr<MapMeans> means;
  EpisodeView known;
  Viewpoint view{{0.5, 0.5, 0.5}, 0, 0};

  Corridor(int length, VoxelState end) {
    std::vector<VoxelLeaf> leaves;
    for (int x = 0; x < length; ++x) set(leaves, x, -2);
    if (end == VoxelState::occupied) set(leaves, length, 2);
    map.import(leaves);
    refresh();
  }
  void set(std::vector<VoxelLeaf>& leaves, int x, float log_odds) {
    leaves.push_back({map.grid().key({x + 0.5, 0.5, 0.5}), 0, 1, log_odds});
  }
  void add(int x, float log_odds) {
    std::vector<VoxelLeaf> leaves;
    set(leaves, x, log_odds);
    map.import(leaves);
    refresh();
  }
  void refresh() {
    means = std::make_unique<MapMeans>(map);
    means->touch(*map.bounds());
    const HiddenVoxels* hidden = known.hidden;
    known = {&map, means.get(), {4, 4, 400, 400, 1.5, 1.5}, 10, 0, nullptr, 1, hidden};
  }
  double told(const std::string& name, const Value& given = Value::map()) const {
    double value = -1;
    registry().create<ViewUtility>(name, given)->score(known, {&view, 1}, {&value, 1});
    return value;
  }
};

Value one_ray_each() {
  Value given = Value::map();
  given.set("pixel_step", 1);
  return given;
}

TEST(Frontier, CountsVoxelsAtTheBorderOnce) {
  EXPECT_EQ(Corridor(4, VoxelState::unknown).told("frontier", one_ray_each()), 1);
  EXPECT_EQ(Corridor(4, VoxelState::occupied).told("frontier", one_ray_each()), 0);
  EXPECT_EQ(Corridor(12, VoxelState::unknown).told("frontier", one_ray_each()), 0);  // out of range
  // A wide view from the middle of one free voxel meets nothing but its neighbours.
  Corridor wide(1, VoxelState::unknown);
  wide.known.pinhole = {40, 40, 20, 20, 19.5, 19.5};
  const double all = wide.told("frontier", one_ray_each());
  EXPECT_GE(all, 1);
  EXPECT_LE(all, 5);
}

// 16 rays, each meets four free voxels of 2 bits below and the wall.
TEST(AverageEntropy, DividesByTheVoxelsMet) {
  const auto entropy = [](double log_odds) {
    const double p = 1 / (1 + std::exp(-log_odds));
    return -p * std::log2(p) - (1 - p) * std::log2(1 - p);
  };
  Corridor known(4, VoxelState::occupied);
  EXPECT_NEAR(known.told("average_entropy", one_ray_each()), (4 * entropy(-2) + entropy(2)) / 5,
              1e-5);
  // Behind two unknown voxels: they count as one bit each.
  Corridor gap(4, VoxelState::unknown);
  gap.add(6, 2);
  EXPECT_NEAR(gap.told("average_entropy", one_ray_each()), (4 * entropy(-2) + 2 + entropy(2)) / 7,
              1e-5);
  // A ray without an end does not count.
  EXPECT_EQ(Corridor(4, VoxelState::unknown).told("average_entropy", one_ray_each()), 0);
}

// Seen from the front, a wall of one voxel 3.5 m away hides two voxels behind it: 0.5 m and 1.5 m
// from what was measured in its middle. From the front the wall is in the way; from the other end
// of the corridor both are seen, and after being measured neither counts.
TEST(ProximityCount, AddsWhatIsLeftOfTheDistanceBehindSeenSurfaces) {
  Corridor wall(4, VoxelState::occupied);
  Value given = one_ray_each();
  given.set("maximum_distance", 2.5);
  EXPECT_THROW(wall.told("proximity_count", given), InputError);  // without images
  HiddenVoxels hidden(wall.map);
  wall.known.hidden = &hidden;
  EXPECT_THROW(wall.told("proximity_count", given), InputError);  // nobody followed them
  const auto utility = registry().create<ViewUtility>("proximity_count", given);
  utility->require_fit(wall.known);
  const Eigen::Vector3f middle(4.5f, 0.5f, 0.5f);
  hidden.saw({&middle, 1}, {0.5, 0.5, 0.5});
  const auto told = [&](double x, double yaw) {
    const Viewpoint view{{x, 0.5, 0.5}, yaw, 0};
    double value = -1;
    utility->score(wall.known, {&view, 1}, {&value, 1});
    return value;
  };
  EXPECT_EQ(told(0.5, 0), 0);                            // the wall is in the way
  EXPECT_NEAR(told(9.5, EIGEN_PI), 16 * (2 + 1), 1e-5);  // from behind: both
  EXPECT_NEAR(told(5.5, EIGEN_PI), 16 * 2, 1e-5);        // from between: one
  EXPECT_EQ(told(9.5, 0), 0);                            // the other way round
  const Eigen::Vector3f nearer(6.0f, 0.5f, 0.5f);        // the smallest distance counts
  hidden.saw({&nearer, 1}, {9.5, 0.5, 0.5});
  EXPECT_NEAR(told(9.5, EIGEN_PI), 16 * (2.5 + 1), 1e-5);
  wall.add(6, -2);  // measured: free
  EXPECT_NEAR(told(9.5, EIGEN_PI), 16 * 2.5, 1e-5);
  wall.add(6, 2);  // measured: a wall
  EXPECT_EQ(told(9.5, EIGEN_PI), 0);
  given.set("maximum_distance", 3);
  EXPECT_THROW(registry().create<ViewUtility>("proximity_count", given)->require_fit(wall.known),
               InputError);  // too late
}

// The one ray ends 3.5 m away, where a pixel of four is 0.035 m wide; at 5 m, 0.05 m.
TEST(LearnedGrid, AsksTheRaysWhatIsLeftToObserve) {
  Value bare = Value::map();
  bare.set("rays", false);
  const auto expect_left = [&](const Corridor& corridor, double voxels) {
    const double network = corridor.told("learned_grid", bare);
    ASSERT_GT(network, 0);  // else nothing is asked
    const double left = (1 - std::exp(-corridor.map.settings().information)) * voxels;
    EXPECT_NEAR(corridor.told("learned_grid"), network * left / (network + left), 1e-6 * left);
  };
  expect_left(Corridor(4, VoxelState::unknown), 0.05 * 0.05);
  expect_left(Corridor(4, VoxelState::occupied), 3 * 0.035 * 0.035);
  expect_left(Corridor(12, VoxelState::unknown), 0);  // out of range
  const Corridor corridor(4, VoxelState::unknown);
  Value further = Value::map();
  further.set("behind", 4.5);
  EXPECT_GT(corridor.told("learned_grid", further), 2 * corridor.told("learned_grid"));
}

// Three rays, the outer ones 1.118 m long, to voxels of a wall; between them a gap of one ray.
TEST(LearnedGrid, LooksThroughNoGapOfOneRay) {
  Corridor corridor(2, VoxelState::unknown);
  corridor.known.pinhole = {12, 4, 8, 8, 5.5, 1.5};
  Value bare = Value::map();
  bare.set("rays", false);
  const auto expect_left = [&](double voxels) {
    const double network = corridor.told("learned_grid", bare);
    ASSERT_GT(network, 0);
    const double left = (1 - std::exp(-corridor.map.settings().information)) * voxels;
    EXPECT_NEAR(corridor.told("learned_grid"), network * left / (network + left), 1e-6 * left);
  };
  // Ends at 1.5 m and, to both sides, 1.118 m, all in the unknown: what is 1.5 m behind counts.
  const double side = std::sqrt(1.25), edge = 0.5;  // m; m across four pixels at 1 m
  const double ahead = std::pow(3 * edge, 2), aside = std::pow((side + 1.5) * edge, 2);
  expect_left(ahead + 2 * aside);
  std::vector<VoxelLeaf> leaves;
  leaves.push_back({corridor.map.grid().key({1.5, 1.5, 0.5}), 0, 1, 2});
  corridor.map.import(leaves);
  expect_left(ahead + aside + 3 * std::pow(side * edge, 2));  // a wall on one side is an edge
  leaves[0].key = corridor.map.grid().key({1.5, -0.5, 0.5});
  corridor.map.import(leaves);
  expect_left(2 * 3 * std::pow(side * edge, 2));
}

TEST(Oracle, SaysThatItNeedsTheTruth) {
  const PluginEntry& entry = registry().find("utility", "oracle");
  EXPECT_EQ(entry.extensions, std::vector<std::string>{kNeedsGroundTruth});
  const Corridor corridor(4, VoxelState::occupied);
  EXPECT_THROW(corridor.told("oracle"), InputError);
  EXPECT_EQ(registry().find("utility", "frontier").extensions, std::vector<std::string>{kMonotone});
}

// Another value for every question.
class Fickle final : public ViewUtility {
  void values_of(const EpisodeView&, std::span<const Viewpoint>,
                 std::span<double> values) const override {
    for (double& value : values) value = ++asked_;
  }
  mutable double asked_ = 0;
};

TEST(Utilities, TheChecksFindWhatIsFickle) {
  Specimen<ViewUtility> subject{"fickle", ParameterTable(),
                                [](const Value&) { return std::make_unique<Fickle>(); }};
  bool repeats = true, alone = true;
  for (const CheckResult& result : check_utility(subject)) {
    if (result.name == "repeatable") repeats = result.outcome == Outcome::passed;
    if (result.name == "alone") alone = result.outcome == Outcome::passed;
  }
  EXPECT_FALSE(repeats);
  EXPECT_FALSE(alone);
}

}  // namespace
}  // namespace lapwing
