// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/random.h"
#include "framework/geometry/depth_camera.h"
#include "framework/photogrammetry/colmap_depth.h"
#include "framework/photogrammetry/exif_position.h"
#include "framework/photogrammetry/model_placement.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kCameras =
    "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n"
    "1 OPENCV 64 48 60 61 32.5 24 0.01 -0.002 0.001 0.002\n";
constexpr const char* kImages =
    "# two lines each\n"
    "2 1 0 0 0 0 0 0 1 b c.png\n10.5 20 7 30 40 -1\n"
    "1 0.8 0 0.6 0 1 2 3 1 a.png\n\n";
constexpr const char* kPoints = "7 1 2 8 10 20 30 0.5 2 0 1 0\n";

template <class T>
void put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof raw);
  bytes.append(raw, sizeof raw);
}

// The same model as the texts have.
std::string binary_images() {
  std::string bytes;
  put<std::uint64_t>(bytes, 2);
  put<std::uint32_t>(bytes, 2);
  for (const double v : {1., 0., 0., 0., 0., 0., 0.}) put(bytes, v);
  put<std::uint32_t>(bytes, 1);
  bytes += std::string("b c.png") + '\0';
  put<std::uint64_t>(bytes, 2);
  put(bytes, 10.5), put(bytes, 20.), put<std::int64_t>(bytes, 7);
  put(bytes, 30.), put(bytes, 40.), put<std::int64_t>(bytes, -1);
  put<std::uint32_t>(bytes, 1);
  for (const double v : {0.8, 0., 0.6, 0., 1., 2., 3.}) put(bytes, v);
  put<std::uint32_t>(bytes, 1);
  bytes += std::string("a.png") + '\0';
  put<std::uint64_t>(bytes, 0);
  return bytes;
}

std::string binary_cameras(int model, std::size_t parameters) {
  std::string bytes;
  put<std::uint64_t>(bytes, 1);
  put<std::uint32_t>(bytes, 1);
  put<std::int32_t>(bytes, model);
  put<std::uint64_t>(bytes, 64);
  put<std::uint64_t>(bytes, 48);
  for (std::size_t k = 0; k < parameters; ++k) put(bytes, 20.0 + static_cast<double>(k));
  return bytes;
}

TEST(ColmapModels, TextAndBinaryAreTheSame) {
  const auto text = colmap_images(kImages, false, "t"),
             binary = colmap_images(binary_images(), true, "b");
  ASSERT_EQ(text.size(), 2u);
  ASSERT_EQ(binary.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(text[k].name, binary[k].name);
    EXPECT_EQ(text[k].camera, binary[k].camera);
    EXPECT_EQ(text[k].pose.position, binary[k].pose.position);
    EXPECT_EQ(text[k].pose.orientation.coeffs(), binary[k].pose.orientation.coeffs());
    ASSERT_EQ(text[k].features.size(), binary[k].features.size());
  }
  EXPECT_EQ(text[0].name, "b c.png");
  EXPECT_EQ(text[0].features[0].point, 7);
  EXPECT_EQ(text[0].features[1].point, -1);
  // World to camera in the file, the place of the camera here.
  const Vector3d centre = text[1].pose.position;
  EXPECT_LT((Eigen::Quaterniond(0.8, 0, 0.6, 0) * centre + Vector3d(1, 2, 3)).norm(), 1e-12);
}

TEST(ColmapModels, WhateverIsCutShortIsRefused) {
  const std::string images = binary_images(), cameras = binary_cameras(1, 4);
  for (std::size_t size = 0; size < images.size(); ++size)
    EXPECT_THROW(colmap_images(images.substr(0, size), true, "b"), InputError) << size;
  for (std::size_t size = 0; size < cameras.size(); ++size)
    EXPECT_THROW(colmap_cameras(cameras.substr(0, size), true, "b"), InputError) << size;
  EXPECT_THROW(colmap_images(images + "x", true, "b"), InputError);
  std::string huge = images;
  huge[7] = '\x7f';
  EXPECT_THROW(colmap_images(huge, true, "b"), InputError);
  EXPECT_THROW(colmap_images("1 1 0 0 0 0 0 0 1 a.png", false, "t"), InputError);
  EXPECT_THROW(colmap_images("1 0 0 0 0 0 0 0 1 a.png\n\n", false, "t"), InputError);
  EXPECT_THROW(colmap_images("1 1 0 0 0 0 nan 0 1 a.png\n\n", false, "t"), InputError);
  EXPECT_THROW(colmap_points("7 1 2 8 10 20 300 0.5\n", false, "t"), InputError);
  EXPECT_THROW(colmap_points("7 1 2 8 10 20 30 0.5 2\n", false, "t"), InputError);
}

