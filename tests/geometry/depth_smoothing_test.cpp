// SPDX-License-Identifier: Apache-2.0
// Planes, edges and gaps whose true depth is known.
#include "framework/geometry/depth_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "framework/core/error.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr float kNothing = std::numeric_limits<float>::infinity();
constexpr DepthNoise kVeryHigh{.dropped = 0.4, .sigma = 1};

template <class Depth>
DepthImage image_of(Depth depth) {
  DepthImage image{{kWidth, kHeight, 80, 80, 79.5, 59.5}, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) image.depth.push_back(static_cast<float>(depth(x, y)));
  return image;
}

struct Errors {
  double mean = 0, deviation = 0, worst = 0;
};

// Of the pixels that were measured.
template <class Among>
Errors errors(const DepthImage& image, const DepthImage& truth, Among among) {
  double count = 0, sum = 0, squares = 0;
  Errors found;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (!among(x, y) || image.at(x, y) == 0) continue;
      const double error =
          static_cast<double>(image.at(x, y)) - static_cast<double>(truth.at(x, y));
      ++count;
      sum += error;
      squares += error * error;
      found.worst = std::max(found.worst, std::abs(error));
    }
  EXPECT_GT(count, 100);
  found.mean = sum / count;
  found.deviation = std::sqrt(squares / count - found.mean * found.mean);
  return found;
}

constexpr auto kInside = [](int x, int y) {
  return x >= 5 && y >= 5 && x < kWidth - 5 && y < kHeight - 5;
};

DepthImage measured(const DepthImage& truth, const DepthNoise& noise) {
  DepthImage image = truth;
  add_noise(image, noise, 7);
  return image;
}

TEST(DepthSmoothing, WindowsAreAsLargeAsTheNoiseAsks) {
  EXPECT_EQ(smoothing_reach(0.2, 0.2, 1), 0);
  EXPECT_EQ(smoothing_reach(0.1, 0.2, 1), 0);
  EXPECT_EQ(smoothing_reach(0.59, 0.2, 1), 1);  // 8.7 pixels of 9
  EXPECT_EQ(smoothing_reach(0.61, 0.2, 1), 2);  // 9.3
  EXPECT_EQ(smoothing_reach(1, 0.2, 0.6), 3);   // 41.7 of 49
  EXPECT_EQ(smoothing_reach(100, 0.2, 1), kMostSmoothingReach);
  EXPECT_EQ(smoothing_reach(1, 0, 1), 0);
  EXPECT_EQ(smoothing_reach(1, 0.2, 0), 0);
}

TEST(DepthSmoothing, SaysWhyItCannotBe) {
  EXPECT_EQ(why_not_smoothed(1, 0.2, 0.4), "");
  EXPECT_EQ(why_not_smoothed(1, 0.091, 0), "") << "1 / 11";
  EXPECT_EQ(why_not_smoothed(1, 0.09, 0),
            "the largest window, 11 x 11 pixels, reaches 0.0909 m; expected at least that");
  EXPECT_NE(why_not_smoothed(1, 0.1, 0.4), "") << "0.117 m, where 40 % are dropped";
  EXPECT_NE(why_not_smoothed(0.2, 0.2, 0), "");
  EXPECT_NE(why_not_smoothed(0, 0.2, 0), "");
}

TEST(DepthSmoothing, AWallAndASlopingPlaneAreFreeOfNoiseAndOfBias) {
  const DepthImage wall = image_of([](int, int) { return 12; });
  const DepthImage slope = image_of([](int x, int y) { return 10 + 0.08 * x + 0.05 * y; });
  for (const DepthImage& truth : {wall, slope}) {
    DepthImage image = measured(truth, kVeryHigh);
    EXPECT_NEAR(errors(image, truth, kInside).deviation, 1, 0.02);
    smooth_depth(image, kVeryHigh.sigma, 0.2, 1);
    const Errors left = errors(image, truth, kInside);
    EXPECT_LT(left.deviation, 0.25);
    EXPECT_LT(std::abs(left.mean), 0.02);
    const Errors outside =
        errors(image, truth, [](int x, int y) { return !kInside(x, y); });  // cut windows are moved
    EXPECT_LT(outside.deviation, 0.4);
  }
}

