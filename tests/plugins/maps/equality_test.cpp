// SPDX-License-Identifier: Apache-2.0
// brick equals octomap to the bit.
#include "framework/core/random.h"
#include "framework/geometry/depth_camera.h"
#include "framework/map/map_file.h"
#include "tests/plugins/maps/depth_frames.h"
#include "tests/plugins/maps/map_pair.h"

namespace lapwing {
namespace {

Value parameters(const std::string& mode, double resolution) {
  Value value = Value::map();
  value.set("mode", mode);
  value.set("resolution", resolution);
  return value;
}

struct Pair {
  std::unique_ptr<Map> octomap, brick;
  explicit Pair(const Value& value)
      : octomap(make_map("octomap", value)), brick(make_map("brick", value)) {}
  void integrate(const PosedDepthImage& frame) {
    octomap->integrate(frame);
    brick->integrate(frame);
  }
};

class EqualMaps : public testing::TestWithParam<const char*> {};

TEST_P(EqualMaps, OnRealFrames) {
  if (!data_folder()) GTEST_SKIP() << "no ../shared/data (LAPWING_DATA)";
  Value value = parameters(GetParam(), 0.05);
  value.set("pixel_step", 2);
  value.set("observations", true);
  Pair pair(value);
  for (const PosedDepthImage& frame : real_frames(50)) pair.integrate(frame);
  EXPECT_EQ(first_difference(*pair.octomap, *pair.brick), "");
  EXPECT_GT(pair.brick->counts().occupied, 1000u);
  EXPECT_GT(pair.brick->counts().free, 20000u);
}

TEST_P(EqualMaps, InAStreet) {
  Value value = parameters(GetParam(), 0.2);
  value.set("maximum_range", 30.0);
  Pair pair(value);
  for (const PosedDepthImage& frame : street_frames(10, 64, 48)) pair.integrate(frame);
  EXPECT_EQ(first_difference(*pair.octomap, *pair.brick), "");
  EXPECT_TRUE(map_file_bytes(".ot", *pair.octomap) == map_file_bytes(".ot", *pair.brick));
}

TEST_P(EqualMaps, OverScansTooLongForABox) {
  // 3 cm voxels over 150 m: a byte for every voxel of the box would be 40 GB.
  Pair pair(parameters(GetParam(), 0.03));
  Random random(11);
  std::vector<Eigen::Vector3f> points;
  for (int k = 0; k < 60; ++k)
    points.push_back({static_cast<float>(random.uniform(-80, 80)),
                      static_cast<float>(random.uniform(-80, 80)),
                      static_cast<float>(random.uniform(-40, 40))});
  points.push_back({0.011f, 0.012f, 0.001f});
  for (int scan = 0; scan < 3; ++scan) {
    pair.octomap->integrate(points, {0.01f, 0.01f, 0.02f});
    pair.brick->integrate(points, {0.01f, 0.01f, 0.02f});
  }
  EXPECT_EQ(first_difference(*pair.octomap, *pair.brick), "");
}

// Tiles of views are cast together: from anywhere, at any zoom, with ranges that end before them.
TEST(EqualCasts, InWholeViews) {
  Value value = parameters("discretised", 0.2);
  value.set("maximum_range", 30.0);
  Pair pair(value);
  for (const PosedDepthImage& frame : street_frames(40, 64, 48)) pair.integrate(frame);
  Random random(23);
  int met = 0, nothing = 0;
  for (int view = 0; view < 60; ++view) {
    // Odd sizes, so that some batches are no tiles; narrow and wide.
    const int width = 16 + 7 * (view % 5), height = 24 + 5 * (view % 3);
    const double focal = view % 7 == 0 ? 2000 : random.uniform(8, 120);
    const Pinhole pinhole{width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
    Eigen::Vector3d from(random.uniform(-40, 40), random.uniform(-2, 2), random.uniform(1, 14));
    if (view % 3 == 0)  // a corner of voxels
      for (double& at : from) at = 0.2 * std::round(5 * at);
    const bool level = view % 4 == 0;  // rays along axes and diagonals
    const Pose camera = level ? camera_pose(from, 0.78539816339744831 * (view % 8), 0)
                              : camera_pose(from, random.uniform(-4, 4), random.uniform(-1.5, 1));
    std::vector<MapRay> rays;
    for (const Eigen::Vector3d& ray_C : tiled_pixel_rays(pinhole))
      rays.push_back({from, (camera.orientation * ray_C).normalized(),
                      view % 2 ? 40 : random.uniform(0.01, 2)});
    std::vector<MapRayHit> hits(rays.size()), right(rays.size());
    pair.brick->cast(rays, hits);
    pair.octomap->cast(rays, right);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      ASSERT_TRUE(hits[k].voxel == right[k].voxel && hits[k].state == right[k].state &&
                  hits[k].distance == right[k].distance)
          << "ray " << k << " of view " << view << ": " << hits[k].voxel.x << " " << hits[k].voxel.y
          << " " << hits[k].voxel.z << " at " << hits[k].distance << " m, not " << right[k].voxel.x
          << " " << right[k].voxel.y << " " << right[k].voxel.z << " at " << right[k].distance;
      (right[k].state == VoxelState::free ? nothing : met) += 1;
    }
  }
  EXPECT_GT(met, 20000);
  EXPECT_GT(nothing, 1000);
}

INSTANTIATE_TEST_SUITE_P(Modes, EqualMaps, testing::Values("discretised", "exact"));

}  // namespace
}  // namespace lapwing
