// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "framework/core/error.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/picture/daylight.h"
#include "framework/picture/mesh_picture.h"

namespace lapwing {
namespace {

constexpr Rgb kBlue{20, 40, 220};

MeshScene blue_tower() {
  MeshBuilder builder;
  builder.set_color(kBlue);
  builder.box({-1, -1, 0}, {1, 1, 6});
  builder.set_color({200, 200, 200});
  builder.quad({-40, -40, 0}, {40, -40, 0}, {40, 40, 0}, {-40, 40, 0});
  return MeshScene(builder.take());
}

CameraView looking_down(double height) {
  return {centered_pinhole(120, 90, 1.0), {0, 0, height}, camera_axes(0.0, -std::numbers::pi / 2)};
}

std::array<int, 3> color_at(const Picture& picture, const Eigen::Vector2d& place) {
  const auto x = static_cast<int>(std::lround(place.x()));
  const auto y = static_cast<int>(std::lround(place.y()));
  const auto at = 3 * static_cast<std::size_t>(y * picture.width + x);
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

TEST(MeshPicture, TrianglesHaveTheirColoursWhereTheCameraSeesThem) {
  const MeshScene scene = blue_tower();
  const CameraView view = looking_down(30);
  const Picture picture = mesh_picture(scene, view, 1);
  const auto roof = color_at(picture, *view.project({0, 0, 6}));
  EXPECT_GT(roof[2], 2 * roof[0]);
  const auto ground = color_at(picture, *view.project({-5, -5, 0}));
  EXPECT_NEAR(ground[0], ground[1], 25);
  // What Lambert's law and the haze give of a level grey surface in full sun.
  const Light expected =
      through_haze(linear_light(200 / 255.0) * daylight(Eigen::Vector3d::UnitZ(), 1),
                   (view.position - Eigen::Vector3d(-5, -5, 0)).norm());
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(ground[i], encoded_light(expected[i]), 1);
}

TEST(MeshPicture, ShadowsFallAwayFromTheSun) {
  const CameraView view = looking_down(30);
  const Picture picture = mesh_picture(blue_tower(), view, 1);
  Eigen::Vector3d across = towards_sun();
  across.z() = 0;
  // The shadow of the tower's middle, and the place opposite.
  const Eigen::Vector3d behind = -across / towards_sun().z() * 4;
  const auto dark = color_at(picture, *view.project(behind));
  const auto bright = color_at(picture, *view.project(-behind));
  EXPECT_LT(dark[0], 0.75 * bright[0]);
}

TEST(MeshPicture, WithoutASurfaceThereIsSky) {
  const CameraView view{centered_pinhole(40, 30, 1.0), {0, 0, 30}, camera_axes(0.0, 1.2)};
  const Picture picture = mesh_picture(blue_tower(), view, 1);
  const auto seen = color_at(picture, {19.5, 14.5});
  const Light sky = sky_light(view.axes.forward);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(seen[i], encoded_light(sky[i]), 3);
}

TEST(MeshPicture, IsTheSameForAnyNumberOfThreads) {
  const MeshScene scene = blue_tower();
  const CameraView view = overview({Eigen::Vector3d(-4, -4, 0), Eigen::Vector3d(4, 4, 6)},
                                   centered_pinhole(90, 61, 1.2), 1, -0.4);
  const Picture one = mesh_picture(scene, view, 1), three = mesh_picture(scene, view, 3);
  EXPECT_EQ(one.rgb.size(), 3u * 90 * 61);
  EXPECT_EQ(one.rgb, three.rgb);
}

TEST(MeshPicture, RefusesPicturesWithoutAPixelAndTooLargeOnes) {
  const MeshScene scene = blue_tower();
  CameraView view = looking_down(30);
  view.pinhole.height = 0;
  EXPECT_THROW(mesh_picture(scene, view, 1), InputError);
  view.pinhole.width = view.pinhole.height = 20'000;
  EXPECT_THROW(mesh_picture(scene, view, 1), InputError);
}

TEST(Overview, HasTheWholeBoxInViewAndNoMoreRoomThanItsMargin) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-3, 1, 0), Eigen::Vector3d(9, 5, 14));
  for (const double yaw : {0.0, 0.7, 2.5, -1.9}) {
    for (const double pitch : {-1.4, -0.5, 0.0}) {
      const CameraView view = overview(box, centered_pinhole(640, 360, 1.1), yaw, pitch);
      double widest = 0;  // share of the half image that a corner reaches
      for (int k = 0; k < 8; ++k) {
        const auto corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
        ASSERT_TRUE(view.sees(corner)) << yaw << " " << pitch;
        const Eigen::Vector2d at = *view.project(corner);
        widest = std::max({widest, std::abs(at.x() - view.pinhole.principal_x) / 320,
                           std::abs(at.y() - view.pinhole.principal_y) / 180});
      }
      EXPECT_NEAR(widest, 0.95, 1e-6) << yaw << " " << pitch;
      EXPECT_TRUE(view.sees(box.center()));
    }
  }
}

TEST(Daylight, EncodingIsTheInverseOfLinearLight) {
  for (int byte = 0; byte <= 255; ++byte)
    EXPECT_NEAR(encoded_light(linear_light(byte / 255.0)), byte, byte < 40 ? 2 : 1) << byte;
  EXPECT_EQ(encoded_light(-1), 0);
  EXPECT_EQ(encoded_light(7), 255);
}

TEST(Daylight, HazeHidesWhatIsFar) {
  const Light near = through_haze(Light(1, 0, 0), 0), far = through_haze(Light(1, 0, 0), 1e5);
  EXPECT_LT((near - Light(1, 0, 0)).abs().maxCoeff(), 1e-12);
  EXPECT_LT((far - sky_light(Eigen::Vector3d::UnitX())).abs().maxCoeff(), 1e-12);
  // Along the way e to the power of distance over kHaze, as Beer and Lambert have it.
  const Light half = through_haze(Light(1, 0, 0), kHaze * std::log(2));
  EXPECT_LT((half - (near + far) / 2).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace lapwing
