// SPDX-License-Identifier: Apache-2.0
// How: a pixel becomes a point of the camera frame, depth times ray. Its normal is the cross
// product of the differences to its horizontal and to its vertical neighbours. Pixels at depth
// edges and pixels seen at a flat angle are left out. Points are added up in a hash table of cubes,
// position and normal with the weight
//
//   cos(incidence) / (1 + distance^2)
//
// which prefers close and frontal measurements. An image counts once per cube. `points` sorts the
// cubes by index, so that the order of the hash table has no effect.
#include "framework/surface/point_fusion.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "framework/core/error.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// Points of an image, in the camera's frame.
class Measured {
 public:
  Measured(const DepthImage& image, const FusionOptions& options)
      : image_(image), options_(options) {}

  std::optional<Vector3d> point(int x, int y) const {
    const double depth = static_cast<double>(image_.at(x, y));
    if (!(depth > 0) || depth > options_.range) return std::nullopt;
    const Vector3d p = depth * pixel_ray(image_.pinhole, x, y);
    if (p.norm() > options_.reach) return std::nullopt;
    return p;
  }

  // Towards the camera; nothing at edges and where the surface is seen too flat.
  std::optional<Vector3d> normal(int x, int y, const Vector3d& p) const {
    const auto left = near(x - 1, y, p), right = near(x + 1, y, p);
    const auto up = near(x, y - 1, p), down = near(x, y + 1, p);
    if (!left || !right || !up || !down) return std::nullopt;
    Vector3d n = (*right - *left).cross(*up - *down);
    const double length = n.norm();
    if (!(length > 0)) return std::nullopt;
    n /= length;
    if (n.dot(p) > 0) n = -n;
    if (-n.dot(p) < std::cos(options_.incidence) * p.norm()) return std::nullopt;
    return n;
  }

 private:
  std::optional<Vector3d> near(int x, int y, const Vector3d& p) const {
    const auto q = point(x, y);
    if (!q || std::abs(q->z() - p.z()) > options_.discontinuity * p.z()) return std::nullopt;
    return q;
  }

  const DepthImage& image_;
  const FusionOptions& options_;
};

void check(const FusionOptions& o) {
  const auto require = [](bool holds, const char* why) {
    if (!holds) throw InputError(std::string("fusion of points: ") + why);
  };
  require(o.voxel > 0 && std::isfinite(o.voxel), "the voxel must be above 0 m");
  require(o.range > 0 && o.reach > 0, "the range must be above 0 m");
  require(o.incidence > 0 && o.incidence <= 1.5708,
          "the incidence must be above 0, at most 90 deg");
  require(o.discontinuity > 0, "the discontinuity must be above 0");
  require(o.stride >= 1, "the stride must be at least 1 pixel");
}

void check(const PosedDepthImage& measured) {
  const Pinhole& p = measured.image.pinhole;
  const std::size_t count = static_cast<std::size_t>(std::max(p.width, 0)) *
                            static_cast<std::size_t>(std::max(p.height, 0));
  if (measured.image.depth.size() != count || !(p.focal_x > 0 && p.focal_y > 0)) {
    throw InputError("a depth image of " + std::to_string(measured.image.depth.size()) +
                     " pixels for a camera of " + std::to_string(p.width) + " by " +
                     std::to_string(p.height));
  }
  const bool unit = std::abs(measured.camera.orientation.norm() - 1) < 1e-6;
  if (!measured.camera.position.allFinite() || !unit) {
    throw InputError("the pose of a depth image is not finite or its orientation no rotation");
  }
  for (const float depth : measured.image.depth) {
    if (std::isnan(depth) || depth < 0) {
      throw InputError("a depth image holds a depth that is negative or not a number");
    }
  }
}

}  // namespace

std::size_t PointFusion::KeyHash::operator()(const Key& key) const {
  std::uint64_t h = 0;
  for (const std::int32_t v : key) {
    h = (h ^ static_cast<std::uint32_t>(v)) * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 29;
  }
  return static_cast<std::size_t>(h);
}

PointFusion::PointFusion(const FusionOptions& options) : options_(options) {
  check(options);
}

void PointFusion::add(const PosedDepthImage& measured) {
  check(measured);
  const Measured image(measured.image, options_);
  const Eigen::Matrix3d to_world = measured.camera.orientation.toRotationMatrix();
  const Pinhole& p = measured.image.pinhole;
  for (int y = 1; y + 1 < p.height; y += options_.stride) {
    for (int x = 1; x + 1 < p.width; x += options_.stride) {
      const auto point = image.point(x, y);
      if (!point) continue;
      const auto normal = image.normal(x, y, *point);
      if (!normal) continue;
      const Vector3d p_W = measured.camera.position + to_world * *point;
      const Vector3d cell = (p_W / options_.voxel).array().floor();
      if (!(cell.cwiseAbs().maxCoeff() < 1e9)) {
        throw InputError("a depth image measures a place too far away to be fused");
      }
      Sum& sum = sums_[{static_cast<std::int32_t>(cell.x()), static_cast<std::int32_t>(cell.y()),
                        static_cast<std::int32_t>(cell.z())}];
      // What is seen from near and straight on is known best.
      const double weight = -normal->dot(*point) / point->norm() / (1 + point->squaredNorm());
      sum.position += weight * p_W;
      sum.normal += weight * (to_world * *normal);
      sum.weight += weight;
      if (sum.last != images_) ++sum.images;
      sum.last = images_;
    }
  }
  ++images_;
}

std::vector<FusedPoint> PointFusion::points(int images) const {
  std::vector<std::pair<Key, const Sum*>> ordered;
  for (const auto& [key, sum] : sums_) {
    if (sum.images >= images && sum.normal.norm() > 1e-9 * sum.weight) {
      ordered.emplace_back(key, &sum);
    }
  }
  std::sort(ordered.begin(), ordered.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<FusedPoint> points;
  for (const auto& [key, sum] : ordered) {
    points.push_back({sum->position / sum->weight, sum->normal.normalized(), sum->images});
  }
  return points;
}

}  // namespace lapwing
