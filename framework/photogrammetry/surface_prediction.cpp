// SPDX-License-Identifier: Apache-2.0
// How: a point X with the camera coordinates (x, y, z) has the pixel (fx x / z, fy y / z). With its
// derivative J (2 x 3) by X and an error of s pixels both ways, images of known cameras have the
// information sum(J^T J) / s^2 about X, whose inverse is the covariance of the least-squares
// intersection (Hartley and Zisserman 2004, 5.2 and 12.6). The accuracy is the root of its largest
// eigenvalue. In the triangle's plane J is 2 x 2; its smaller singular value is the number of
// pixels a metre the longer way.
#include "framework/photogrammetry/surface_prediction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Jacobian = Eigen::Matrix<double, 2, 3>;

constexpr std::size_t kChunk = 256;  // triangles that a thread takes at once
constexpr double kBeside = 0.1;      // of a triangle's edge that rays end before its middle
// Of the largest eigenvalue of the information, below which rays count as parallel.
constexpr double kParallel = 1e-12;
constexpr double kLargestCube = 1e5;  // m, where images have no range
constexpr float kUnknown = std::numeric_limits<float>::infinity();

Vector3d middle_of(const TriangleMesh& mesh, std::size_t t) {
  return (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
}

// Of a pixel by the point, with the point in the camera's frame.
Jacobian derivative(const Pinhole& pinhole, const Vector3d& p, const Matrix3d& to_camera) {
  Jacobian by_camera;
  by_camera << pinhole.focal_x / p.z(), 0, -pinhole.focal_x * p.x() / (p.z() * p.z()),  //
      0, pinhole.focal_y / p.z(), -pinhole.focal_y * p.y() / (p.z() * p.z());
  return by_camera * to_camera;
}

// m that a pixel spans on a plane with that unit normal, the longer way.
double pixel_size(const Jacobian& j, const Vector3d& normal) {
  const Vector3d a = normal.unitOrthogonal(), b = normal.cross(a);
  const Eigen::Vector2d ja = j * a, jb = j * b;
  // The smaller singular value of (ja, jb), by trace and determinant of its square.
  const double half = 0.5 * (ja.squaredNorm() + jb.squaredNorm());
  const double area = std::abs(ja.x() * jb.y() - ja.y() * jb.x());
  const double largest = std::sqrt(half + std::sqrt(std::max(0.0, half * half - area * area)));
  return area > 0 ? largest / area : std::numeric_limits<double>::infinity();
}

double accuracy_of(const Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> parts(information, Eigen::EigenvaluesOnly);
  const double least = parts.eigenvalues()[0], most = parts.eigenvalues()[2];
  if (!(least > kParallel * most)) return std::numeric_limits<double>::infinity();
  return 1 / std::sqrt(least);
}

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// body(t) for all that is counted.
template <class Body>
void for_counted(std::span<const char> counted, int threads, const CancellationToken* cancellation,
                 Body body) {
  parallel_for((counted.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    if (cancellation && cancellation->cancelled()) return;
    const std::size_t end = std::min(counted.size(), (chunk + 1) * kChunk);
    for (std::size_t t = chunk * kChunk; t < end; ++t)
      if (counted[t]) body(t);
  });
  if (cancellation && cancellation->cancelled()) throw Cancelled();
}

// Sets that are joined by pairs.
class Joined {
 public:
  explicit Joined(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t root(std::size_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  // The earlier root stays one.
  void join(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

// One hole of the triangles that are listed.
SurfaceHole hole_of(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles,
                    HoleReason reason) {
  SurfaceHole hole;
  hole.reason = reason;
  Vector3d mean = Vector3d::Zero();
  for (const std::size_t t : triangles) {
    hole.area += mesh.area(t);
    mean += mesh.area(t) * middle_of(mesh, t);
  }
  mean /= hole.area > 0 ? hole.area : 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::size_t t : triangles) {
    const Vector3d middle = middle_of(mesh, t);
    if (!((middle - mean).squaredNorm() < nearest)) continue;
    nearest = (middle - mean).squaredNorm();
    hole.place = middle;
  }
  return hole;
}

}  // namespace

ImageSet::ImageSet(std::shared_ptr<const MeshScene> surface, std::vector<Pose> cameras,
                   const ImagingSettings& settings)
    : surface_(std::move(surface)), settings_(settings) {
  if (!surface_) throw Error("ImageSet: no surface");
  check_camera(settings_.pinhole, settings_.range);
  if (!(settings_.pixel_error > 0 && std::isfinite(settings_.pixel_error)))
    throw InputError("the error of a point in an image must be above 0 pixels");
  if (!(settings_.incidence > 0)) throw InputError("the usable angle of an image must be above 0");
  for (const Pose& camera : cameras) {
    const auto number = static_cast<std::uint32_t>(cameras_.size());
    cameras_.push_back({camera.position, camera.orientation.toRotationMatrix().transpose()});
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) near_[cell_of(camera.position, x, y, z)].push_back(number);
  }
}

std::uint64_t ImageSet::cell_of(const Vector3d& place, int x, int y, int z) const {
  const double edge = std::min(settings_.range, kLargestCube);
  const auto part = [&](double v, int offset) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v / edge)) + offset) &
           0x1fffff;
  };
  return part(place.x(), x) | part(place.y(), y) << 21 | part(place.z(), z) << 42;
}

