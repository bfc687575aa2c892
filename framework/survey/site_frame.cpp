// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/site_frame.h"

#include <cmath>

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 100;                // m, edge of the cubes
constexpr double kStepDegrees = 1.0 / 1024;  // of latitude and longitude, about 109 m

}  // namespace

LatticeFunction::LatticeFunction(Function function, const Vector3d& steps)
    : function_(std::move(function)), steps_(steps) {}

std::size_t LatticeFunction::PlaceHash::operator()(const Place& place) const {
  std::uint64_t mixed = 0;
  for (const std::int64_t number : place)
    mixed = (mixed ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15ull;
  return static_cast<std::size_t>(mixed ^ mixed >> 32);
}

const Vector3d& LatticeFunction::corner(const Place& place) {
  const auto found = corners_.find(place);
  if (found != corners_.end()) return found->second;
  const Vector3d p(static_cast<double>(place[0]), static_cast<double>(place[1]),
                   static_cast<double>(place[2]));
  return corners_.emplace(place, function_(p.cwiseProduct(steps_))).first->second;
}

Vector3d LatticeFunction::operator()(const Vector3d& p) {
  // Places without a number, or far from everything, are for the function to refuse.
  if (!p.allFinite() || !(p.cwiseQuotient(steps_).cwiseAbs().maxCoeff() < 1e12))
    return function_(p);
  const Vector3d scaled = p.cwiseQuotient(steps_), low = scaled.array().floor();
  const Place cube{static_cast<std::int64_t>(low.x()), static_cast<std::int64_t>(low.y()),
                   static_cast<std::int64_t>(low.z())};
  if (cube_ != cube) {
    cube_.reset();
    for (std::size_t k = 0; k < 8; ++k)
      of_cube_[k] = corner({cube[0] + static_cast<std::int64_t>(k & 1),
                            cube[1] + static_cast<std::int64_t>(k >> 1 & 1),
                            cube[2] + static_cast<std::int64_t>(k >> 2)});
    cube_ = cube;
  }
  const Vector3d t = scaled - low;
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 0; k < 8; ++k)
    sum += ((k & 1) ? t.x() : 1 - t.x()) * ((k >> 1 & 1) ? t.y() : 1 - t.y()) *
           ((k >> 2) ? t.z() : 1 - t.z()) * of_cube_[k];
  return sum;
}

SiteFrame::SiteFrame(const Vector3d& zero, double unit) : zero_(zero), unit_(unit) {}

SiteFrame::SiteFrame(const ReferenceSystem& system, const GeodeticPoint& origin,
                     double metres_per_height) {
  const double height = system.vertical() ? 1 : metres_per_height;
  const double height_unit = system.vertical() ? system.metres_per_height() : metres_per_height;
  exactly_forth_ = [=](const Vector3d& p) {
    return to_local(origin, system.to_geodetic({p.x(), p.y(), height * p.z()}));
  };
  exactly_back_ = [=](const Vector3d& p_W) {
    const Vector3d p = system.from_geodetic(to_geodetic(origin, p_W));
    return Vector3d(p.x(), p.y(), p.z() / height);
  };
  const double step = system.geographic() ? kStepDegrees : kStep / system.metres_per_unit();
  forth_ =
      std::make_shared<LatticeFunction>(exactly_forth_, Vector3d(step, step, kStep / height_unit));
  back_ = std::make_shared<LatticeFunction>(exactly_back_, Vector3d::Constant(kStep));
}

Vector3d SiteFrame::to_world(const Vector3d& p) const {
  return forth_ ? (*forth_)(p) : unit_ * (p - zero_);
}

Vector3d SiteFrame::from_world(const Vector3d& p_W) const {
  return back_ ? (*back_)(p_W) : p_W / unit_ + zero_;
}

Vector3d SiteFrame::exactly_to_world(const Vector3d& p) const {
  return exactly_forth_ ? exactly_forth_(p) : unit_ * (p - zero_);
}

Vector3d SiteFrame::exactly_from_world(const Vector3d& p_W) const {
  return exactly_back_ ? exactly_back_(p_W) : p_W / unit_ + zero_;
}

}  // namespace lapwing