TEST(ColmapModels, OtherCamerasAreRefusedByName) {
  for (const auto& [number, name] :
       {std::pair(6, "FULL_OPENCV"), std::pair(7, "FOV"), std::pair(10, "THIN_PRISM_FISHEYE")}) {
    try {
      colmap_cameras(binary_cameras(number, 12), true, "b");
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(colmap_cameras(binary_cameras(99, 4), true, "b"), InputError);
  EXPECT_THROW(colmap_cameras("1 PINHOLE 64 48 60 0 32 24\n", false, "t"), InputError);
  EXPECT_THROW(colmap_cameras("1 PINHOLE 64 48 60 61 32\n", false, "t"), InputError);
}

// Known answers: the formulas by hand at (0.3, -0.2).
TEST(ColmapCameras, DistortAsColmapDoes) {
  ColmapCamera camera{1, "SIMPLE_RADIAL", 640, 480, {500, 320, 240, 0.1}};
  const double r2 = 0.13;
  EXPECT_NEAR(camera.pixel({0.3, -0.2}).x(), 320 + 500 * 0.3 * (1 + 0.1 * r2), 1e-9);
  camera = {1, "OPENCV", 640, 480, {500, 510, 320, 240, 0.1, -0.05, 0.01, 0.02}};
  const double radial = 1 + 0.1 * r2 - 0.05 * r2 * r2;
  EXPECT_NEAR(camera.pixel({0.3, -0.2}).x(),
              320 + 500 * (0.3 * radial + 2 * 0.01 * -0.06 + 0.02 * (r2 + 0.18)), 1e-9);
  EXPECT_NEAR(camera.pixel({0.3, -0.2}).y(),
              240 + 510 * (-0.2 * radial + 2 * 0.02 * -0.06 + 0.01 * (r2 + 0.08)), 1e-9);
  camera = {1, "OPENCV_FISHEYE", 640, 480, {500, 500, 320, 240, 0, 0, 0, 0}};
  EXPECT_NEAR(camera.pixel({1, 0}).x(), 320 + 500 * EIGEN_PI / 4, 1e-9);
}

TEST(ColmapCameras, DistortionIsUndone) {
  const ColmapCamera cameras[] = {
      {1, "SIMPLE_PINHOLE", 640, 480, {500, 320, 240}},
      {1, "PINHOLE", 640, 480, {500, 490, 320, 240}},
      {1, "SIMPLE_RADIAL", 640, 480, {500, 320, 240, -0.1}},
      {1, "RADIAL", 640, 480, {500, 320, 240, -0.1, 0.02}},
      {1, "OPENCV", 640, 480, {500, 490, 320, 240, -0.1, 0.02, 0.001, -0.002}},
      {1, "OPENCV_FISHEYE", 640, 480, {300, 300, 320, 240, 0.01, -0.01, 0.002, 0}}};
  Random random(3);
  for (const ColmapCamera& camera : cameras)
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector2d d(random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5));
      const auto back = camera.direction(camera.pixel(d));
      ASSERT_TRUE(back.has_value()) << camera.model;
      EXPECT_LT((*back - d).norm(), 1e-9) << camera.model;
    }
  // A lens that folds back has no direction for the corners.
  const ColmapCamera folding{1, "SIMPLE_RADIAL", 640, 480, {300, 320, 240, -1}};
  EXPECT_FALSE(folding.direction({0, 0}).has_value());
}

