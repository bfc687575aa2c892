// SPDX-License-Identifier: Apache-2.0
#include "framework/picture/mesh_picture.h"

#include <cmath>

#include "framework/core/parallel.h"
#include "framework/picture/daylight.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kRays = 2;  // across a pixel and down

class MeshPainter {
 public:
  MeshPainter(const MeshScene& scene, const CameraView& view) : scene_(scene), view_(view) {
    for (const Rgb& c : scene.mesh().colors) {
      colors_.emplace_back(linear_light(c[0] / 255.0), linear_light(c[1] / 255.0),
                           linear_light(c[2] / 255.0));
    }
  }

  Light pixel(int x, int y) const {
    Light sum = Light::Zero();
    for (int k = 0; k < kRays * kRays; ++k) {
      const double dx = (k % kRays + 0.5) / kRays - 0.5, dy = (k / kRays + 0.5) / kRays - 0.5;
      // What saturates does so before the mean is taken, or bright outlines would be jagged.
      sum += light(x + dx, y + dy).min(1.0);
    }
    return sum / (kRays * kRays);
  }

 private:
  Light light(double x, double y) const {
    const Vector3d direction = view_.ray(x, y);
    const MeshHit hit = scene_.cast({view_.position, direction});
    if (hit.triangle < 0) return sky_light(direction);
    const Vector3d p = view_.position + hit.distance * direction;
    const Vector3d start = p + 1e-3 * hit.normal;
    const Vector3d& sun = towards_sun();
    const bool shadow = hit.normal.dot(sun) <= 0 || scene_.blocked({start, sun});
    const Light color =
        colors_.empty() ? Light(0.45, 0.45, 0.45) : colors_[static_cast<std::size_t>(hit.triangle)];
    return through_haze(color * daylight(hit.normal, shadow ? 0 : 1), hit.distance);
  }

  const MeshScene& scene_;
  const CameraView& view_;
  std::vector<Light> colors_;
};

}  // namespace

Picture mesh_picture(const MeshScene& scene, const CameraView& view, int threads) {
  const int width = view.pinhole.width, height = view.pinhole.height;
  check_picture_size(width, height);
  const MeshPainter painter(scene, view);
  Picture picture{width, height, {}};
  const auto row = static_cast<std::size_t>(width);
  picture.rgb.resize(3 * row * static_cast<std::size_t>(height));
  parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t y) {
    for (std::size_t x = 0; x < row; ++x) {
      const Light light = painter.pixel(static_cast<int>(x), static_cast<int>(y));
      for (int i = 0; i < 3; ++i) {
        picture.rgb[3 * (y * row + x) + static_cast<std::size_t>(i)] = encoded_light(light[i]);
      }
    }
  });
  return picture;
}

CameraView overview(const Eigen::AlignedBox3d& box, const Pinhole& pinhole, double yaw,
                    double pitch) {
  CameraView view;
  view.pinhole = pinhole;
  view.axes = camera_axes(yaw, pitch);
  // Back along the view until every corner lies inside the image, less a margin.
  const double across = 0.95 * pinhole.width / (2 * pinhole.focal_x);
  const double down = 0.95 * pinhole.height / (2 * pinhole.focal_y);
  double back = 0;
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner =
        box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)) - box.center();
    const Vector3d c = view.axes.in_camera(corner);
    back = std::max({back, std::abs(c.x()) / across - c.z(), std::abs(c.y()) / down - c.z()});
  }
  view.position = box.center() - back * view.axes.forward;
  return view;
}

}  // namespace lapwing
