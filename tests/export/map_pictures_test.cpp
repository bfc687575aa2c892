// SPDX-License-Identifier: Apache-2.0
// Pictures of small maps, pixel by pixel.
#include "framework/export/map_pictures.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/map/small_map.h"

namespace lapwing {
namespace {

constexpr float kOccupiedOdds = 3, kFreeOdds = -3, kNeither = 0;

// Voxels of half a metre; places count from the origin, x east, y north, z up.
struct PlacedVoxel {
  int x, y, z;
  float log_odds;
};

SmallMap map_of(std::initializer_list<PlacedVoxel> voxels) {
  SmallMap map(0.5);
  std::vector<VoxelLeaf> leaves;
  for (const PlacedVoxel& v : voxels) {
    VoxelLeaf leaf;
    leaf.key = map.grid().key(Eigen::Vector3d(v.x, v.y, v.z) / 2 + Eigen::Vector3d::Constant(0.25));
    leaf.log_odds = v.log_odds;
    leaves.push_back(leaf);
  }
  map.import(leaves);
  return map;
}

std::array<int, 3> pixel(const Picture& picture, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * picture.width + x);
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

int brightness(const std::array<int, 3>& p) {
  return p[0] + p[1] + p[2];
}

TEST(MapPictures, ACutShowsEastToTheRightAndNorthUp) {
  // Occupied in the south-west, free in the north-east, nothing known of the other two.
  const SmallMap map =
      map_of({{0, 0, 0, kOccupiedOdds}, {1, 1, 0, kFreeOdds}, {0, 1, 5, kOccupiedOdds}});
  const MapPicture cut = cut_picture(map, 0.2, 2);
  ASSERT_EQ(cut.picture.width, 2);
  ASSERT_EQ(cut.picture.height, 2);
  EXPECT_EQ(cut.metres, 0.5);
  EXPECT_EQ(cut.lowest, 0.2);
  const int occupied = brightness(pixel(cut.picture, 0, 1)),
            free = brightness(pixel(cut.picture, 1, 0));
  const int unknown = brightness(pixel(cut.picture, 0, 0));
  EXPECT_LT(occupied, unknown);
  EXPECT_LT(unknown, free);
  EXPECT_EQ(brightness(pixel(cut.picture, 1, 1)), unknown);
  // At another height the other voxel is cut.
  const MapPicture above = cut_picture(map, 2.7, 2);
  EXPECT_EQ(brightness(pixel(above.picture, 0, 0)), occupied);
  EXPECT_EQ(brightness(pixel(above.picture, 0, 1)), unknown);
}

TEST(MapPictures, TheHighestOccupiedVoxelOfAColumnShows) {
  const SmallMap map = map_of({{0, 0, 0, kOccupiedOdds},
                               {0, 0, 6, kOccupiedOdds},
                               {0, 0, 9, kFreeOdds},
                               {1, 0, 0, kOccupiedOdds},
                               {2, 0, 3, kFreeOdds}});
  const MapPicture heights = height_picture(map, 3);
  ASSERT_EQ(heights.picture.width, 3);
  ASSERT_EQ(heights.picture.height, 1);
  EXPECT_DOUBLE_EQ(heights.lowest, 0);
  EXPECT_DOUBLE_EQ(heights.highest, 3.5) << "the top of the highest occupied voxel";
  // High is yellow, low is dark blue, free alone is light.
  const auto high = pixel(heights.picture, 0, 0), low = pixel(heights.picture, 1, 0);
  EXPECT_GT(high[0], 150);
  EXPECT_LT(high[2], 100);
  EXPECT_GT(low[2], low[0]);
  EXPECT_EQ(pixel(heights.picture, 2, 0), (std::array<int, 3>{236, 236, 230}));
}

// Columns kept aside draw the same, and a ceiling can be left out of them.
TEST(MapPictures, ColumnsAreKeptWithoutTheMap) {
  const SmallMap map = map_of({{0, 0, 0, kOccupiedOdds},
                               {1, 1, 2, kOccupiedOdds},
                               {0, 0, 8, kOccupiedOdds},
                               {1, 0, 1, kFreeOdds}});
  const MapColumns columns = map_columns(map);
  EXPECT_EQ(height_picture(columns, columns, 64).picture.rgb, height_picture(map, 64).picture.rgb);
  const MapPicture low = height_picture(map_columns(map, 3.0), map_columns(map, 3.0), 64);
  EXPECT_DOUBLE_EQ(low.highest, 1.5) << "the ceiling at 4 m is left out";
  EXPECT_DOUBLE_EQ(height_picture(map, 64).highest, 4.5);
  // What was smaller is drawn within the frame of what it became.
  const MapColumns before = map_columns(map_of({{0, 0, 0, kOccupiedOdds}}));
  const MapPicture framed = height_picture(before, columns, 2);
  EXPECT_EQ(framed.picture.width, 2);
  EXPECT_DOUBLE_EQ(framed.highest, 4.5);
  EXPECT_EQ(pixel(framed.picture, 1, 0), (std::array<int, 3>{58, 62, 70})) << "not known yet";
}

TEST(MapPictures, LargeMapsShareTheirPixelsAndSmallOnesAreMagnified) {
  SmallMap map(0.5);
  std::vector<VoxelLeaf> leaves;
  for (int x = 0; x < 10; ++x) {
    VoxelLeaf leaf;
    leaf.key = map.grid().key(Eigen::Vector3d(0.5 * x + 0.25, 0.25, 0.25));
    leaf.log_odds = x == 4 ? kOccupiedOdds : kFreeOdds;
    leaves.push_back(leaf);
  }
  map.import(leaves);
  const MapPicture shared = cut_picture(map, 0.25, 5);
  EXPECT_EQ(shared.picture.width, 5);
  EXPECT_EQ(shared.metres, 1) << "two voxels to a pixel";
  for (int x = 0; x < 5; ++x)  // what is in the way shows
    EXPECT_EQ(brightness(pixel(shared.picture, x, 0)) < 300, x == 2) << x;
  const MapPicture magnified = cut_picture(map, 0.25, 35);
  EXPECT_EQ(magnified.picture.width, 30);
  EXPECT_EQ(magnified.picture.height, 3);
  EXPECT_EQ(magnified.metres, 0.5) << "of a square, not of a pixel";
  for (int x = 0; x < 30; ++x)
    EXPECT_EQ(brightness(pixel(magnified.picture, x, 1)) < 300, x / 3 == 4) << x;
}

TEST(MapPictures, AnEmptyMapHasNone) {
  const SmallMap empty(0.5);
  EXPECT_EQ(height_picture(empty, 64).picture.width, 0);
  EXPECT_EQ(cut_picture(empty, 0, 64).picture.width, 0);
  EXPECT_TRUE(map_columns(empty).empty());
  // Of a voxel that is neither free nor occupied it shows that one.
  const MapPicture even = cut_picture(map_of({{0, 0, 0, kNeither}}), 0.25, 1);
  ASSERT_EQ(even.picture.width, 1);
  EXPECT_EQ(pixel(even.picture, 0, 0), (std::array<int, 3>{140, 140, 146}));
}

TEST(MapPictures, NearIsBrightAndWhatIsNotMeasuredIsBlack) {
  DepthImage image;
  image.pinhole = {5, 1, 5, 5, 2, 0};
  image.depth = {1, 2, 8, 0, std::numeric_limits<float>::infinity()};
  const Picture picture = depth_picture(image);
  ASSERT_EQ(picture.width, 5);
  EXPECT_GT(brightness(pixel(picture, 0, 0)), brightness(pixel(picture, 1, 0)));
  EXPECT_GT(brightness(pixel(picture, 1, 0)), brightness(pixel(picture, 2, 0)));
  EXPECT_EQ(brightness(pixel(picture, 3, 0)), 0);
  EXPECT_EQ(pixel(picture, 4, 0), (std::array<int, 3>{24, 30, 66}));
  // One depth alone is near; what is no number or negative is not measured.
  image.depth = {3, std::nanf(""), -1, 0, 0};
  const Picture one = depth_picture(image);
  EXPECT_EQ(pixel(one, 0, 0), (std::array<int, 3>{253, 231, 37}));
  for (int x = 1; x < 5; ++x) EXPECT_EQ(brightness(pixel(one, x, 0)), 0) << x;
}

}  // namespace
}  // namespace lapwing
