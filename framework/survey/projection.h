// SPDX-License-Identifier: Apache-2.0
// What PROJ knows of a reference system. Internal to this room.
//
// PROJ and the forty libraries that it needs are in a library of their own beside liblapwing, which
// is opened when the first system is asked for.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "framework/core/error.h"

namespace lapwing {

struct ProjectedSystem {
  std::string name, unit;
  std::string across;  // the system without its vertical part as WKT, of one that has both
  bool geographic = false, vertical = false;
  double metres_per_unit = 0, metres_per_height = 1;
  double west = -180, south = -90, east = 180, north = 90;  // degrees, the area of use
};

// Thread-safe. Places on the earth are longitude and latitude in degrees, and a height above the
// ellipsoid where the system is vertical.
class Projection {
 public:
  virtual ~Projection() = default;
  virtual const ProjectedSystem& system() const = 0;
  // InputError where PROJ cannot transform the point.
  virtual Eigen::Vector3d to_earth(const Eigen::Vector3d& p) const = 0;
  virtual Eigen::Vector3d from_earth(const Eigen::Vector3d& p) const = 0;
};

// The function of that library: a new Projection of the text, which the caller owns. InputError as
// ReferenceSystem::of.
using ProjectionMaker = Projection*(const std::string& text);
inline constexpr const char* kProjectionLibrary = "projection.so";
inline constexpr const char* kProjectionMaker = "lapwing_projection";

InputError reference_refusal(const std::string& text, const std::string& why);
// "(1.5, 2, 0)"
std::string reference_point(const Eigen::Vector3d& p);

}  // namespace lapwing
