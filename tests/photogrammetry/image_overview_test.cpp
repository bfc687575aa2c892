// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/image_overview.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// Images of a level plane at z = 0, from 4 m above it, one to each side.
class OverAPlane final : public DepthSource {
 public:
  explicit OverAPlane(double pitch) : pitch_(pitch) {}
  std::size_t size() const override { return 4; }
  std::string name(std::size_t image) const override { return std::to_string(image); }
  Pose camera(std::size_t image) const override {
    return camera_pose({static_cast<double>(image), 0, 4}, 1.3 * static_cast<double>(image),
                       pitch_);
  }
  Pinhole pinhole(std::size_t) const override { return {64, 48, 60, 60, 31.5, 23.5}; }
  PosedDepthImage read(std::size_t image) const override {
    PosedDepthImage made{camera(image), {pinhole(image), {}}};
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const Vector3d ray = made.camera.orientation * pixel_ray(made.image.pinhole, x, y);
        const double depth = ray.z() < -0.2 ? -4 / ray.z() : 0;
        made.image.depth.push_back(static_cast<float>(depth));
      }
    return made;
  }

 private:
  double pitch_;
};

TEST(ImageOverviews, MeasureWhatThereIs) {
  const OverAPlane source(-1.2);
  const ImageOverview overview = overview_of(source, 2, 1);
  EXPECT_EQ(overview.images, 4u);
  EXPECT_EQ(overview.empty, 0u);
  EXPECT_NEAR(overview.surface.min().z(), 0, 1e-5);
  EXPECT_NEAR(overview.surface.max().z(), 0, 1e-5);
  EXPECT_GT(overview.surface.sizes().x(), 4);
  EXPECT_NEAR(overview.median_depth, 4 / std::sin(1.2), 0.2);
  EXPECT_GT(overview.far_depth, overview.median_depth);
  EXPECT_EQ(overview.cameras.sizes(), Vector3d(3, 0, 0));
  EXPECT_EQ(overview_of(source, 2, 2).surface.min(), overview.surface.min());
}

TEST(ImageOverviews, NothingMeasuredIsAnError) {
  EXPECT_THROW(overview_of(OverAPlane(1.2), 2, 1), InputError);
}

// In a world that is turned at random, up is found from cameras and ground to a degree.
TEST(ImageOverviews, UpIsFoundInATurnedWorld) {
  Random random(5);
  for (int k = 0; k < 10; ++k) {
    Similarity turn;
    turn.rotation =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
            .normalized();
    const auto turned = placed(std::make_shared<OverAPlane>(-0.7), turn);
    const UpEstimate found = estimate_up(*turned, 4, 1);
    EXPECT_GT(found.up.dot(turn.rotation * Vector3d::UnitZ()), std::cos(0.0175));
    EXPECT_GT(found.level_share, 0.9);
  }
}

// All cameras look the same way: their level axes are one, and the ground decides.
TEST(ImageOverviews, UpFromCamerasThatLookTheSameWay) {
  std::vector<Pose> cameras(3, camera_pose({0, 0, 4}, 0.5, -0.4));
  const UpEstimate alone = estimate_up(cameras, {});
  EXPECT_EQ(alone.level_share, 0);
  EXPECT_NEAR(std::acos(alone.up.z()), 0.4, 1e-6);
  const UpEstimate with_ground = estimate_up(cameras, std::vector<Vector3d>(40, Vector3d::UnitZ()));
  EXPECT_NEAR(with_ground.up.z(), 1, 1e-9);
  EXPECT_THROW(estimate_up({}, {}), InputError);
}

TEST(PlacedDepth, ScalesDepthsAndMovesCameras) {
  const auto source = std::make_shared<OverAPlane>(-1.2);
  Similarity to_world{2, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitX())), {1, 2, 3}};
  const auto moved = placed(source, to_world);
  const PosedDepthImage before = source->read(1), after = moved->read(1);
  const auto point = [](const PosedDepthImage& image) {
    return Vector3d(image.camera.position +
                    image.camera.orientation * (static_cast<double>(image.image.at(30, 20)) *
                                                pixel_ray(image.image.pinhole, 30, 20)));
  };
  EXPECT_LT((to_world.apply(point(before)) - point(after)).norm(), 1e-5);
  EXPECT_LT((to_world.inverse(to_world.apply(point(before))) - point(before)).norm(), 1e-12);
}

TEST(RealDepthOverview, IsARoomOfAFewMetres) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  const auto source = depth_of_folder(DepthFolder(std::filesystem::path(data) / "depth"));
  const ImageOverview overview = overview_of(*source, 16, 2);
  EXPECT_EQ(overview.images, 50u);
  EXPECT_GT(overview.median_depth, 1);
  EXPECT_LT(overview.median_depth, 4);
  EXPECT_LT(overview.surface.sizes().maxCoeff(), 8);
  // The first axes of these poses: y of the cameras points down.
  EXPECT_LT(estimate_up(*source, 16, 2).up.y(), -0.7);
}

}  // namespace
}  // namespace lapwing
