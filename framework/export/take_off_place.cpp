// SPDX-License-Identifier: Apache-2.0
#include "framework/export/take_off_place.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

double to_millimetre(double value) {
  return std::round(value * 1e3) / 1e3 + 0.0;
}

}  // namespace

double take_off_z(const Plan& plan, std::optional<double> home_z) {
  if (home_z) return *home_z;
  if (plan.home) return plan.home->position.z();
  const auto& origin = plan.geodetic_origin;
  return origin && origin->height_of == HeightOf::ground ? 0.0 - origin->height : 0;
}

Eigen::Vector3d take_off_place(const Plan& plan, std::optional<double> home_z,
                               const Eigen::Vector3d& first) {
  Eigen::Vector3d place = plan.home ? plan.home->position : first;
  place.z() = take_off_z(plan, home_z);
  return place;
}

double height_above(const EarthPoint& home, const EarthFrame& frame,
                    const Eigen::Vector3d& position) {
  return to_millimetre(frame.at(position).height - home.height);
}

void require_above_ground(const std::vector<FilePlace>& places, const EarthFrame& frame,
                          const std::string& format) {
  if (frame.heights() != HeightOf::ground) return;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double height = to_millimetre(frame.at(places[k].position).height);
    if (height > 0) continue;
    throw InputError(format + ": waypoint " + std::to_string(k + 1) + " (at " +
                     plain_number(places[k].time, 4) + " s of the plan, z = " +
                     plain_number(places[k].position.z(), 4) + " m) is " + plain_number(height, 4) +
                     " m above the ground of the origin; expected more than 0 m: a higher "
                     "flight, or an origin that states its true height above the ground");
  }
}

std::string below_take_off(const std::vector<FilePlace>& places, const EarthFrame& frame,
                           const EarthPoint& home) {
  std::size_t count = 0;
  double lowest = 0, time = 0;
  for (const FilePlace& place : places) {
    const double height = height_above(home, frame, place.position);
    if (height >= 0) continue;
    ++count;
    if (height < lowest) lowest = height, time = place.time;
  }
  if (count == 0) return "";
  return std::to_string(count) + " of " + std::to_string(places.size()) +
         " waypoints are below the take-off place, the lowest by " + plain_number(-lowest, 4) +
         " m (at " + plain_number(time, 4) +
         " s of the plan): the file is right only where the ground falls away";
}

}  // namespace lapwing
