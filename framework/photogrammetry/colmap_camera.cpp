// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/colmap_camera.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;

constexpr int kRounds = 50;
constexpr double kExact = 1e-10;      // of a direction
constexpr double kDifference = 1e-6;  // of a direction, for derivatives

// In the order of their numbers in binary files.
constexpr const char* kModels[] = {"SIMPLE_PINHOLE",
                                   "PINHOLE",
                                   "SIMPLE_RADIAL",
                                   "RADIAL",
                                   "OPENCV",
                                   "OPENCV_FISHEYE",
                                   "FULL_OPENCV",
                                   "FOV",
                                   "SIMPLE_RADIAL_FISHEYE",
                                   "RADIAL_FISHEYE",
                                   "THIN_PRISM_FISHEYE"};

bool one_focal(const std::string& model) {
  return model == "SIMPLE_PINHOLE" || model == "SIMPLE_RADIAL" || model == "RADIAL";
}

// What the lens makes of a direction.
Vector2d distorted(const ColmapCamera& camera, const Vector2d& d) {
  const std::vector<double>& p = camera.parameters;
  const double r2 = d.squaredNorm();
  if (camera.model == "SIMPLE_RADIAL") return d * (1 + p[3] * r2);
  if (camera.model == "RADIAL") return d * (1 + p[3] * r2 + p[4] * r2 * r2);
  if (camera.model == "OPENCV") {
    const double radial = 1 + p[4] * r2 + p[5] * r2 * r2, xy = d.x() * d.y();
    return {d.x() * radial + 2 * p[6] * xy + p[7] * (r2 + 2 * d.x() * d.x()),
            d.y() * radial + 2 * p[7] * xy + p[6] * (r2 + 2 * d.y() * d.y())};
  }
  if (camera.model == "OPENCV_FISHEYE") {
    const double r = std::sqrt(r2);
    if (r < 1e-12) return d;
    const double a = std::atan(r), a2 = a * a;
    return d * (a * (1 + a2 * (p[4] + a2 * (p[5] + a2 * (p[6] + a2 * p[7])))) / r);
  }
  return d;
}

}  // namespace

Pinhole ColmapCamera::pinhole() const {
  const bool one = one_focal(model);
  return {width,
          height,
          parameters[0],
          parameters[one ? 0 : 1],
          parameters[one ? 1 : 2] - 0.5,
          parameters[one ? 2 : 3] - 0.5};
}

bool ColmapCamera::distorts() const {
  const std::size_t first = one_focal(model) ? 3 : 4;
  if (model == "OPENCV_FISHEYE") return true;
  return std::any_of(parameters.begin() + static_cast<std::ptrdiff_t>(first), parameters.end(),
                     [](double p) { return p != 0; });
}

Vector2d ColmapCamera::pixel(const Vector2d& direction) const {
  const Pinhole p = pinhole();
  const Vector2d d = distorted(*this, direction);
  return {p.focal_x * d.x() + p.principal_x + 0.5, p.focal_y * d.y() + p.principal_y + 0.5};
}

std::optional<Vector2d> ColmapCamera::direction(const Vector2d& pixel) const {
  const Pinhole p = pinhole();
  const Vector2d wanted((pixel.x() - 0.5 - p.principal_x) / p.focal_x,
                        (pixel.y() - 0.5 - p.principal_y) / p.focal_y);
  Vector2d d = wanted;
  for (int round = 0; round < kRounds; ++round) {
    const Vector2d miss = distorted(*this, d) - wanted;
    if (!miss.allFinite()) return std::nullopt;
    if (miss.norm() < kExact) return d;
    const Vector2d x(kDifference, 0), y(0, kDifference);
    const Vector2d dx = (distorted(*this, d + x) - distorted(*this, d - x)) / (2 * kDifference);
    const Vector2d dy = (distorted(*this, d + y) - distorted(*this, d - y)) / (2 * kDifference);
    const double determinant = dx.x() * dy.y() - dy.x() * dx.y();
    if (!(determinant > 1e-6)) return std::nullopt;  // the lens folds back
    d -= Vector2d(dy.y() * miss.x() - dy.x() * miss.y(), dx.x() * miss.y() - dx.y() * miss.x()) /
         determinant;
  }
  return std::nullopt;
}

std::size_t parameters_of_model(const std::string& model, const std::string& what) {
  constexpr std::size_t kCounts[] = {3, 4, 4, 5, 8, 8};
  for (std::size_t k = 0; k < std::size(kCounts); ++k)
    if (model == kModels[k]) return kCounts[k];
  throw InputError(
      what + ": the camera model " + model +
      " is not known here; SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV and "
      "OPENCV_FISHEYE are. `colmap image_undistorter` makes a model of PINHOLE cameras "
      "of any other");
}

std::string name_of_model(std::int64_t number) {
  if (number < 0 || number >= static_cast<std::int64_t>(std::size(kModels))) return "";
  return kModels[number];
}

void check_camera(const ColmapCamera& camera, const std::string& what) {
  const std::size_t count = parameters_of_model(camera.model, what);
  if (camera.parameters.size() != count)
    throw InputError(what + ": a " + camera.model + " camera has " + std::to_string(count) +
                     " parameters, not " + std::to_string(camera.parameters.size()));
  for (const double p : camera.parameters)
    if (!std::isfinite(p)) throw InputError(what + ": a parameter of the camera is not finite");
  const Pinhole p = camera.pinhole();
  if (p.width < 1 || p.height < 1 || p.width > 100'000 || p.height > 100'000)
    throw InputError(what + ": a camera of " + std::to_string(p.width) + " by " +
                     std::to_string(p.height) + " pixels");
  if (!(p.focal_x > 0 && p.focal_y > 0))
    throw InputError(what + ": the focal lengths of the camera must be above 0 pixels");
}

}  // namespace lapwing