std::span<const std::uint32_t> ImageSet::near(const Vector3d& place) const {
  const auto found = near_.find(cell_of(place, 0, 0, 0));
  if (found == near_.end()) return {};
  return found->second;
}

bool ImageSet::shows(std::size_t camera, std::size_t triangle) const {
  const TriangleMesh& mesh = surface_->mesh();
  const Camera& c = cameras_[camera];
  const Vector3d middle = middle_of(mesh, triangle), way = middle - c.position;
  const double distance = way.norm();
  if (!(distance > 0) || distance > settings_.range) return false;
  const Vector3d p = c.to_camera * way;
  if (!(p.z() > 0)) return false;
  const Pinhole& pinhole = settings_.pinhole;
  const double x = pinhole.principal_x + pinhole.focal_x * p.x() / p.z();
  const double y = pinhole.principal_y + pinhole.focal_y * p.y() / p.z();
  if (x < -0.5 || x >= pinhole.width - 0.5 || y < -0.5 || y >= pinhole.height - 0.5) return false;
  const Vector3d cross = mesh.cross(triangle);
  const double against = std::atan2(way.cross(cross).norm(), std::abs(way.dot(cross)));
  if (against > settings_.incidence || !(cross.squaredNorm() > 0)) return false;
  const double beside = kBeside * std::sqrt(cross.norm());
  return !surface_->blocked({c.position, way / distance, distance - beside});
}

bool ImageSet::locates(std::size_t triangle) const {
  const Vector3d middle = middle_of(surface_->mesh(), triangle);
  std::vector<Vector3d> rays;
  for (const std::uint32_t k : near(middle)) {
    if (!shows(k, triangle)) continue;
    const Vector3d way = middle - cameras_[k].position;
    for (const Vector3d& other : rays)
      if (static_cast<float>(angle_between(way, other)) >= kLeastParallax) return true;
    rays.push_back(way);
  }
  return false;
}

TrianglePrediction ImageSet::predict(std::size_t triangle) const {
  const TriangleMesh& mesh = surface_->mesh();
  const Vector3d middle = middle_of(mesh, triangle), normal = mesh.normal(triangle);
  TrianglePrediction told;
  told.accuracy = kUnknown;
  Matrix3d information = Matrix3d::Zero();
  std::vector<Vector3d> rays;
  for (const std::uint32_t k : near(middle)) {
    if (!shows(k, triangle)) continue;
    const Camera& c = cameras_[k];
    const Vector3d way = middle - c.position;
    const Jacobian j = derivative(settings_.pinhole, c.to_camera * way, c.to_camera);
    information += j.transpose() * j / (settings_.pixel_error * settings_.pixel_error);
    const auto against =
        static_cast<float>(std::atan2(way.cross(normal).norm(), std::abs(way.dot(normal))));
    const auto size = static_cast<float>(pixel_size(j, normal));
    told.incidence = told.images ? std::min(told.incidence, against) : against;
    told.pixel_size = told.images ? std::min(told.pixel_size, size) : size;
    for (const Vector3d& other : rays)
      told.parallax = std::max(told.parallax, static_cast<float>(angle_between(way, other)));
    rays.push_back(way);
    ++told.images;
  }
  if (told.images >= 2) told.accuracy = static_cast<float>(accuracy_of(information));
  return told;
}

