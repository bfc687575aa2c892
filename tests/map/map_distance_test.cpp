// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map_distance.h"

#include "framework/core/random.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

// Free from -8 to 8 m, voxels of 0.5 m, with the given voxels occupied.
SmallMap room(const std::vector<VoxelKey>& occupied) {
  SmallMap map(0.5);
  std::vector<VoxelLeaf> leaves;
  for (int k = 0; k < 8; ++k)
    leaves.push_back({{static_cast<std::uint16_t>(32768 - (k & 1 ? 0 : 16)),
                       static_cast<std::uint16_t>(32768 - (k & 2 ? 0 : 16)),
                       static_cast<std::uint16_t>(32768 - (k & 4 ? 0 : 16))},
                      4,
                      0,
                      -2.0f});
  for (const VoxelKey& key : occupied) leaves.push_back({key, 0, 0, 2.0f});
  map.import(leaves);
  return map;
}

// The definition, voxel by voxel: from the middle of one to the nearest cube of the other kind.
double plain_distance(const Map& map, const VoxelKey& from, double reach) {
  const bool blocked = map.read(from).state != VoxelState::free;
  const int margin = static_cast<int>(reach / 0.5) + 1;
  double best = reach;
  for (int z = -margin; z <= margin; ++z)
    for (int y = -margin; y <= margin; ++y)
      for (int x = -margin; x <= margin; ++x) {
        const VoxelKey key{static_cast<std::uint16_t>(from.x + x),
                           static_cast<std::uint16_t>(from.y + y),
                           static_cast<std::uint16_t>(from.z + z)};
        if ((map.read(key).state != VoxelState::free) == blocked) continue;
        const auto beyond = [](int d) { return std::max(std::abs(d) - 0.5, 0.0) * 0.5; };
        best = std::min(best, std::hypot(beyond(x), beyond(y), beyond(z)));
      }
  return blocked ? -best : best;
}

TEST(MapDistance, IsExactInTheMiddleOfVoxels) {
  Random random(6);
  std::vector<VoxelKey> occupied;
  for (int k = 0; k < 60; ++k)
    occupied.push_back({static_cast<std::uint16_t>(random.integer(32760, 32775)),
                        static_cast<std::uint16_t>(random.integer(32760, 32775)),
                        static_cast<std::uint16_t>(random.integer(32760, 32775))});
  const SmallMap map = room(occupied);
  const MapDistance field(map, {-7.9, -7.9, -7.9}, {7.9, 7.9, 7.9}, 3);
  for (int k = 0; k < 400; ++k) {
    const VoxelKey key{static_cast<std::uint16_t>(random.integer(32753, 32782)),
                       static_cast<std::uint16_t>(random.integer(32753, 32782)),
                       static_cast<std::uint16_t>(random.integer(32753, 32782))};
    EXPECT_NEAR(field.distance(map.grid().center(key), nullptr), plain_distance(map, key, 3), 1e-5);
  }
}

TEST(MapDistance, UnknownIsAWall) {
  const MapDistance field(room({}), {-8, -8, -8}, {7.99, 7.99, 7.99}, 5);
  Eigen::Vector3d gradient;
  EXPECT_NEAR(field.distance({-6, 0, 0}, &gradient), 2, 1e-5);
  EXPECT_LT((gradient - Eigen::Vector3d::UnitX()).norm(), 1e-5);
  EXPECT_NEAR(field.distance({-8, 0, 0}, nullptr), 0, 1e-5);
  EXPECT_EQ(field.distance({0, 0, 0}, &gradient), 5);  // beyond reach
  EXPECT_EQ(gradient.norm(), 0);
  EXPECT_EQ(field.reach(), 5);
}

TEST(MapDistance, TheGradientIsTheDerivative) {
  const SmallMap map = room({{32770, 32771, 32766}, {32764, 32768, 32768}});
  const MapDistance field(map, {-5, -5, -5}, {5, 5, 5}, 4);
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    Eigen::Vector3d p(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4));
    if (k % 5 == 0) p *= 2.5;  // some outside
    const Eigen::Vector3d in_cell = ((p / 0.5).array() - 0.5) - ((p / 0.5).array() - 0.5).floor();
    if (in_cell.minCoeff() < 1e-3 || in_cell.maxCoeff() > 1 - 1e-3) continue;  // kinks
    Eigen::Vector3d gradient;
    field.distance(p, &gradient);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(i);
      const double slope =
          (field.distance(p + step, nullptr) - field.distance(p - step, nullptr)) / 2e-6;
      EXPECT_NEAR(gradient[i], slope, 1e-4) << p.transpose();
    }
  }
}

TEST(MapDistance, OutsideTheWayBackIsUphill) {
  const MapDistance field(room({}), {-2, -2, -2}, {1.99, 1.99, 1.99}, 3);
  Eigen::Vector3d gradient;
  const double inside = field.distance({2, 0, 0}, nullptr);
  EXPECT_NEAR(field.distance({7, 0, 0}, &gradient), inside - 5, 1e-6);
  EXPECT_NEAR(gradient.x(), -1, 1e-9);
}

TEST(MapDistance, BadInput) {
  const SmallMap map = room({});
  EXPECT_THROW(MapDistance(map, {0, 0, 0}, {0, 1, 1}, 1), InputError);
  EXPECT_THROW(MapDistance(map, {0, 0, NAN}, {1, 1, 1}, 1), InputError);
  EXPECT_THROW(MapDistance(map, {0, 0, 0}, {1, 1, 1e9}, 1), InputError);
  EXPECT_THROW(MapDistance(map, {0, 0, 0}, {1, 1, 1}, 0), InputError);
  EXPECT_THROW(MapDistance(map, {0, 0, 0}, {1, 1, 1}, INFINITY), InputError);
  EXPECT_THROW(MapDistance(map, {-5000, -5000, -5000}, {5000, 5000, 5000}, 1), InputError);
}

}  // namespace
}  // namespace lapwing
