// SPDX-License-Identifier: Apache-2.0
// Whether the pilot sees the vehicle during the whole flight, and from how far.
//
// How: the line from the pilot's eye to the vehicle's middle is tried at the integrated points,
// once the vehicle has moved a quarter of a voxel since the last try. Voxels of the maps that are
// not known to be free hide it, and so do opaque shapes. Zones are not opaque, and meshes are left
// to the map that they were made with.
#include "framework/core/number_text.h"
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

class Sight {
 public:
  explicit Sight(const Flight& flight) : pilot_(*flight.plan.environment.pilot) {
    const auto& obstacles = flight.plan.environment.obstacles;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const JudgedShape& shape = *flight.shapes[i];
      if (const BlockedVoxels* voxels = shape.voxels()) {
        maps_.push_back(voxels);
        apart_ = std::min(apart_, voxels->grid().resolution() / 4);
      } else if (obstacles[i].opaque && obstacles[i].side == Side::keep_out &&
                 obstacles[i].type != "mesh" && obstacles[i].still()) {
        shapes_.push_back(&shape);
      }
    }
  }

  double apart() const { return apart_; }

  bool sees(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d line = p - pilot_.eye;
    const double distance = line.norm();
    if (distance <= pilot_.beside) return true;
    const Eigen::Vector3d from = pilot_.eye + pilot_.beside / distance * line;
    for (const BlockedVoxels* map : maps_)
      if (!(map->nearest(from, p, map->grid().resolution()).distance > 0)) return false;
    for (const JudgedShape* shape : shapes_)
      if (shape->hides(from, p, 0)) return false;
    return true;
  }

 private:
  PilotPlace pilot_;
  std::vector<const BlockedVoxels*> maps_;
  std::vector<const JudgedShape*> shapes_;
  double apart_ = 0.1;  // m
};

std::string place_text(const Eigen::Vector3d& p) {
  return "(" + plain_number(p.x(), 4) + ", " + plain_number(p.y(), 4) + ", " +
         plain_number(p.z(), 4) + ")";
}

}  // namespace

void check_pilot(const Flight& flight, Certificate& certificate) {
  if (!flight.plan.environment.pilot) return;
  const PilotPlace& pilot = *flight.plan.environment.pilot;
  const Sight sight(flight);
  Worst range("pilot_distance", pilot.range);
  double hidden = 0, at = 0;  // s
  bool seen = true;
  std::optional<Eigen::Vector3d> tried;
  std::string where;
  const auto look = [&](const MotionPoint& point) {
    range.see((point.position - pilot.eye).norm(), point.time);
    if (tried && (point.position - *tried).norm() < sight.apart()) return;
    tried = point.position;
    seen = sight.sees(point.position);
    if (seen || !where.empty()) return;
    at = point.time;
    where = "hidden from the pilot first at " + place_text(point.position);
  };
  look(flight.motion.stated(0));
  for (std::size_t i = 0; i < flight.motion.intervals(); ++i) {
    const auto points = flight.motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      if (!seen) hidden += points[k].time - points[k - 1].time;
      look(points[k]);
    }
  }
  // A moment at the end of the flight has no length.
  if (!where.empty()) hidden = std::max(hidden, 1e-3);
  certificate.checks.push_back(range.check());
  Check check = judged(make_check("pilot_sight"), hidden, 0, 0, at);
  if (!where.empty()) check.detail += (check.detail.empty() ? "" : "; ") + where;
  certificate.checks.push_back(check);
}

}  // namespace lapwing
