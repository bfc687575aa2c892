// SPDX-License-Identifier: Apache-2.0
// What COLMAP's files say, read back and held against the camera model.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/export/exporter.h"
#include "framework/geometry/depth_camera.h"
#include "framework/plugin/registry.h"

namespace lapwing {
namespace {

std::unique_ptr<Exporter> colmap() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry.create<Exporter>("colmap");
}

Plan scan_plan(int views) {
  Plan plan;
  plan.kind = "scan";
  ScanTask& scan = plan.task.scan.emplace();
  scan.camera = {600, 450, 345, 340, 299.5, 224.25};
  Random random(3);
  for (int i = 0; i < views; ++i) {
    PlannedView view;
    view.time = i;
    view.position = {random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(2, 40)};
    view.yaw = random.uniform(-4, 4);
    view.pitch = i == 0 ? -1.5707963267948966 : random.uniform(-1.5, 0.2);
    scan.views.push_back(view);
  }
  return plan;
}

std::string file(const NamedContents& files, const std::string& name) {
  for (const auto& [known, contents] : files)
    if (known == name) return contents;
  return "missing";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (!line.starts_with('#')) lines.push_back(line);
  return lines;
}

// As COLMAP projects: R from the quaternion by its textbook formula, no camera of ours.
Eigen::Vector2d projected(const std::string& camera, const std::string& image,
                          const Eigen::Vector3d& p) {
  std::istringstream words(image);
  double id, w, x, y, z, tx, ty, tz;
  words >> id >> w >> x >> y >> z >> tx >> ty >> tz;
  Eigen::Matrix3d rotation;
  rotation << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y),
      2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  EXPECT_NEAR(w * w + x * x + y * y + z * z, 1, 1e-12);
  EXPECT_GE(w, 0);
  const Eigen::Vector3d c = rotation * p + Eigen::Vector3d(tx, ty, tz);
  std::istringstream numbers(camera);
  std::string model;
  double number, width, height, fx, fy, cx, cy;
  numbers >> number >> model >> width >> height >> fx >> fy >> cx >> cy;
  EXPECT_EQ(model, "PINHOLE");
  if (c.z() <= 0) return {-1e9, -1e9};
  return {fx * c.x() / c.z() + cx, fy * c.y() / c.z() + cy};
}

// 120 x 90 is a camera to plan quickly with; nothing can be made of its images.
TEST(ColmapExporter, SaysThatImagesAreTooSmallAndWhichOptionsMendIt) {
  Plan plan = scan_plan(3);
  EXPECT_TRUE(colmap()->remarks(plan).empty());
  plan.task.scan->camera = {120, 90, 69, 69, 59.5, 44.5};
  const std::vector<std::string> remarks = colmap()->remarks(plan);
  ASSERT_EQ(remarks.size(), 1u);
  for (const char* said : {"120 x 90", "camera.width", "camera.height", "camera.focal"})
    EXPECT_NE(remarks[0].find(said), std::string::npos) << remarks[0];
  plan.task.scan.reset();
  EXPECT_TRUE(colmap()->remarks(plan).empty());
}

TEST(ColmapExporter, PointsFallWhereTheCameraModelPutsThem) {
  const Plan plan = scan_plan(8);
  const NamedContents files = colmap()->write_folder(plan);
  const auto cameras = lines_of(file(files, "cameras.txt"));
  const auto images = lines_of(file(files, "images.txt"));
  ASSERT_EQ(cameras.size(), 1u);
  ASSERT_EQ(images.size(), 16u);
  Random random(4);
  int seen = 0;
  for (int i = 0; i < 8; ++i) {
    const PlannedView& view = plan.task.scan->views[i];
    EXPECT_EQ(images[2 * i + 1], "");
    const Pose pose = camera_pose(view.position, view.yaw, view.pitch);
    const Pinhole& pinhole = plan.task.scan->camera;
    for (int k = 0; k < 20; ++k) {
      const double x = random.uniform(0, 600), y = random.uniform(0, 450);
      const Eigen::Vector3d p =
          view.position + random.uniform(1, 30) * (pose.orientation * pixel_ray(pinhole, x, y));
      const Eigen::Vector2d pixel = projected(cameras[0], images[2 * i], p);
      // From the corner of the upper left pixel, not from its centre.
      EXPECT_NEAR(pixel.x(), x + 0.5, 1e-6);
      EXPECT_NEAR(pixel.y(), y + 0.5, 1e-6);
      ++seen;
    }
  }
  EXPECT_EQ(seen, 160);
}

TEST(ColmapExporter, NamesImagesInTheirOrder) {
  const auto images = lines_of(file(colmap()->write_folder(scan_plan(12)), "images.txt"));
  EXPECT_TRUE(images[0].starts_with("1 "));
  EXPECT_TRUE(images[0].ends_with(" 1 view_0001.png"));
  EXPECT_TRUE(images[22].ends_with(" 1 view_0012.png"));
}

TEST(ColmapExporter, OnlyAScanHasImages) {
  Plan film;
  film.kind = "film";
  EXPECT_THROW(colmap()->write_folder(film), InputError);
  EXPECT_EQ(lines_of(file(colmap()->write_folder(scan_plan(0)), "points3D.txt")).size(), 0u);
}

}  // namespace
}  // namespace lapwing
