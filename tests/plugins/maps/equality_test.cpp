// brick equals octomap to the bit.
#include "framework/core/random.h"
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

INSTANTIATE_TEST_SUITE_P(Modes, EqualMaps, testing::Values("discretised", "exact"));

}  // namespace
}  // namespace lapwing