// Below a camera that looks ahead and 10 degrees down, up to the range: the rows are metres apart.
TEST(DepthSmoothing, GroundThatRunsAwayKeepsItsDepth) {
  for (const double height : {1, 2, 3}) {
    const DepthImage ground = image_of([height](int, int y) {
      const double down = (y - 59.5) / 80, pitch = 10 * std::numbers::pi / 180;
      const double fall = down * std::cos(pitch) + std::sin(pitch);
      const double depth = height / fall;
      return fall > 0 && depth < 20 ? depth : std::numeric_limits<double>::infinity();
    });
    for (const double sigma : {0.5, 1.0}) {
      DepthImage image = measured(ground, {.dropped = 0.4, .sigma = sigma});
      smooth_depth(image, sigma, 0.2, 1);
      for (const auto& [nearest, farthest] : {std::pair{2, 5}, {5, 10}, {10, 20}}) {
        const auto among = [&](int x, int y) {
          const auto depth = static_cast<double>(ground.at(x, y));
          return depth >= nearest && depth < farthest && y > 0;
        };
        const Errors left = errors(image, ground, among);
        EXPECT_LT(left.deviation, 0.4) << height << " m, sigma " << sigma << ", " << nearest;
        EXPECT_LT(std::abs(left.mean), 0.12) << height << " m, sigma " << sigma << ", " << nearest;
      }
    }
  }
}

TEST(DepthSmoothing, NothingIsInventedBetweenTwoSurfaces) {
  const DepthImage edge = image_of([](int x, int) { return x < 80 ? 6 : 14; });
  DepthImage image = measured(edge, kVeryHigh);
  smooth_depth(image, kVeryHigh.sigma, 0.2, 1);
  const Errors left =
      errors(image, edge, [](int x, int y) { return kInside(x, y) && x >= 76 && x < 84; });
  EXPECT_LT(left.deviation, 0.35);
  EXPECT_LT(left.worst, 3);  // the gap is 8 sigma wide
}

TEST(DepthSmoothing, AThinPoleStaysIfItIsFarFromTheWall) {
  const auto is_pole = [](int x, int y) { return x % 20 == 10 && kInside(x, y); };
  const DepthImage poles = image_of([](int x, int) { return x % 20 == 10 ? 6 : 12; });
  DepthImage image = measured(poles, kVeryHigh);
  smooth_depth(image, kVeryHigh.sigma, 0.2, 1);
  double count = 0, kept = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (is_pole(x, y) && image.at(x, y) > 0) {
        ++count;
        if (image.at(x, y) < 9) ++kept;
      }
  EXPECT_GT(count, 300);
  EXPECT_GT(kept / count, 0.95);
}

TEST(DepthSmoothing, GapsAndTheSkyStayAndSoDoesDepthThatIsGoodEnough) {
  const DepthImage truth = image_of([](int x, int y) { return y < 40 ? kNothing : 5 + 0.02 * x; });
  const DepthImage noisy = measured(truth, kVeryHigh);
  DepthImage image = noisy;
  smooth_depth(image, kVeryHigh.sigma, 0.2, 1);
  for (std::size_t i = 0; i < noisy.depth.size(); ++i) {
    EXPECT_EQ(noisy.depth[i] == 0, image.depth[i] == 0) << i;
    EXPECT_EQ(noisy.depth[i] == kNothing, image.depth[i] == kNothing) << i;
  }
  EXPECT_NE(image.depth, noisy.depth);
  for (const auto& [sigma, wanted] : {std::pair{0.2, 0.2}, {0.0, 0.2}, {1.0, 0.0}}) {
    DepthImage same = noisy;
    smooth_depth(same, sigma, wanted, 1);
    EXPECT_EQ(same.depth, noisy.depth);
  }
  DepthImage empty = image_of([](int, int) { return 0; });
  smooth_depth(empty, 1, 0.2, 1);
  EXPECT_EQ(empty.depth, std::vector<float>(kWidth * kHeight, 0.f));
}

TEST(DepthSmoothing, IsTheSameForAnyNumberOfThreads) {
  const DepthImage noisy = measured(image_of([](int x, int) { return 4 + 0.1 * x; }), kVeryHigh);
  DepthImage one = noisy, three = noisy;
  smooth_depth(one, 1, 0.2, 1);
  smooth_depth(three, 1, 0.2, 3);
  EXPECT_EQ(one.depth, three.depth);
}

TEST(DepthSmoothing, DeviationsMakeSense) {
  DepthImage image = image_of([](int, int) { return 5; });
  EXPECT_THROW(smooth_depth(image, -1, 0.2, 1), InputError);
  EXPECT_THROW(smooth_depth(image, 1, -0.2, 1), InputError);
  EXPECT_THROW(smooth_depth(image, std::nan(""), 0.2, 1), InputError);
}

}  // namespace
}  // namespace lapwing
