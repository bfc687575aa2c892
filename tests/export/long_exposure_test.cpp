// SPDX-License-Identifier: Apache-2.0
// The photograph of a light painting: where a stroke lies in it, from which side it is seen, and
// how bright it is; and how far a flight strayed from what it was to draw.
#include <gtest/gtest.h>

#include "framework/export/light_painting.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// A stroke along x, 2 m up, and one upright at its left end.
Plan corner() {
  Plan plan;
  plan.task.strokes = {{{0, 0, 2}, {4, 0, 2}}, {{0, 0, 2}, {0, 0, 5}}};
  plan.task.drawing_view = {0, 1, 0};
  plan.lights = {{0, 4}, {10, 13}};
  return plan;
}

// Flown exactly, at `speed`, moved aside by `off`.
FlownPath flight(const Vector3d& off = Vector3d::Zero(), double speed = 1, double from = 0) {
  FlownPath flown;
  const auto add = [&](double time, const Vector3d& p) {
    FlownSample sample;
    sample.time = time;
    sample.state.position = p + off;
    flown.samples.push_back(sample);
  };
  for (int i = 0; i <= 80; ++i) add(from + 0.05 * i / speed, {0.05 * i, 0, 2});
  for (int i = 0; i <= 60; ++i) add(from + 10 + 0.05 * i / speed, {0, 0, 2 + 0.05 * i});
  return flown;
}

int brightness(const Picture& picture, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * picture.width + x);
  return picture.rgb[at] + picture.rgb[at + 1] + picture.rgb[at + 2];
}

TEST(DrawingError, IsTheDistanceFromTheStrokesWhileTheLightIsOn) {
  const Plan plan = corner();
  EXPECT_NEAR(drawing_error(plan, flight()).worst, 0, 1e-12);
  const DrawingError aside = drawing_error(plan, flight({0, 0.3, 0}));
  EXPECT_NEAR(aside.mean, 0.3, 1e-12);
  EXPECT_NEAR(aside.worst, 0.3, 1e-12);
  // A mean over time, and the worst of one moment.
  FlownPath once = flight();
  once.samples[40].state.position.y() = 1.41;
  EXPECT_NEAR(drawing_error(plan, once).worst, 1.41, 1e-12);
  EXPECT_NEAR(drawing_error(plan, once).mean, 1.41 / 142, 1e-12);
  // In the dark nothing is drawn, whatever is flown.
  Plan dark = plan;
  dark.lights.clear();
  EXPECT_EQ(drawing_error(dark, flight({9, 9, 9})).worst, 0);
  EXPECT_EQ(drawing_error(dark, flight({9, 9, 9})).mean, 0);
  EXPECT_EQ(drawing_error(plan, {}).mean, 0);
}

TEST(LongExposure, StrokesLieWhereTheyAreSeen) {
  const Picture north = long_exposure(corner(), flight(), 184);
  // 4 m across and 3 up, with 0.6 m around: 5.2 x 4.2 m.
  ASSERT_EQ(north.width, 184);
  EXPECT_NEAR(north.height, 184 * 4.2 / 5.2, 1);
  const double scale = 184 / 5.2;
  const auto at = [&](const Picture& picture, double x, double z) {
    return brightness(picture, static_cast<int>((x + 0.6) * scale),
                      static_cast<int>(picture.height - (z - 1.4) * scale));
  };
  const int night = brightness(north, 1, 1);
  for (const auto& [x, z] : {std::pair{1.0, 2.0}, {3.5, 2.0}, {0.0, 3.0}, {0.0, 4.5}})
    EXPECT_GT(at(north, x, z), 4 * night) << x << " " << z;
  for (const auto& [x, z] : {std::pair{2.0, 3.5}, {3.9, 4.5}})
    EXPECT_LT(at(north, x, z), 2 * night) << x << " " << z;
  // From behind left and right are exchanged, and nothing else.
  Plan behind = corner();
  behind.task.drawing_view = {0, -1, 0};
  const Picture south = long_exposure(behind, flight(), 184);
  ASSERT_EQ(south.height, north.height);
  int worst = 0;
  for (int y = 0; y < north.height; ++y)
    for (int x = 0; x < 184; ++x)
      worst = std::max(worst, std::abs(brightness(north, x, y) - brightness(south, 183 - x, y)));
  EXPECT_LE(worst, 3);
}

// Light adds up: half the speed is twice the light, and two flights are as one of half the speed.
TEST(LongExposure, SlowIsBright) {
  Plan plan = corner();
  const auto middle = [&](const FlownPath& flown, double speed) {
    plan.lights = {{0, 4 / speed + 1e-6}, {30, 30 + 4 / speed + 1e-6}};  // the stroke along x
    const Picture picture = long_exposure(plan, flown, 184);
    return brightness(picture, 92, static_cast<int>(picture.height - 0.6 * 184 / 5.2));
  };
  const int slow = middle(flight(Vector3d::Zero(), 2), 2),
            plain = middle(flight(Vector3d::Zero(), 4), 4),
            fast = middle(flight(Vector3d::Zero(), 16), 16);
  EXPECT_GT(slow, plain + 20);
  EXPECT_GT(plain, fast + 50);
  FlownPath twice = flight(Vector3d::Zero(), 4);
  const FlownPath again = flight(Vector3d::Zero(), 4, 30);
  twice.samples.insert(twice.samples.end(), again.samples.begin(), again.samples.end());
  EXPECT_NEAR(middle(twice, 4), slow, 6);
}

TEST(LongExposure, InTheDarkThereIsNight) {
  Plan plan = corner();
  plan.lights.clear();
  const Picture night = long_exposure(plan, flight(), 60);
  for (int y = 0; y < night.height; ++y)
    for (int x = 0; x < 60; ++x) ASSERT_EQ(brightness(night, x, y), brightness(night, 0, 0));
  EXPECT_LT(brightness(night, 0, 0), 150);
}

TEST(LongExposure, DegenerateDrawingsHaveAPicture) {
  for (const std::vector<Points>& strokes : {std::vector<Points>{},
                                             {{{1, 2, 3}}},
                                             {{{0, 0, 0}, {0, 0, 9}}},
                                             {{{0, 0, 0}, {1e-9, 0, 0}}}})
    for (const Vector3d& view : {Vector3d(0, 1, 0), Vector3d(0, 0, -1), Vector3d(1, 1, 0.2)}) {
      Plan plan = corner();
      plan.task.strokes = strokes;
      plan.task.drawing_view = view;
      const Picture picture = long_exposure(plan, flight(), 40);
      EXPECT_EQ(picture.width, 40);
      EXPECT_GE(picture.height, 1);
      EXPECT_LE(picture.height, 160);
      EXPECT_EQ(picture.rgb.size(), 3u * 40 * static_cast<unsigned>(picture.height));
    }
  EXPECT_EQ(long_exposure(corner(), flight(), 50).rgb, long_exposure(corner(), flight(), 50).rgb);
}

}  // namespace
}  // namespace lapwing
