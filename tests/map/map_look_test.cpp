// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map_look.h"

#include <random>

#include <gmock/gmock.h>

#include "tests/map/small_map.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

VoxelKey voxel_at(int x, int y, int z) {
  const auto part = [](int i) { return static_cast<std::uint16_t>(kCenterKey + i); };
  return {part(x), part(y), part(z)};
}

// Voxels of any state in a block of 9 x 7 x 5, and two cubes beside it.
SmallMap random_map() {
  SmallMap map(0.5);
  std::mt19937 random(3);
  std::vector<VoxelLeaf> leaves;
  for (int x = -4; x <= 4; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = -2; z <= 2; ++z) {
        const int kind = static_cast<int>(random() % 4);
        if (kind == 0) continue;
        leaves.push_back({voxel_at(x, y, z), 0, 0, kind == 1 ? -1.5f : kind == 2 ? 1.75f : 0.25f});
      }
  leaves.push_back({voxel_at(8, 8, 0), 2, 0, -2.0f});
  leaves.push_back({voxel_at(8, -16, -8), 3, 0, 2.5f});
  map.import(leaves);
  return map;
}

CellState expected(const VoxelReading& reading) {
  if (!reading.known) return CellState::unknown;
  return reading.state == VoxelState::free       ? CellState::free
         : reading.state == VoxelState::occupied ? CellState::occupied
                                                 : CellState::between;
}

VoxelKey cell_voxel(const MapSlice& slice, int column, int row) {
  int at[3] = {0, 0, 0};
  at[slice.axis] = slice.layer;
  at[slice.across()] = slice.first[0] + column;
  at[slice.up()] = slice.first[1] + row;
  return {static_cast<std::uint16_t>(at[0]), static_cast<std::uint16_t>(at[1]),
          static_cast<std::uint16_t>(at[2])};
}

// Every cell of every layer is what the map reads there, and the counts are theirs.
TEST(MapLook, ASliceIsWhatTheMapReads) {
  const SmallMap map = random_map();
  const VoxelBox bounds = *map.bounds();
  for (int axis = 0; axis < 3; ++axis)
    for (int layer = bounds.lower[axis]; layer <= bounds.upper[axis]; ++layer) {
      const MapSlice slice = slice_of(map, axis, map.grid().center(layer), 1 << 20);
      ASSERT_EQ(slice.layer, layer);
      ASSERT_EQ(slice.level, 0);
      ASSERT_EQ(slice.columns, bounds.upper[slice.across()] - bounds.lower[slice.across()] + 1);
      ASSERT_EQ(slice.rows, bounds.upper[slice.up()] - bounds.lower[slice.up()] + 1);
      std::uint64_t counts[4] = {};
      for (int row = 0; row < slice.rows; ++row)
        for (int column = 0; column < slice.columns; ++column) {
          const auto place = static_cast<std::size_t>(row * slice.columns + column);
          const VoxelReading reading = map.read(cell_voxel(slice, column, row));
          ASSERT_EQ(slice.states[place], expected(reading));
          ASSERT_EQ(slice.log_odds[place], reading.known ? reading.log_odds : 0);
          ++counts[static_cast<int>(slice.states[place])];
        }
      EXPECT_EQ(slice.unknown, counts[0]);
      EXPECT_EQ(slice.free, counts[1]);
      EXPECT_EQ(slice.occupied, counts[2]);
      EXPECT_EQ(slice.between, counts[3]);
    }
}

// Of few cells each says the most that one of its voxels says; the counts stay those of voxels.
TEST(MapLook, ALargeSliceHasLargerCells) {
  const SmallMap map = random_map();
  const MapSlice fine = slice_of(map, 2, 0.1, 1 << 20), coarse = slice_of(map, 2, 0.1, 60);
  EXPECT_GT(coarse.level, 0);
  EXPECT_LE(coarse.columns * coarse.rows, 60);
  EXPECT_EQ(coarse.occupied, fine.occupied);
  EXPECT_EQ(coarse.unknown, fine.unknown);
  for (int row = 0; row < fine.rows; ++row)
    for (int column = 0; column < fine.columns; ++column) {
      if (fine.states[static_cast<std::size_t>(row * fine.columns + column)] != CellState::occupied)
        continue;
      const VoxelKey key = cell_voxel(fine, column, row);
      const int x = (key.x - coarse.first[0]) >> coarse.level;
      const int y = (key.y - coarse.first[1]) >> coarse.level;
      ASSERT_EQ(coarse.states[static_cast<std::size_t>(y * coarse.columns + x)],
                CellState::occupied);
    }
}

TEST(MapLook, APlaceOutsideOfTheMapIsRefusedWithItsEnds) {
  const SmallMap map = random_map();
  try {
    slice_of(map, 2, 99, 100);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("z = 99 m lies outside of the map, which reaches from -4 "
                                        "to 2 m"));
  }
  EXPECT_EQ(slice_of(map, 2, 2, 1 << 20).layer, map.bounds()->upper.z);  // its upper face
  EXPECT_THROW(slice_of(map, 0, std::nan(""), 100), InputError);
  EXPECT_THROW(slice_of(SmallMap(), 0, 0, 100), InputError);
}

// From anywhere, through free and unknown voxels, against a walk in small steps.
TEST(MapLook, TheFirstOccupiedVoxelOnARayIsFound) {
  const SmallMap map = random_map();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  int found = 0;
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d origin(20 * any(random), 20 * any(random), 20 * any(random));
    const Eigen::Vector3d to(2 * any(random), 1.5 * any(random), any(random));
    const Eigen::Vector3d direction = (to - origin).normalized();
    std::optional<VoxelKey> stepped;
    for (double d = 0; d < 60 && !stepped; d += 0.002) {
      const VoxelKey key = map.grid().key(origin + d * direction);
      if (map.read(key).state == VoxelState::occupied) stepped = key;
    }
    const auto hit = first_occupied(map, origin, direction);
    // A step may pass over a corner that the ray cuts.
    if (hit != stepped && hit) {
      const Eigen::Vector3d middle = map.grid().center(*hit) - origin;
      EXPECT_LT(middle.cross(direction).norm(), 0.5 * std::sqrt(3.0) * 0.5 + 1e-9);
      continue;
    }
    EXPECT_EQ(hit, stepped);
    found += hit.has_value();
  }
  EXPECT_GT(found, 200);
  // Along an axis, on the face between voxels, and away from the map.
  EXPECT_TRUE(first_occupied(map, {5, -7.9, 50}, {0, 0, -1}));
  EXPECT_FALSE(first_occupied(map, {5, -7.9, 50}, {0, 0, 1}));
  EXPECT_FALSE(first_occupied(SmallMap(), {0, 0, 9}, {0, 0, -1}));
}

}  // namespace
}  // namespace lapwing