std::vector<TrianglePrediction> predict_surface(const ImageSet& images,
                                                std::span<const char> counted, int threads,
                                                const CancellationToken* cancellation) {
  TrianglePrediction none;
  none.accuracy = kUnknown;
  std::vector<TrianglePrediction> told(counted.size(), none);
  for_counted(counted, threads, cancellation, [&](std::size_t t) { told[t] = images.predict(t); });
  return told;
}

double quantile_by_area(const TriangleMesh& mesh, std::span<const TrianglePrediction> predictions,
                        float TrianglePrediction::*value, double share) {
  std::vector<std::pair<float, double>> values;
  double total = 0;
  for (std::size_t t = 0; t < predictions.size(); ++t) {
    if (!predictions[t].located()) continue;
    values.emplace_back(predictions[t].*value, mesh.area(t));
    total += values.back().second;
  }
  std::sort(values.begin(), values.end());
  double passed = 0;
  for (const auto& [amount, area] : values) {
    passed += area;
    if (passed >= share * total * (1 - 1e-12)) return amount;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

const char* to_string(HoleReason reason) {
  switch (reason) {
    case HoleReason::not_chosen:
      return "not_chosen";
    case HoleReason::zone:
      return "zone";
    case HoleReason::no_view:
      break;
  }
  return "no_view";
}

std::vector<SurfaceHole> holes_of(const MeshScene& surface, std::span<const char> counted,
                                  std::span<const TrianglePrediction> predictions,
                                  const ImageSet& candidates, const ImageSet* with_forbidden,
                                  int threads, const CancellationToken* cancellation) {
  const TriangleMesh& mesh = surface.mesh();
  std::vector<char> missing(counted.size(), 0);
  std::vector<HoleReason> reasons(counted.size(), HoleReason::no_view);
  for (std::size_t t = 0; t < counted.size(); ++t)
    missing[t] = counted[t] && !predictions[t].located();
  for_counted(missing, threads, cancellation, [&](std::size_t t) {
    if (candidates.locates(t))
      reasons[t] = HoleReason::not_chosen;
    else if (with_forbidden && with_forbidden->locates(t))
      reasons[t] = HoleReason::zone;
  });
  // Vertices come once for each reason.
  constexpr std::size_t kReasons = 3;
  Joined joined(kReasons * mesh.vertices.size());
  const auto vertex = [&](std::size_t t, std::size_t corner) {
    return kReasons * static_cast<std::size_t>(mesh.triangles[t][corner]) +
           static_cast<std::size_t>(reasons[t]);
  };
  for (std::size_t t = 0; t < missing.size(); ++t)
    for (std::size_t corner = 1; missing[t] && corner < 3; ++corner)
      joined.join(vertex(t, 0), vertex(t, corner));
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> group_of(kReasons * mesh.vertices.size(), missing.size());
  for (std::size_t t = 0; t < missing.size(); ++t) {
    if (!missing[t]) continue;
    std::size_t& group = group_of[joined.root(vertex(t, 0))];
    if (group == missing.size()) {
      group = groups.size();
      groups.emplace_back();
    }
    groups[group].push_back(t);
  }
  std::vector<SurfaceHole> holes;
  for (const auto& group : groups) holes.push_back(hole_of(mesh, group, reasons[group.front()]));
  std::stable_sort(holes.begin(), holes.end(),
                   [](const SurfaceHole& a, const SurfaceHole& b) { return a.area > b.area; });
  return holes;
}

}  // namespace lapwing
