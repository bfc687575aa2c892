// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/depth_smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kRounds = 4;
constexpr double kFirstWithin = 3;      // sigma: one noisy pixel is all that is known
constexpr double kWithin = 2.5;         // sigma
constexpr double kLeastOfPlane = 6;     // pixels
constexpr double kMostVariance = 0.25;  // of a plane at its pixel, times sigma^2: that of 4 pixels
constexpr double kFits = 1.4;           // sigma^2 left for each pixel of a window that is one plane
constexpr double kLeastInverse = 1e-6;  // 1/m

bool is_measured(float depth) {
  return depth > 0 && std::isfinite(depth);
}

// The measured pixels of a window: columns and rows from its pixel, depth.
struct Window {
  static constexpr std::size_t kMost =
      (2 * kMostSmoothingReach + 1) * (2 * kMostSmoothingReach + 1);
  std::size_t count = 0;
  std::array<double, kMost> column, row, depth;
};

// At the border of the image the window is moved, so that it keeps its size.
void fill(Window& window, const DepthImage& image, int x, int y, int reach) {
  const auto first = [&](int at, int size) {
    return std::clamp(at - reach, 0, std::max(0, size - 2 * reach - 1));
  };
  const int left = first(x, image.pinhole.width), top = first(y, image.pinhole.height);
  const int right = std::min(image.pinhole.width - 1, left + 2 * reach);
  const int bottom = std::min(image.pinhole.height - 1, top + 2 * reach);
  window.count = 0;
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const float depth = image.at(u, v);
      if (!is_measured(depth)) continue;
      window.column[window.count] = u - x;
      window.row[window.count] = v - y;
      window.depth[window.count++] = static_cast<double>(depth);
    }
  }
}

// Sums of a least squares problem in three unknowns.
struct Sums {
  double n = 0;  // pixels
  double ww = 0, wc = 0, wr = 0, cc = 0, cr = 0, rr = 0, w = 0, c = 0, r = 0;

  // A pixel's `slope` times (1, column, row) times the unknowns is `value`.
  void add(double slope, double column, double row, double value) {
    const double sc = slope * column, sr = slope * row;
    ++n;
    ww += slope * slope;
    wc += slope * sc;
    wr += slope * sr;
    cc += sc * sc;
    cr += sc * sr;
    rr += sr * sr;
    w += slope * value;
    c += sc * value;
    r += sr * value;
  }
  Matrix3d inverse() const {
    Matrix3d normal;
    normal << ww, wc, wr, wc, cc, cr, wr, cr, rr;
    return normal.inverse();
  }
  Vector3d right() const { return {w, c, r}; }
};

// A plane: 1 / depth = plane . (1, column, row).
class Planes {
 public:
  Planes(const Window& window, double sigma) : window_(window), sigma_(sigma) {}

  Vector3d around(double own) const {
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < window_.count; ++k) {
      if (std::abs(window_.depth[k] - own) > kFirstWithin * sigma_) continue;
      sum += window_.depth[k];
      ++count;
    }
    return {count / sum, 0, 0};
  }

  // Of the whole window; a level one where it does not determine a plane.
  Vector3d through_all() const {
    Sums sums;
    double sum = 0;
    for (std::size_t k = 0; k < window_.count; ++k) {
      const double depth = window_.depth[k];
      sums.add(depth * depth, window_.column[k], window_.row[k], depth);
      sum += depth;
    }
    const Matrix3d inverse = sums.inverse();
    if (sums.n >= kLeastOfPlane && inverse.allFinite()) {
      const Vector3d plane = inverse * sums.right();
      if (plane.allFinite()) return plane;
    }
    return {sums.n / sum, 0, 0};
  }

  Vector3d refined(Vector3d plane) const {
    for (int round = 1; round < kRounds; ++round) {
      Sums sums;
      double sum = 0;
      for (std::size_t k = 0; k < window_.count; ++k) {
        const double expected = depth_of(plane, window_.column[k], window_.row[k]);
        const double error = window_.depth[k] - expected;
        if (!(std::abs(error) <= kWithin * sigma_)) continue;
        sums.add(-expected * expected, window_.column[k], window_.row[k], error);
        sum += window_.depth[k];
      }
      if (sums.n == 0) return plane;
      plane = step_from(plane, sums, sum);
    }
    return plane;
  }

  // Squared errors over sigma^2; one that is too large counts as the largest that is not.
  double unexplained(const Vector3d& plane) const {
    double sum = 0;
    for (std::size_t k = 0; k < window_.count; ++k) {
      const double error =
          (window_.depth[k] - depth_of(plane, window_.column[k], window_.row[k])) / sigma_;
      sum += std::abs(error) <= kWithin ? error * error : kWithin * kWithin;
    }
    return sum;
  }

 private:
  // Not a number behind the horizon of the plane.
  static double depth_of(const Vector3d& plane, double column, double row) {
    const double inverse = plane[0] + column * plane[1] + row * plane[2];
    return inverse > kLeastInverse ? 1 / inverse : std::nan("");
  }

  // With too few pixels, or all of them to one side, their mean.
  static Vector3d step_from(const Vector3d& plane, const Sums& sums, double sum) {
    const Vector3d level(sums.n / sum, 0, 0);
    if (sums.n < kLeastOfPlane) return level;
    const Matrix3d inverse = sums.inverse();
    const Vector3d next = plane + inverse * sums.right();
    const double depth = 1 / next[0];
    const double variance = inverse(0, 0) * depth * depth * depth * depth;
    return next.allFinite() && next[0] > kLeastInverse && variance < kMostVariance ? next : level;
  }

  const Window& window_;
  double sigma_;
};

double smoothed(const Window& window, double own, double sigma) {
  const Planes planes(window, sigma);
  const Vector3d whole = planes.refined(planes.through_all());
  const double depth = 1 / whole[0];
  if (depth > 0 && std::abs(depth - own) < kFirstWithin * sigma &&
      planes.unexplained(whole) < kFits * static_cast<double>(window.count))
    return depth;
  const double near = 1 / planes.refined(planes.around(own))[0];
  return near > 0 ? near : own;
}

}  // namespace

int smoothing_reach(double sigma, double wanted, double measured) {
  if (!(sigma > wanted) || !(wanted > 0) || !(measured > 0)) return 0;
  const double pixels = sigma * sigma / (wanted * wanted) / measured;
  int reach = 1;
  while (reach < kMostSmoothingReach && (2 * reach + 1) * (2 * reach + 1) < pixels) ++reach;
  return reach;
}

std::string why_not_smoothed(double sigma, double wanted, double dropped) {
  if (sigma == 0) return "there is no noise to smooth; expected sigma above 0 with it";
  if (wanted >= sigma)
    return "there is nothing to smooth; expected less than sigma, which is " + plain_number(sigma) +
           " m";
  constexpr int kWidest = 2 * kMostSmoothingReach + 1;
  const double least = sigma / (kWidest * std::sqrt(1 - dropped));
  if (wanted >= least) return "";
  return "the largest window, " + std::to_string(kWidest) + " x " + std::to_string(kWidest) +
         " pixels, reaches " + plain_number(least, 3) + " m; expected at least that";
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
