// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/png.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/depth_folder.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class DepthFolders : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("depth_" + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    PosedDepthImage frame;
    frame.camera = camera_pose({1, 2, 3}, 0.4, -0.2);
    frame.image = {{8, 6, 10, 11, 3.5, 2.5}, std::vector<float>(48, 2.5f)};
    frame.image.depth[0] = 0;
    frame.image.depth[1] = std::numeric_limits<float>::infinity();
    frame.image.depth[2] = 1.2344f;
    frame.image.depth[3] = 70;
    write_depth_frame(folder_, "frame-2", frame);
    frame.camera.position.z() = 4;
    write_depth_frame(folder_, "frame-1", frame);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    write_file_atomically(folder_ / name, text);
  }
  // What is said of the folder as it is; all its images are read.
  std::string refusal() const {
    try {
      const DepthFolder folder(folder_);
      for (std::size_t i = 0; i < folder.size(); ++i) folder.read(i);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(DepthFolders, ReadsWhatWasWritten) {
  const DepthFolder folder(folder_);
  ASSERT_EQ(folder.size(), 2u);
  EXPECT_EQ(folder.name(0), "frame-1");
  EXPECT_EQ(folder.pinhole().width, 8);
  EXPECT_EQ(folder.pinhole().focal_y, 11);
  EXPECT_EQ(folder.pinhole().principal_x, 3.5);
  const PosedDepthImage frame = folder.read(1);
  EXPECT_LT((frame.camera.position - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT(frame.camera.orientation.angularDistance(camera_pose({}, 0.4, -0.2).orientation), 1e-7);
  EXPECT_EQ(frame.image.depth[0], 0);
  EXPECT_EQ(frame.image.depth[1], 0);
  EXPECT_EQ(frame.image.depth[2], 1.234f);
  EXPECT_EQ(frame.image.depth[3], 0);
  EXPECT_EQ(frame.image.depth[47], 2.5f);
}

TEST_F(DepthFolders, TheGreatestNumberIsNoMeasurement) {
  Grey16 image = decode_grey16_png(read_file(folder_ / "frame-2.depth.png"), "x");
  image.pixels[5] = 65535;
  image.pixels[6] = 65534;
  write("frame-2.depth.png", encode_grey16_png(image));
  const PosedDepthImage frame = DepthFolder(folder_).read(1);
  EXPECT_EQ(frame.image.depth[5], 0);
  EXPECT_EQ(frame.image.depth[6], 65.534f);
}

TEST_F(DepthFolders, PosesMustBeRotations) {
  const struct {
    const char* pose;
    const char* said;
  } cases[] = {
      {"1 0 0 0\n0 1 0 0\n0 0 1.1 0\n0 0 0 1\n", "no rotation"},
      {"1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n", "no rotation"},
      {"0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n", "no rotation"},
      {"1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n", "last row"},
      {"1 0 0 0\n0 1 0 0\n0 0 1 0\n", "got 12 numbers"},
      {"1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a finite number"},
      {"1 0 0 x\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "'x'"},
      {"", "got 0 numbers"},
  };
  for (const auto& c : cases) {
    write("frame-1.pose.txt", c.pose);
    EXPECT_NE(refusal().find(c.said), std::string::npos) << refusal();
    EXPECT_NE(refusal().find("frame-1.pose.txt"), std::string::npos) << refusal();
  }
  write("frame-1.pose.txt", "  1.0e+000 0 0 +5\r\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_EQ(refusal(), "");
  fs::remove(folder_ / "frame-1.pose.txt");
  EXPECT_NE(refusal().find("frame-1.pose.txt"), std::string::npos);
}

TEST_F(DepthFolders, ImagesMustBeWholeAndOfOneSize) {
  const std::string good = read_file(folder_ / "frame-2.depth.png");
  write("frame-2.depth.png", encode_grey16_png(Grey16{7, 6, std::vector<std::uint16_t>(42, 1)}));
  EXPECT_NE(refusal().find("7 by 6 pixels among those of 8 by 6"), std::string::npos) << refusal();
  for (std::size_t size = 0; size + 1 < good.size(); ++size) {
    write("frame-2.depth.png", good.substr(0, size));
    EXPECT_NE(refusal().find("frame-2.depth.png"), std::string::npos) << size;
  }
  write("frame-2.depth.png", encode_png(Picture{8, 6, std::vector<std::uint8_t>(144, 9)}));
  EXPECT_NE(refusal().find("16 bits"), std::string::npos) << refusal();
  // A header that claims four thousand million pixels.
  std::string huge = good;
  for (const std::size_t place : {16u, 20u}) huge.replace(place, 4, std::string("\0\1\0\0", 4));
  write("frame-2.depth.png", huge);
  EXPECT_NE(refusal(), "");
}

TEST_F(DepthFolders, ALostImageIsNoticed) {
  fs::remove(folder_ / "frame-2.depth.png");
  EXPECT_NE(refusal().find("frame-2.pose.txt"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("frame-2.depth.png is missing"), std::string::npos) << refusal();
}

TEST_F(DepthFolders, TheCameraMustMakeSense) {
  for (const char* text : {"0 0 3\n0 10 3\n0 0 1\n", "10 0 9\n0 10 3\n0 0 1\n",
                           "10 1 3\n0 10 3\n0 0 1\n", "10 0 3\n0 10 3\n", "10 0 3 0 -10 3 0 0 1"}) {
    write("camera-intrinsics.txt", text);
    EXPECT_NE(refusal().find("camera-intrinsics.txt"), std::string::npos) << text;
  }
  fs::remove(folder_ / "camera-intrinsics.txt");
  EXPECT_NE(refusal().find("camera-intrinsics.txt"), std::string::npos);
  fs::remove(folder_ / "frame-1.depth.png");
  fs::remove(folder_ / "frame-2.depth.png");
  EXPECT_NE(refusal().find("holds no depth image"), std::string::npos);
  EXPECT_THROW(DepthFolder(folder_ / "absent"), InputError);
}

// Names in folders of their own, another unit, poses of the other direction, a camera of 4 x 4.
TEST_F(DepthFolders, OtherLayouts) {
  const PosedDepthImage before = DepthFolder(folder_).read(1);
  fs::create_directories(folder_ / "depth");
  fs::create_directories(folder_ / "pose");
  for (const char* name : {"frame-1", "frame-2"}) {
    fs::rename(folder_ / (std::string(name) + ".depth.png"),
               folder_ / "depth" / (std::string(name) + ".png"));
    fs::rename(folder_ / (std::string(name) + ".pose.txt"),
               folder_ / "pose" / (std::string(name) + ".txt"));
  }
  write("k.txt", "10 0 3.5 0\n0 11 2.5 0\n0 0 1 0\n0 0 0 1\n");
  DepthLayout layout;
  layout.depth = "depth/*.png";
  layout.pose = "pose/*.txt";
  layout.intrinsics = "k.txt";
  layout.unit = 0.0002;
  layout.poses_to_camera = true;
  const DepthFolder folder(folder_, layout);
  ASSERT_EQ(folder.size(), 2u);
  EXPECT_EQ(folder.name(1), "frame-2");
  EXPECT_EQ(folder.pinhole().focal_y, 11);
  const PosedDepthImage frame = folder.read(1);
  EXPECT_EQ(frame.image.depth[2], static_cast<float>(1234 / 5000.0));
  EXPECT_LT((frame.camera.orientation * before.camera.position + frame.camera.position).norm(),
            1e-12);
  layout.camera = Eigen::Vector4d(20, 21, 3, 2);
  EXPECT_EQ(DepthFolder(folder_, layout).pinhole().focal_x, 20);
  layout.camera = Eigen::Vector4d(20, 21, 8, 2);
  EXPECT_THROW(DepthFolder(folder_, layout), InputError);
  layout.camera.reset();
  for (const char* bad : {"depth/one.png", "depth/*/*.png", "*/a.png", ""}) {
    DepthLayout wrong = layout;
    wrong.depth = bad;
    EXPECT_THROW(DepthFolder(folder_, wrong), InputError) << bad;
  }
  fs::remove(folder_ / "pose/frame-1.txt");
  try {
    DepthFolder(folder_, layout);
    ADD_FAILURE() << "an image without a pose";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("its pose pose/frame-1.txt is missing"),
              std::string::npos)
        << error.what();
  }
}

TEST(RealDepth, IsRead) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  const DepthFolder folder(fs::path(data) / "depth");
  ASSERT_EQ(folder.size(), 50u);
  EXPECT_EQ(folder.pinhole().width, 640);
  EXPECT_EQ(folder.pinhole().focal_x, 585);
  const PosedDepthImage frame = folder.read(0);
  double sum = 0, count = 0;
  for (const float d : frame.image.depth) {
    if (d > 0) sum += static_cast<double>(d), ++count;
  }
  EXPECT_GT(count, 200000);
  EXPECT_GT(sum / count, 0.5);
  EXPECT_LT(sum / count, 5);
}

}  // namespace
}  // namespace lapwing
