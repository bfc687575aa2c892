// SPDX-License-Identifier: Apache-2.0
#include "framework/export/light_painting.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMargin = 0.15;               // of the drawing's size, around it
constexpr double kCore = 0.010, kHalo = 0.05;  // standard deviations of the light's image, of the
                                               // picture's shorter side
constexpr double kHaloShare = 0.1;             // of the core's peak
constexpr double kFullSpeed = 1.0;             // m/s, at which a stroke is as bright as white paper
constexpr double kColor[] = {1.0, 0.86, 0.62};
constexpr double kNight[] = {0.010, 0.013, 0.028};

bool lit_at(const Plan& plan, double time) {
  return std::any_of(plan.lights.begin(), plan.lights.end(), [time](const TimeSpan& light) {
    return light.start <= time && time <= light.finish;
  });
}

// Level axes across and up of a picture that is looked at along `view`.
struct Plane {
  Vector3d right, up;
  explicit Plane(const Vector3d& view) {
    const Vector3d forward = view.normalized();
    const bool steep = std::abs(forward.z()) > 0.999;
    right = (steep ? Vector3d::UnitX() : Vector3d(forward.cross(Vector3d::UnitZ()))).normalized();
    up = right.cross(forward);
  }
  Vector2d at(const Vector3d& p) const { return {right.dot(p), up.dot(p)}; }
};

struct Exposure {
  int width, height;
  std::vector<double> light;
  void add(const Vector2d& pixel, double sigma, double amount) {
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    const int x0 = static_cast<int>(std::floor(pixel.x())),
              y0 = static_cast<int>(std::floor(pixel.y()));
    for (int y = std::max(0, y0 - reach); y <= std::min(height - 1, y0 + reach); ++y)
      for (int x = std::max(0, x0 - reach); x <= std::min(width - 1, x0 + reach); ++x) {
        const double squared = (Vector2d(x + 0.5, y + 0.5) - pixel).squaredNorm();
        light[static_cast<std::size_t>(y) * width + x] +=
            amount * std::exp(-squared / (2 * sigma * sigma));
      }
  }
};

}  // namespace

DrawingError drawing_error(const Plan& plan, const FlownPath& flown) {
  DrawingError error;
  std::size_t count = 0;
  for (const FlownSample& sample : flown.samples) {
    if (!lit_at(plan, sample.time)) continue;
    const double distance = distance_to(plan.task.strokes, sample.state.position);
    error.mean += distance;
    error.worst = std::max(error.worst, distance);
    ++count;
  }
  if (count > 0) error.mean /= static_cast<double>(count);
  return error;
}

Picture long_exposure(const Plan& plan, const FlownPath& flown, int width) {
  const Plane plane(plan.task.drawing_view);
  Vector2d lower = Vector2d::Constant(1e300), upper = -lower;
  for (const Points& stroke : plan.task.strokes)
    for (const Vector3d& p : stroke) {
      lower = lower.cwiseMin(plane.at(p));
      upper = upper.cwiseMax(plane.at(p));
    }
  if (plan.task.strokes.empty()) lower = Vector2d::Zero(), upper = Vector2d::Ones();
  const double margin = kMargin * std::max(0.1, (upper - lower).maxCoeff());
  lower.array() -= margin;
  upper.array() += margin;
  const double scale = width / (upper.x() - lower.x());  // pixels per metre
  Exposure exposure{
      width, std::clamp(static_cast<int>(scale * (upper.y() - lower.y())), 1, 4 * width), {}};
  exposure.light.assign(static_cast<std::size_t>(width) * exposure.height, 0.0);
  const double shorter = std::min(exposure.width, exposure.height);
  const double core = std::max(0.7, kCore * shorter), halo = kHalo * shorter;
  const double apart = core / 2;  // pixels between two splats
  for (std::size_t i = 1; i < flown.samples.size(); ++i) {
    const FlownSample &a = flown.samples[i - 1], &b = flown.samples[i];
    if (!lit_at(plan, a.time) || !lit_at(plan, b.time)) continue;
    const Vector2d from = scale * (plane.at(a.state.position) - lower);
    const Vector2d to = scale * (plane.at(b.state.position) - lower);
    const int splats = std::max(1, static_cast<int>(std::ceil((to - from).norm() / apart)));
    // At kFullSpeed the splats of a straight stroke add up to 1 in its middle.
    const double amount =
        (b.time - a.time) * kFullSpeed * scale / splats / (core * std::sqrt(2 * EIGEN_PI));
    for (int k = 0; k < splats; ++k) {
      Vector2d at = from + (k + 0.5) / splats * (to - from);
      at.y() = exposure.height - at.y();
      exposure.add(at, core, amount);
      exposure.add(at, halo, kHaloShare * amount * core / halo);
    }
  }
  Picture picture{width, exposure.height, {}};
  picture.rgb.reserve(exposure.light.size() * 3);
  for (const double light : exposure.light)
    for (int c = 0; c < 3; ++c) {
      const double seen = 1 - std::exp(-(2.5 * kColor[c] * light + kNight[c]));
      picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * std::pow(seen, 1 / 2.2))));
    }
  return picture;
}

}  // namespace lapwing
