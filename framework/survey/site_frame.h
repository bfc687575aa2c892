// SPDX-License-Identifier: Apache-2.0
// From the coordinates of a surveyor's data to the world frame and back.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>

#include <Eigen/Core>

#include "framework/survey/reference_system.h"

namespace lapwing {

// A function of places that is nearly linear over 100 m, computed at the corners of cubes and
// interpolated between them. Projections of the earth differ from that by less than 1 mm. Not
// thread-safe: corners are kept.
class LatticeFunction {
 public:
  using Function = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;
  // `steps`: edges of the cubes along x, y, z.
  LatticeFunction(Function function, const Eigen::Vector3d& steps);
  // Whatever the function throws passes.
  Eigen::Vector3d operator()(const Eigen::Vector3d& p);

 private:
  using Place = std::array<std::int64_t, 3>;
  struct PlaceHash {
    std::size_t operator()(const Place& place) const;
  };
  const Eigen::Vector3d& corner(const Place& place);

  Function function_;
  Eigen::Vector3d steps_;
  std::unordered_map<Place, Eigen::Vector3d, PlaceHash> corners_;
  std::optional<Place> cube_;
  std::array<Eigen::Vector3d, 8> of_cube_;
};

// Cheap to copy. Not thread-safe, copies neither.
class SiteFrame {
 public:
  // World = unit * (p - zero): data that are metres, or some other unit, of a frame of their own.
  SiteFrame(const Eigen::Vector3d& zero, double unit);
  // By the system. `origin` is the world's origin; its altitude and z of the data are above the
  // same surface, unless the system has a vertical part: then the altitude is above the ellipsoid.
  // `metres_per_height` is the unit of z of a system without a vertical part.
  SiteFrame(const ReferenceSystem& system, const GeodeticPoint& origin, double metres_per_height);

  // InputError as ReferenceSystem, for places outside of its area of use.
  Eigen::Vector3d to_world(const Eigen::Vector3d& p) const;
  Eigen::Vector3d from_world(const Eigen::Vector3d& p_W) const;
  // The same without interpolation.
  Eigen::Vector3d exactly_to_world(const Eigen::Vector3d& p) const;
  Eigen::Vector3d exactly_from_world(const Eigen::Vector3d& p_W) const;

 private:
  Eigen::Vector3d zero_ = Eigen::Vector3d::Zero();
  double unit_ = 1;
  std::shared_ptr<LatticeFunction> forth_, back_;  // of a system
  LatticeFunction::Function exactly_forth_, exactly_back_;
};

}  // namespace lapwing
