// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/camera_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapwing {
namespace {

constexpr int kRimPoints = 32;
constexpr double kNearest = 1e-6;  // m in front; nearer has no meaningful pixel

}  // namespace

Pinhole centered_pinhole(int width, int height, double across) {
  const double focal = width / 2.0 / std::tan(across / 2);
  return {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
}

Pinhole Pinhole::fitted(int most_across, int most_down) const {
  const double scale =
      std::min(static_cast<double>(most_across) / width, static_cast<double>(most_down) / height);
  const auto pixels = [scale](int count) {
    return std::max(1, static_cast<int>(std::lround(count * scale)));
  };
  Pinhole scaled;
  scaled.width = pixels(width);
  scaled.height = pixels(height);
  // Whole pixels stretch the image a little; its edges show the same as before.
  const double across = static_cast<double>(scaled.width) / width;
  const double down = static_cast<double>(scaled.height) / height;
  scaled.focal_x = focal_x * across;
  scaled.focal_y = focal_y * down;
  // Centres of pixels lie half a pixel from the image's edge at every size.
  scaled.principal_x = (principal_x + 0.5) * across - 0.5;
  scaled.principal_y = (principal_y + 0.5) * down - 0.5;
  return scaled;
}

std::optional<Eigen::Vector2d> CameraView::project(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d p = axes.in_camera(p_W - position);
  if (!(p.z() > kNearest)) return std::nullopt;
  return Eigen::Vector2d(pinhole.principal_x + pinhole.focal_x * p.x() / p.z(),
                         pinhole.principal_y + pinhole.focal_y * p.y() / p.z());
}

bool CameraView::sees(const Eigen::Vector3d& p_W) const {
  const auto pixel = project(p_W);
  return pixel && pixel->x() >= -0.5 && pixel->x() < pinhole.width - 0.5 && pixel->y() >= -0.5 &&
         pixel->y() < pinhole.height - 0.5;
}

Eigen::Vector3d CameraView::ray(double x, double y) const {
  const double right = (x - pinhole.principal_x) / pinhole.focal_x;
  const double down = (y - pinhole.principal_y) / pinhole.focal_y;
  return (axes.forward + right * axes.right + down * axes.down).normalized();
}

std::optional<ImageBox> CameraView::box_of(const Eigen::Vector3d& middle, double height,
                                           double width) const {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  ImageBox box{kInfinite, kInfinite, -kInfinite, -kInfinite};
  const int around = width > 0 ? kRimPoints : 1;
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * std::numbers::pi * i / around;
    const Eigen::Vector3d rim(width / 2 * std::cos(angle), width / 2 * std::sin(angle), 0);
    for (const double up : {-height / 2, height / 2}) {
      const auto pixel = project(middle + rim + Eigen::Vector3d(0, 0, up));
      if (!pixel) return std::nullopt;
      box.left = std::min(box.left, pixel->x());
      box.right = std::max(box.right, pixel->x());
      box.top = std::min(box.top, pixel->y());
      box.bottom = std::max(box.bottom, pixel->y());
    }
  }
  return box;
}

}  // namespace lapwing
