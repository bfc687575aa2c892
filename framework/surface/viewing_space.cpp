// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/viewing_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;

constexpr int kSideDirections = 256;
constexpr double kBesideSurface = 1e-3;  // m from the surface, where lines begin
constexpr double kMostCubes = 268435456.0;

// Unit vectors, evenly over the cap around +z.
std::vector<Vector3d> cap_directions(double opening) {
  std::vector<Vector3d> all;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const double least = std::cos(opening);
  for (int k = 0; k < kSideDirections; ++k) {
    const double z = 1 - (1 - least) * (k + 0.5) / kSideDirections;
    const double across = std::sqrt(1 - z * z);
    all.emplace_back(across * std::cos(golden * k), across * std::sin(golden * k), z);
  }
  return all;
}

}  // namespace

ViewingSpace::ViewingSpace(std::shared_ptr<const MeshScene> scene, const ViewingSettings& settings,
                           std::span<const Vector3d> from, int threads)
    : scene_(std::move(scene)),
      settings_(settings),
      directions_(cap_directions(settings.incidence)) {
  if (settings_.room.isEmpty()) throw InputError("viewing space: the room is empty");
  if (!(settings_.step > 0 && settings_.range > 0 && settings_.incidence > 0))
    throw InputError("viewing space: step, range and incidence must be above 0");
  const Vector3d cubes = settings_.room.sizes() / settings_.step;
  if (!(cubes.array() + 1).allFinite() || !((cubes.array() + 1).prod() < kMostCubes))
    throw InputError("viewing space: the room has more than 2^28 cubes");
  count_ = cubes.array().floor().cast<int>() + 1;
  find_free(threads);
  keep_joined(from);
}

std::size_t ViewingSpace::place(const Array3i& at) const {
  return (static_cast<std::size_t>(at.z()) * count_.y() + at.y()) * count_.x() + at.x();
}

Array3i ViewingSpace::cube_of(const Vector3d& p) const {
  return ((p - settings_.room.min()) / settings_.step).array().floor().cast<int>();
}

bool ViewingSpace::inside(const Array3i& at) const {
  return (at >= 0).all() && (at < count_).all();
}

void ViewingSpace::find_free(int threads) {
  free_.assign(static_cast<std::size_t>(count_.x()) * count_.y() * count_.z(), 0);
  parallel_for(static_cast<std::size_t>(count_.z()), threads, [&](std::size_t z) {
    for (int y = 0; y < count_.y(); ++y) {
      for (int x = 0; x < count_.x(); ++x) {
        const Array3i at(x, y, static_cast<int>(z));
        const Vector3d middle =
            settings_.room.min() + settings_.step * (at.cast<double>() + 0.5).matrix();
        free_[place(at)] = !scene_->box_blocked(middle, middle, settings_.body);
      }
    }
  });
}

// What is free but out of reach is no place to see from.
void ViewingSpace::keep_joined(std::span<const Vector3d> from) {
  std::vector<Array3i> front;
  std::vector<char> joined(free_.size(), 0);
  const auto take = [&](const Array3i& at) {
    if (!inside(at) || !free_[place(at)] || joined[place(at)]) return;
    joined[place(at)] = 1;
    front.push_back(at);
  };
  for (const Vector3d& p : from) take(cube_of(p));
  if (front.empty())
    throw InputError("viewing space: none of the places that it begins from is free");
  while (!front.empty()) {
    const Array3i at = front.back();
    front.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
      for (const int way : {-1, 1}) {
        Array3i beside = at;
        beside[axis] += way;
        take(beside);
      }
    }
  }
  free_ = std::move(joined);
}

bool ViewingSpace::meets_free(const Vector3d& from, const Vector3d& direction) const {
  const MeshHit hit = scene_->cast({from, direction, settings_.range});
  const double end = std::min(hit.distance, settings_.range);
  for (double along = settings_.step / 2; along < end; along += settings_.step / 2) {
    const Array3i at = cube_of(from + along * direction);
    if (inside(at) && free_[place(at)]) return true;
  }
  return false;
}

bool ViewingSpace::sees(const Vector3d& point, const Vector3d& normal) const {
  const Vector3d beside = std::abs(normal.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
  const Vector3d u = normal.cross(beside).normalized(), v = normal.cross(u);
  for (const double side : {1.0, -1.0}) {
    const Vector3d from = point + side * kBesideSurface * normal;
    for (const Vector3d& d : directions_) {
      if (meets_free(from, d.x() * u + d.y() * v + side * d.z() * normal)) return true;
    }
  }
  return false;
}

double ViewingSpace::free_volume() const {
  const double cube = std::pow(settings_.step, 3);
  return cube * static_cast<double>(std::count(free_.begin(), free_.end(), 1));
}

}  // namespace lapwing