std::vector<PlacedPoint> placed_points(const Similarity& truth, double noise, int count) {
  Random random(11);
  std::vector<PlacedPoint> points;
  for (int k = 0; k < count; ++k) {
    PlacedPoint p;
    p.name = std::to_string(k);
    p.model = Vector3d(random.normal(), random.normal(), 0.3 * random.normal());
    p.world =
        truth.apply(p.model) + noise * Vector3d(random.normal(), random.normal(), random.normal());
    points.push_back(p);
  }
  return points;
}

TEST(Placement, IsFoundDespiteWrongPositions) {
  const Similarity truth{
      17, Eigen::Quaterniond(Eigen::AngleAxisd(2, Vector3d(1, 2, 3).normalized())), {5, -6, 70}};
  const PlacementFit exact = fit_placement(placed_points(truth, 0, 10), 1);
  EXPECT_NEAR(exact.to_world.scale, 17, 1e-9);
  EXPECT_LT(exact.to_world.rotation.angularDistance(truth.rotation), 1e-7);
  EXPECT_LT(exact.residual, 1e-9);
  auto points = placed_points(truth, 0.5, 40);
  for (const std::size_t k : {3u, 9u, 20u, 33u}) points[k].world += Vector3d(60, 0, -40);
  const PlacementFit fit = fit_placement(points, 1);
  EXPECT_EQ(fit.left_out, (std::vector<std::string>{"3", "9", "20", "33"}));
  EXPECT_EQ(fit.used, 36u);
  EXPECT_NEAR(fit.to_world.scale, 17, 0.3);
  EXPECT_LT(fit.to_world.rotation.angularDistance(truth.rotation), 0.02);
  EXPECT_NEAR(fit.residual, 0.5 * std::sqrt(3), 0.2);
}

TEST(Placement, IsRefusedWhereItIsOpen) {
  std::vector<PlacedPoint> line;
  for (int k = 0; k < 8; ++k) line.push_back({"", Vector3d(k, 0, 0), Vector3d(3 * k, 1, 2)});
  EXPECT_THROW(fit_placement(line, 1), InputError);
  EXPECT_THROW(fit_placement({line[0], line[1]}, 1), InputError);
  auto wild = placed_points({}, 30, 20);
  EXPECT_THROW(fit_placement(wild, 1), InputError);
  EXPECT_THROW(fit_placement(placed_points({}, 0, 9), 0), InputError);
}

TEST(Placement, ScaleByDistances) {
  const Vector3d o = Vector3d::Zero();
  EXPECT_DOUBLE_EQ(fit_scale({{o, {2, 0, 0}, 5}}).scale, 2.5);
  const ScaleFit fit = fit_scale({{o, {2, 0, 0}, 5.05}, {o, {0, 4, 0}, 10}, {o, {0, 0, 1}, 2.5}});
  EXPECT_NEAR(fit.scale, 2.5, 0.02);
  EXPECT_LT(fit.worst, 0.02);
  EXPECT_THROW(fit_scale({{o, {2, 0, 0}, 5}, {o, {0, 2, 0}, 6}}), InputError);
  EXPECT_THROW(fit_scale({{o, o, 5}}), InputError);
  EXPECT_THROW(fit_scale({}), InputError);
}

TEST(ColmapDepthMaps, AreReadAndCutOnesRefused) {
  std::string bytes = "3&2&1&";
  for (int k = 0; k < 6; ++k) put(bytes, 1.5f * static_cast<float>(k));
  const ColmapDepthMap map = read_colmap_depth_map(bytes, "m");
  EXPECT_EQ(map.width, 3);
  EXPECT_EQ(map.depth[4], 6.0f);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(read_colmap_depth_map(bytes.substr(0, size), "m"), InputError) << size;
  EXPECT_THROW(read_colmap_depth_map("3&2&3&" + bytes.substr(6), "m"), InputError);
  EXPECT_THROW(read_colmap_depth_map("999999999&9&1&" + bytes.substr(6), "m"), InputError);
}

