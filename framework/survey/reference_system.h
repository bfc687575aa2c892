// SPDX-License-Identifier: Apache-2.0
// Reference systems of coordinates, as surveys state them: "EPSG:28992", "EPSG:7415" (with
// heights), a PROJ string or WKT. By PROJ, where Lapwing was built with it.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "framework/geometry/geodetic.h"

namespace lapwing {

// Immutable, cheap to copy, thread-safe. Points are x, y, z whatever the order of the system's own
// axes: of a geographic one longitude and latitude in degrees, else east and north in its unit.
class ReferenceSystem {
 public:
  // InputError, which names the text: PROJ is not built in (with the package and the commands that
  // cure it); the text is unknown, or no system of places on the earth; PROJ knows no
  // transformation to WGS 84, or lacks a grid that all of them need. Nothing is ever fetched.
  static ReferenceSystem of(const std::string& text);
  // Whether PROJ is built in.
  static bool available();

  const std::string& text() const;  // as it was given
  const std::string& name() const;  // "Amersfoort / RD New"

  bool geographic() const;         // x and y are degrees
  double metres_per_unit() const;  // of x and y; 0 of a geographic one
  std::string unit() const;        // of x and y: "metre", "US survey foot", "degree"

  // Whether the system says what heights are above, so that z becomes a height above the ellipsoid.
  // Without, z is in metres and passes unchanged, and what it is above is for the caller to know.
  bool vertical() const;
  double metres_per_height() const;  // of z; 1 without a vertical part
  // The system without its vertical part; itself where it has none.
  ReferenceSystem horizontal() const;

  // InputError, which names the text and the point: a figure is not finite, PROJ cannot transform
  // the point, or it lies more than 1 degree outside of the area where the system is in use, as
  // points do whose x and y are swapped.
  GeodeticPoint to_geodetic(const Eigen::Vector3d& p) const;
  Eigen::Vector3d from_geodetic(const GeodeticPoint& point) const;

 private:
  struct Impl;
  explicit ReferenceSystem(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace lapwing
