// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/depth_camera.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr float kNothing = std::numeric_limits<float>::infinity();

struct Pixel {
  std::size_t place;
  double depth;
  const MeshHit& hit;
};

template <class See>
void for_every_pixel(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                     double range, int threads, See see) {
  const Eigen::Matrix3d to_world = camera.orientation.toRotationMatrix();
  const auto row = [&](std::size_t y) {
    for (int x = 0; x < pinhole.width; ++x) {
      const Vector3d ray = pixel_ray(pinhole, x, static_cast<double>(y));
      const double length = ray.norm();
      const MeshHit hit = scene.cast({camera.position, to_world * (ray / length), range * length});
      const double depth = hit.distance / length;
      see(Pixel{y * static_cast<std::size_t>(pinhole.width) + static_cast<std::size_t>(x), depth,
                hit});
    }
  };
  parallel_for(static_cast<std::size_t>(pinhole.height), threads, row);
}

}  // namespace

void check_camera(const Pinhole& pinhole, double range) {
  if (pinhole.width < 1 || pinhole.height < 1 ||
      static_cast<double>(pinhole.width) * pinhole.height > 1e8) {
    throw InputError("a depth image of " + std::to_string(pinhole.width) + " by " +
                     std::to_string(pinhole.height) +
                     " pixels: expected at least one and at most 100 million");
  }
  if (!(pinhole.focal_x > 0 && pinhole.focal_y > 0)) {
    throw InputError("a depth camera needs focal lengths above 0 pixels");
  }
  if (!(range > 0)) throw InputError("the range of a depth camera must be above 0 m");
}

Vector3d pixel_ray(const Pinhole& pinhole, double x, double y) {
  return {(x - pinhole.principal_x) / pinhole.focal_x, (y - pinhole.principal_y) / pinhole.focal_y,
          1};
}

std::vector<Vector3d> tiled_pixel_rays(const Pinhole& pinhole) {
  constexpr int kTile = 8;
  std::vector<Vector3d> rays;
  rays.reserve(static_cast<std::size_t>(pinhole.width) * static_cast<std::size_t>(pinhole.height));
  for (int top = 0; top < pinhole.height; top += kTile)
    for (int left = 0; left < pinhole.width; left += kTile)
      for (int y = top; y < std::min(top + kTile, pinhole.height); ++y)
        for (int x = left; x < std::min(left + kTile, pinhole.width); ++x)
          rays.push_back(pixel_ray(pinhole, x, y).normalized());
  return rays;
}

Pose camera_pose(const Vector3d& position, double yaw, double pitch) {
  const CameraAxes<double> axes = camera_axes(yaw, pitch);
  Eigen::Matrix3d to_world;
  to_world << axes.right, axes.down, axes.forward;
  return {position, Eigen::Quaterniond(to_world).normalized()};
}

DepthImage render_depth(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                        double range, int threads) {
  check_camera(pinhole, range);
  DepthImage image{pinhole, {}};
  image.depth.assign(
      static_cast<std::size_t>(pinhole.width) * static_cast<std::size_t>(pinhole.height), kNothing);
  for_every_pixel(scene, camera, pinhole, range, threads, [&](const Pixel& pixel) {
    if (pixel.depth <= range) image.depth[pixel.place] = static_cast<float>(pixel.depth);
  });
  return image;
}

MeshView render_view(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                     double range, int threads) {
  check_camera(pinhole, range);
  MeshView view;
  view.depth.pinhole = pinhole;
  const std::size_t count =
      static_cast<std::size_t>(pinhole.width) * static_cast<std::size_t>(pinhole.height);
  view.depth.depth.assign(count, kNothing);
  view.triangles.assign(count, -1);
  view.normals.assign(count, Eigen::Vector3f::Zero());
  for_every_pixel(scene, camera, pinhole, range, threads, [&](const Pixel& pixel) {
    if (!(pixel.depth <= range)) return;
    view.depth.depth[pixel.place] = static_cast<float>(pixel.depth);
    view.triangles[pixel.place] = pixel.hit.triangle;
    view.normals[pixel.place] = pixel.hit.normal.cast<float>();
  });
  return view;
}

void add_noise(DepthImage& image, const DepthNoise& noise, std::uint64_t seed) {
  if (!(noise.dropped >= 0 && noise.dropped <= 1)) {
    throw InputError("the share of dropped pixels must be between 0 and 1");
  }
  if (!(noise.sigma >= 0 && std::isfinite(noise.sigma))) {
    throw InputError("the sigma of depth noise must be at least 0 m");
  }
  const Random source(seed);
  const auto width = static_cast<std::size_t>(image.pinhole.width);
  for (std::size_t row = 0; row * width < image.depth.size(); ++row) {
    Random random = source.split(row);
    for (std::size_t x = 0; x < width; ++x) {
      float& depth = image.depth[row * width + x];
      const bool dropped = random.uniform() < noise.dropped;
      const double error = noise.sigma * random.normal();
      if (dropped) depth = 0;
      if (!(depth > 0) || !std::isfinite(depth)) continue;
      const double moved = static_cast<double>(depth) + error;
      depth = moved > 0 ? static_cast<float>(moved) : 0;
    }
  }
}

}  // namespace lapwing
