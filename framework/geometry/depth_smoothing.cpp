// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/depth_smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "framework/core/error.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kRounds = 4;
constexpr double kFirstWithin = 3;      // sigma: the first plane is one noisy pixel
constexpr double kWithin = 2.5;         // sigma
constexpr double kLeastOfPlane = 6;     // pixels
constexpr double kMostVariance = 0.25;  // of a plane at its pixel, times sigma^2: that of 4 pixels
constexpr double kSettled = 0.01;       // sigma

bool is_measured(float depth) {
  return depth > 0 && std::isfinite(depth);
}

// The measured pixels of a window: columns and rows from its middle, depth.
struct Window {
  static constexpr std::size_t kMost =
      (2 * kMostSmoothingReach + 1) * (2 * kMostSmoothingReach + 1);
  std::size_t count = 0;
  std::array<double, kMost> column, row, depth;
};

void fill(Window& window, const DepthImage& image, int x, int y, int reach) {
  const int bottom = std::min(image.pinhole.height - 1, y + reach);
  const int right = std::min(image.pinhole.width - 1, x + reach);
  window.count = 0;
  for (int v = std::max(0, y - reach); v <= bottom; ++v) {
    for (int u = std::max(0, x - reach); u <= right; ++u) {
      const float depth = image.at(u, v);
      if (!is_measured(depth)) continue;
      window.column[window.count] = u - x;
      window.row[window.count] = v - y;
      window.depth[window.count++] = static_cast<double>(depth);
    }
  }
}

// Depth = plane (1, column, row), by least squares over the pixels within `most` of `before`.
Vector3d fitted_plane(const Window& window, const Vector3d& before, double most, bool tilted) {
  double n = 0, c = 0, r = 0, cc = 0, cr = 0, rr = 0, d = 0, cd = 0, rd = 0;
  for (std::size_t k = 0; k < window.count; ++k) {
    const double column = window.column[k], row = window.row[k], depth = window.depth[k];
    const double expected = before[0] + column * before[1] + row * before[2];
    const double weight = std::abs(depth - expected) <= most ? 1 : 0;
    const double wc = weight * column, wr = weight * row;
    n += weight;
    c += wc;
    r += wr;
    cc += wc * column;
    cr += wc * row;
    rr += wr * row;
    d += weight * depth;
    cd += wc * depth;
    rd += wr * depth;
  }
  if (n == 0) return before;
  if (tilted && n >= kLeastOfPlane) {
    Matrix3d normal;
    normal << n, c, r, c, cc, cr, r, cr, rr;
    const Matrix3d inverse = normal.inverse();
    if (inverse.allFinite() && inverse(0, 0) < kMostVariance) return inverse * Vector3d(d, cd, rd);
  }
  return {d / n, 0, 0};
}

double smoothed(const Window& window, double own, double sigma) {
  Vector3d plane = fitted_plane(window, {own, 0, 0}, kFirstWithin * sigma, false);
  for (int round = 1; round < kRounds; ++round) {
    const Vector3d before = plane;
    plane = fitted_plane(window, before, kWithin * sigma, true);
    if (std::abs(plane[0] - before[0]) < kSettled * sigma && round > 1) break;
  }
  return plane[0] > 0 ? plane[0] : own;
}

}  // namespace

int smoothing_reach(double sigma, double wanted, double measured) {
  if (!(sigma > wanted) || !(wanted > 0) || !(measured > 0)) return 0;
  const double pixels = sigma * sigma / (wanted * wanted) / measured;
  int reach = 1;
  while (reach < kMostSmoothingReach && (2 * reach + 1) * (2 * reach + 1) < pixels) ++reach;
  return reach;
}

void smooth_depth(DepthImage& image, double sigma, double wanted, int threads) {
  if (!(sigma >= 0 && std::isfinite(sigma)) || !(wanted >= 0 && std::isfinite(wanted)))
    throw InputError("standard deviations of depth must be at least 0 m");
  double measured = 0, dropped = 0;
  for (const float depth : image.depth) {
    if (is_measured(depth)) ++measured;
    if (depth == 0) ++dropped;
  }
  const int reach = smoothing_reach(sigma, wanted, measured / std::max(1.0, measured + dropped));
  if (reach == 0) return;
  const DepthImage noisy = image;
  const auto width = static_cast<std::size_t>(image.pinhole.width);
  parallel_for(static_cast<std::size_t>(image.pinhole.height), threads, [&](std::size_t y) {
    Window window;
    for (std::size_t x = 0; x < width; ++x) {
      float& depth = image.depth[y * width + x];
      if (!is_measured(depth)) continue;
      fill(window, noisy, static_cast<int>(x), static_cast<int>(y), reach);
      depth = static_cast<float>(smoothed(window, static_cast<double>(depth), sigma));
    }
  });
}

}  // namespace lapwing
