// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "framework/core/error.h"
#include "framework/picture/render.h"

namespace lapwing {
namespace {

constexpr Color kGrass{0.6, 0.6, 0.55}, kRed{0.85, 0.1, 0.08}, kGlass{0.2, 0.4, 0.8};

CameraView view_from(const Eigen::Vector3d& position, double yaw, double pitch, int width = 320) {
  const Pinhole pinhole{1920, 1080, 900, 900, 959.5, 539.5};
  return {pinhole.fitted(width, width), position, camera_axes(yaw, pitch)};
}

struct Pixel {
  int red, green, blue;
  bool reddish() const { return red > 1.8 * green && red > 1.8 * blue; }
  int sum() const { return red + green + blue; }
};

Pixel pixel(const Picture& picture, int x, int y) {
  const auto at = 3 * static_cast<std::size_t>(y * picture.width + x);
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

ImageBox red_box(const Picture& picture) {
  ImageBox box{1e9, 1e9, -1e9, -1e9};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (!pixel(picture, x, y).reddish()) continue;
      box = {std::min<double>(box.left, x), std::min<double>(box.top, y),
             std::max<double>(box.right, x), std::max<double>(box.bottom, y)};
    }
  }
  return box;
}

TEST(Render, SubjectIsWhereTheProjectionSays) {
  const Eigen::Vector3d middle(0, 0, 2);
  const Renderer renderer({{GroundShape{0}, kGrass}, {UprightCylinderShape{middle, 4, 3}, kRed}});
  for (const auto& [position, yaw, pitch] :
       std::vector<std::tuple<Eigen::Vector3d, double, double>>{{{-14, 0, 2}, 0.0, 0.0},
                                                                {{-12, 3, 6}, -0.4, -0.3},
                                                                {{10, 9, 12}, -2.5, -0.6},
                                                                {{1, -16, 5}, 1.5, 0.1}}) {
    const CameraView view = view_from(position, yaw, pitch);
    const auto expected = view.box_of(middle, 4, 3);
    ASSERT_TRUE(expected && view.sees(middle));
    const ImageBox seen = red_box(renderer.picture(view));
    EXPECT_NEAR(seen.left, expected->left, 1.5);
    EXPECT_NEAR(seen.right, expected->right, 1.5);
    EXPECT_NEAR(seen.top, expected->top, 1.5);
    EXPECT_NEAR(seen.bottom, expected->bottom, 1.5);
    const Picture picture = renderer.picture(view);
    const Eigen::Vector2d centre = *view.project(middle);
    EXPECT_TRUE(pixel(picture, static_cast<int>(std::lround(centre.x())),
                      static_cast<int>(std::lround(centre.y())))
                    .reddish());
  }
}

TEST(Render, HorizonDividesSkyAndGround) {
  const Renderer renderer({{GroundShape{0}, kGrass}});
  for (const double pitch : {-0.2, 0.0, 0.2}) {
    const CameraView view = view_from({0, 0, 5}, 1, pitch);
    const Picture picture = renderer.picture(view);
    const int horizon =
        static_cast<int>(view.pinhole.principal_y + view.pinhole.focal_y * std::tan(pitch));
    const Pixel above = pixel(picture, 100, horizon / 3), below = pixel(picture, 100, 175);
    EXPECT_GT(above.blue, above.red + 20) << pitch;  // blue sky
    EXPECT_LT(below.blue, below.red) << pitch;       // brownish ground
  }
}

TEST(Render, GroundIsCheckeredNearbyAndEvenFarAway) {
  const Renderer renderer({{GroundShape{0}, kGrass}});
  const auto spread = [&](double height) {
    const Picture picture = renderer.picture(view_from({3.3, 4.4, height}, 0, -1.57));
    int low = 1000, high = 0;
    for (int y = 60; y < 120; ++y) {
      for (int x = 100; x < 220; ++x) {
        low = std::min(low, pixel(picture, x, y).sum());
        high = std::max(high, pixel(picture, x, y).sum());
      }
    }
    return high - low;
  };
  EXPECT_GT(spread(5), 30);
  EXPECT_LT(spread(20000), 6) << "squares smaller than pixels must not flicker";
}

TEST(Render, BodiesCastShadows) {
  const Body ground{GroundShape{0}, kGrass};
  const CameraView view = view_from({0, 0, 30}, 0, -std::numbers::pi / 2);
  const Picture empty = Renderer({ground}).picture(view);
  const Picture full =
      Renderer({ground, {UprightCylinderShape{{0, 0, 2}, 4, 1}, kRed}}).picture(view);
  int darker = 0;
  for (std::size_t i = 0; i < full.rgb.size(); i += 3) {
    const bool red = full.rgb[i] > 1.8 * full.rgb[i + 1];
    darker += !red && full.rgb[i] < 0.8 * empty.rgb[i] ? 1 : 0;
  }
  EXPECT_GT(darker, 30);
  // The sun stands in the south-west, so the shadow falls to the north-east.
  const auto shade = view.project({0.9, 1.2, 0});
  const int x = static_cast<int>(std::lround(shade->x())),
            y = static_cast<int>(std::lround(shade->y()));
  EXPECT_LT(pixel(full, x, y).sum(), 0.8 * pixel(empty, x, y).sum());
}

TEST(Render, SeeThroughBodiesTintWhatIsBehindThem) {
  const Body ground{GroundShape{0}, kGrass}, subject{UprightCylinderShape{{0, 0, 2}, 4, 3}, kRed};
  const CameraView view = view_from({-14, 0, 2}, 0, 0);
  const Picture bare = Renderer({ground, subject}).picture(view);
  const Picture veiled =
      Renderer({ground, subject, {BallShape{{0, 0, 2}, 5}, kGlass, true}}).picture(view);
  const Picture hidden =
      Renderer({ground, subject, {BallShape{{0, 0, 2}, 5}, kGlass, false}}).picture(view);
  EXPECT_GT(pixel(veiled, 160, 90).red, 1.2 * pixel(veiled, 160, 90).blue);
  EXPECT_NE(pixel(veiled, 160, 90).sum(), pixel(bare, 160, 90).sum());
  EXPECT_GT(pixel(hidden, 160, 90).blue, pixel(hidden, 160, 90).red);
}

TEST(Render, SameInputSameBytes) {
  const std::vector<Body> bodies{{GroundShape{0}, kGrass},
                                 {UprightCylinderShape{{0, 0, 2}, 4, 3}, kRed},
                                 {BoardShape{{2, 3, 1}, {1, 0, 0}, {0, 0, 1}}, kGlass},
                                 {BlockShape{{-3, 2, 0}, {-1, 4, 3}}, kGlass, true}};
  const CameraView view = view_from({-12, 3, 6}, -0.4, -0.3);
  const Picture first = Renderer(bodies).picture(view), second = Renderer(bodies).picture(view);
  EXPECT_EQ(first.width, 320);
  EXPECT_EQ(first.height, 180);
  EXPECT_EQ(first.rgb.size(), 3u * 320 * 180);
  EXPECT_EQ(first.rgb, second.rgb);
}

TEST(Render, RefusesPicturesWithoutAPixel) {
  CameraView view = view_from({0, 0, 5}, 0, 0);
  view.pinhole.width = 0;
  EXPECT_THROW(Renderer({}).picture(view), InputError);
  view.pinhole.width = view.pinhole.height = 20000;
  EXPECT_THROW(Renderer({}).picture(view), InputError);
}

}  // namespace
}  // namespace lapwing