// A ground of points, seen from above by cameras: its normals point up, a point far away is left
// out, and depth images put the points where they are.
TEST(ColmapSurfaces, NormalsPointToTheCameras) {
  ColmapModel model;
  model.cameras[1] = {1, "PINHOLE", 640, 480, {500, 500, 320, 240}};
  for (std::uint32_t k = 0; k < 3; ++k) {
    ColmapImage image;
    image.id = k;
    image.camera = 1;
    image.name = std::to_string(k);
    image.pose = camera_pose({2.0 * k, 4, 10}, 0, -1.5707);
    model.images.push_back(image);
  }
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      model.points.push_back(
          {x * 8 + y, {0.5 * x, 2 + 0.5 * y, 0.01 * ((x + y) % 2)}, {}, 0, {0, 1, 2}});
  model.points.push_back({100, {300, 0, 0}, {}, 0, {0, 1, 2}});
  model.points.push_back({101, {1, 3, 5}, {}, 0, {0, 1}});  // seen by two
  const std::vector<FusedPoint> surface = surface_of_colmap(model);
  ASSERT_EQ(surface.size(), 64u);
  for (const FusedPoint& point : surface) EXPECT_GT(point.normal.z(), 0.98);
  EXPECT_LT(thinned(surface, 1).size(), 40u);
  const ColmapDepth depth = depth_of_colmap(model, "/nowhere");
  EXPECT_FALSE(depth.dense);
  const PosedDepthImage image = depth.source->read(1);
  int measured = 0;
  for (const float d : image.image.depth) {
    measured += d > 0;
    EXPECT_TRUE(d == 0 || (d > 4.9f && d < 10.1f)) << d;
  }
  EXPECT_GT(measured, 40);
}

class ColmapFolders : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("colmap_" + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    write("sparse/cameras.txt", kCameras);
    write("sparse/images.txt", kImages);
    write("sparse/points3D.txt", kPoints);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    write_file_atomically(folder_ / name, text);
  }
  std::string refusal() const {
    try {
      read_colmap_model(folder_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(ColmapFolders, AreReadAndChecked) {
  const ColmapModel model = read_colmap_model(folder_);
  EXPECT_EQ(model.images[0].name, "a.png");
  EXPECT_EQ(model.points[0].images, (std::vector<std::uint32_t>{2, 1}));
  write("sparse/points3D.txt", "7 1 2 8 10 20 30 0.5 2 0 9 0\n");
  EXPECT_NE(refusal().find("image 9 of the point 7 is missing"), std::string::npos) << refusal();
  write("sparse/points3D.txt", "");
  write("sparse/cameras.txt", "2 PINHOLE 64 48 60 61 32 24\n");
  EXPECT_NE(refusal().find("camera 1 of the image"), std::string::npos) << refusal();
  write("sparse/images.txt", "");
  EXPECT_NE(refusal().find("no image"), std::string::npos) << refusal();
  fs::remove_all(folder_ / "sparse");
  EXPECT_NE(refusal().find("holds no COLMAP model"), std::string::npos) << refusal();
}

// Depth maps of half the size, with a lens that distorts: the middle stays, the depths are read.
TEST_F(ColmapFolders, DenseDepthsAreUndistorted) {
  std::string bytes = "32&24&1&";
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) put(bytes, x == 0 ? 0.0f : 3.0f + static_cast<float>(x));
  write("stereo/depth_maps/b c.png.geometric.bin", bytes);
  const ColmapDepth depth = depth_of_colmap(read_colmap_model(folder_), folder_);
  ASSERT_TRUE(depth.dense);
  ASSERT_EQ(depth.source->size(), 1u);
  const PosedDepthImage image = depth.source->read(0);
  EXPECT_EQ(image.image.pinhole.width, 32);
  EXPECT_DOUBLE_EQ(image.image.pinhole.focal_x, 30);
  EXPECT_NEAR(static_cast<double>(image.image.at(16, 12)), 19, 1);
  write("stereo/depth_maps/b c.png.geometric.bin", bytes.substr(0, 900));
  EXPECT_THROW(depth_of_colmap(read_colmap_model(folder_), folder_), InputError);
}

TEST_F(ColmapFolders, FusedPointsAreRead) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty "
      "uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int k = 0; k < 2; ++k) {
    for (const float v : {1.f, 2.f, 3.f, 0.f, 0.f, 2.f}) put(ply, v);
    ply += "abc";
  }
  write("fused.ply", ply);
  const std::vector<FusedPoint> points = read_fused_points(folder_ / "fused.ply");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].position, Vector3d(1, 2, 3));
  EXPECT_EQ(points[1].normal, Vector3d::UnitZ());
  for (std::size_t size = 0; size < ply.size(); size += 7) {
    write("fused.ply", ply.substr(0, size));
    EXPECT_THROW(read_fused_points(folder_ / "fused.ply"), InputError) << size;
  }
}

