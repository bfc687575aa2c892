// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/image_overview.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = 0.017453292519943295;  // rad
constexpr double kOutside = 0.01;                 // share of the samples beyond the box, at a side
constexpr double kFar = 0.98;
constexpr std::size_t kMostNormals = 20000;  // that an estimate of up looks at
constexpr std::size_t kMostTried = 400;      // of them, as up
constexpr double kSearched = 30 * kDegree, kAgrees = 10 * kDegree;
constexpr double kLeastLevel = 0.05;  // share of the surface
constexpr double kDetermined = 0.02;  // least spread of the cameras' x axes
constexpr double kEdge = 0.1;         // of a depth: a larger step is an edge

struct Samples {
  std::vector<Vector3d> points, normals;
  std::vector<double> depths;
};

bool measured(float depth) {
  return depth > 0 && std::isfinite(depth);
}

Samples samples_of(const PosedDepthImage& measured_by, int stride) {
  Samples samples;
  const DepthImage& image = measured_by.image;
  const Pinhole& p = image.pinhole;
  const int apart = std::max(1, stride / 2);  // pixels to the neighbours of a normal
  const auto point = [&](int x, int y) {
    return Vector3d(static_cast<double>(image.at(x, y)) * pixel_ray(p, x, y));
  };
  for (int y = stride / 2; y < p.height; y += stride) {
    for (int x = stride / 2; x < p.width; x += stride) {
      if (!measured(image.at(x, y))) continue;
      const Vector3d here = point(x, y);
      samples.depths.push_back(here.z());
      samples.points.push_back(measured_by.camera.position + measured_by.camera.orientation * here);
      if (x + apart >= p.width || y + apart >= p.height) continue;
      const float right = image.at(x + apart, y), down = image.at(x, y + apart);
      const double step = kEdge * here.z();
      if (!measured(right) || !measured(down) ||
          std::abs(static_cast<double>(right) - here.z()) > step ||
          std::abs(static_cast<double>(down) - here.z()) > step) {
        continue;
      }
      Vector3d n = (point(x, y + apart) - here).cross(point(x + apart, y) - here).normalized();
      if (n.dot(here) > 0) n = -n;
      samples.normals.push_back(measured_by.camera.orientation * n);
    }
  }
  return samples;
}

std::vector<Samples> samples_of_all(const DepthSource& source, int stride, int threads,
                                    const CancellationToken* cancellation) {
  if (stride < 1) throw InputError("the stride of an overview must be at least 1 pixel");
  std::vector<Samples> all(source.size());
  parallel_for(source.size(), threads, [&](std::size_t i) {
    if (cancellation && cancellation->cancelled()) throw Cancelled();
    all[i] = samples_of(source.read(i), stride);
  });
  return all;
}

// The value of which so large a share is smaller; `values` are reordered.
double quantile(std::vector<double>& values, double share) {
  const auto place =
      static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

Vector3d up_of_cameras(const std::vector<Pose>& cameras) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3d upwards = Vector3d::Zero();
  for (const Pose& camera : cameras) {
    const Eigen::Matrix3d axes = camera.orientation.toRotationMatrix();
    const Vector3d x = axes.col(0);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) spread(i, k) += x[i] * x[k] / static_cast<double>(cameras.size());
    upwards -= axes.col(1) / static_cast<double>(cameras.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);  // values in rising order
  if (axes.eigenvalues()[1] < kDetermined) return upwards.normalized();
  const Vector3d normal = axes.eigenvectors().col(0);
  return normal.dot(upwards) < 0 ? Vector3d(-normal) : normal;
}

// The mean of the normals within an angle of a direction, and how many they are.
std::pair<Vector3d, std::size_t> mean_near(const std::vector<Vector3d>& normals, const Vector3d& up,
                                           double angle) {
  Vector3d sum = Vector3d::Zero();
  std::size_t count = 0;
  const double least = std::cos(angle);
  for (const Vector3d& n : normals) {
    if (n.dot(up) < least) continue;
    sum += n;
    ++count;
  }
  return {sum, count};
}

}  // namespace

ImageOverview overview_of(const DepthSource& source, int stride, int threads,
                          const CancellationToken* cancellation) {
  const std::vector<Samples> all = samples_of_all(source, stride, threads, cancellation);
  ImageOverview overview;
  overview.images = all.size();
  std::vector<double> depths, along[3];
  for (std::size_t i = 0; i < all.size(); ++i) {
    overview.cameras.extend(source.camera(i).position);
    overview.empty += all[i].points.empty();
    depths.insert(depths.end(), all[i].depths.begin(), all[i].depths.end());
    for (const Vector3d& p : all[i].points)
      for (int axis = 0; axis < 3; ++axis) along[axis].push_back(p[axis]);
  }
  if (depths.empty())
    throw InputError("none of the " + std::to_string(all.size()) +
                     " depth images has a measurement");
  overview.samples = static_cast<std::int64_t>(depths.size());
  overview.median_depth = quantile(depths, 0.5);
  overview.far_depth = quantile(depths, kFar);
  Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = quantile(along[axis], kOutside);
    high[axis] = quantile(along[axis], 1 - kOutside);
  }
  overview.surface = Eigen::AlignedBox3d(low, high);
  return overview;
}

UpEstimate estimate_up(const std::vector<Pose>& cameras, const std::vector<Vector3d>& normals) {
  if (cameras.empty()) throw InputError("which way is up cannot be told without a camera");
  UpEstimate estimate;
  estimate.cameras = cameras.size();
  estimate.up = up_of_cameras(cameras);
  std::vector<Vector3d> some;
  const std::size_t every = normals.size() / kMostNormals + 1;
  for (std::size_t k = 0; k < normals.size(); k += every) some.push_back(normals[k]);
  std::vector<Vector3d> near;
  for (const Vector3d& n : some)
    if (n.dot(estimate.up) > std::cos(kSearched)) near.push_back(n);
  if (near.empty()) return estimate;
  Vector3d best = estimate.up;
  std::size_t most = 0;
  const std::size_t try_every = near.size() / kMostTried + 1;
  for (std::size_t k = 0; k < near.size(); k += try_every) {
    const auto [sum, count] = mean_near(near, near[k], kAgrees / 2);
    if (count <= most) continue;
    most = count;
    best = sum.normalized();
  }
  for (int round = 0; round < 5; ++round) {
    const auto [sum, count] = mean_near(near, best, kAgrees / 2);
    if (count > 0) best = sum.normalized();
  }
  const double share =
      static_cast<double>(mean_near(some, best, kAgrees).second) / static_cast<double>(some.size());
  if (share < kLeastLevel) return estimate;
  estimate.up = best;
  estimate.level_share = share;
  return estimate;
}

UpEstimate estimate_up(const DepthSource& source, int stride, int threads,
                       const CancellationToken* cancellation) {
  const std::vector<Samples> all = samples_of_all(source, stride, threads, cancellation);
  std::vector<Pose> cameras;
  std::vector<Vector3d> normals;
  for (std::size_t i = 0; i < all.size(); ++i) {
    cameras.push_back(source.camera(i));
    normals.insert(normals.end(), all[i].normals.begin(), all[i].normals.end());
  }
  return estimate_up(cameras, normals);
}

}  // namespace lapwing