// A photograph of a header alone, by the EXIF standard: little-endian TIFF with a GPS directory.
std::string photograph(char north, unsigned minutes, unsigned char below) {
  std::string tiff = "II*", gps;
  tiff += '\0';
  put<std::uint32_t>(tiff, 8);
  put<std::uint16_t>(tiff, 1);
  const auto entry = [](std::string& to, std::uint16_t tag, std::uint16_t type, std::uint32_t count,
                        std::uint32_t value) {
    put(to, tag), put(to, type), put(to, count), put(to, value);
  };
  entry(tiff, 0x8825, 4, 1, 26);
  put<std::uint32_t>(tiff, 0);
  put<std::uint16_t>(tiff, 6);
  const std::uint32_t data = 26 + 2 + 6 * 12 + 4;
  entry(tiff, 1, 2, 2, static_cast<std::uint32_t>(north));
  entry(tiff, 2, 5, 3, data);
  entry(tiff, 3, 2, 2, 'E');
  entry(tiff, 4, 5, 3, data + 24);
  entry(tiff, 5, 1, 1, below);
  entry(tiff, 6, 5, 1, data + 48);
  put<std::uint32_t>(tiff, 0);
  for (const unsigned v : {46u, 1u, minutes, 1u, 1200u, 100u, 6u, 1u, 0u, 1u, 0u, 1u, 4505u, 10u})
    put<std::uint32_t>(tiff, v);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const std::size_t length = body.size() + 2;
  return std::string("\xff\xd8\xff\xe1", 4) + static_cast<char>(length >> 8) +
         static_cast<char>(length & 255) + body + "\xff\xd9";
}

TEST_F(ColmapFolders, PositionsOfPhotographs) {
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  write("photos/a.JPG", photograph('N', 30, 0));
  write("photos/b.jpg", photograph('S', 30, 1));
  write("photos/c.jpg", "\xff\xd8\xff\xd9");
  std::size_t without = 0;
  const auto positions = exif_positions(folder_ / "photos", without);
  EXPECT_EQ(without, 1u);
  ASSERT_EQ(positions.size(), 2u);
  EXPECT_EQ(positions[0].name, "a.JPG");
  EXPECT_NEAR(positions[0].point.latitude_deg, 46.5 + 12 / 3600.0, 1e-12);
  EXPECT_NEAR(positions[0].point.longitude_deg, 6, 1e-12);
  EXPECT_NEAR(positions[0].point.altitude, 450.5, 1e-12);
  EXPECT_NEAR(positions[1].point.latitude_deg, -46.5 - 12 / 3600.0, 1e-12);
  EXPECT_NEAR(positions[1].point.altitude, -450.5, 1e-12);
  const std::string whole = photograph('N', 30, 0);
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    write("photos/c.jpg", whole.substr(0, size));
    exif_positions(folder_ / "photos", without);  // nothing, or what there is
  }
  write("photos/c.jpg", photograph('N', 6000, 0));
  EXPECT_THROW(exif_positions(folder_ / "photos", without), InputError);
  EXPECT_THROW(exif_positions(folder_ / "sparse", without), InputError);
}

}  // namespace
}  // namespace lapwing
