// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/site_reference.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e5;  // of a degree
constexpr double kDegreesExtent = 0.5, kDegreesShare = 0.2;

[[noreturn]] void refuse_site(const StatedReference& stated, const std::string& why) {
  throw InputError("'" + stated.name + "': " + why);
}

std::string three(const Vector3d& p, int digits = 10) {
  return "(" + plain_number(p.x(), digits) + ", " + plain_number(p.y(), digits) + ", " +
         plain_number(p.z(), digits) + ")";
}

SiteReference without_system(const StatedReference& stated) {
  const Vector3d zero = stated.zero.value_or(Vector3d::Zero());
  const double unit = stated.unit.value_or(1);
  SiteReference reference{SiteFrame(zero, unit), {}, {}, {}};
  const Vector3d place = reference.frame.to_world(stated.sample);
  if (!(place.norm() <= kFarthestSite)) {
    const Vector3d near = (stated.sample / 100).array().floor() * 100;
    refuse_site(stated,
                "its coordinates, such as " + three(stated.sample) + ", lie " +
                    plain_number(place.norm(), 4) +
                    " m from the world's origin, and at most 1e5 m are possible. State their "
                    "reference system (" +
                    stated.option +
                    ".system = \"EPSG:...\"), or which of them is the world's "
                    "origin (" +
                    stated.option + ".zero = {" + plain_number(near.x(), 10) + ", " +
                    plain_number(near.y(), 10) + ", " + plain_number(near.z(), 10) + "})");
  }
  if (!stated.note_of_data.empty() && stated.zero == std::nullopt)
    reference.notes.push_back("'" + stated.name + "': " + stated.note_of_data +
                              "; its coordinates are taken to be metres of the world frame");
  if (!stated.system_of_data.empty())
    reference.notes.push_back("'" + stated.name +
                              "': its own reference system is left aside, because " +
                              stated.option + ".zero is stated");
  return reference;
}

// The system, without its vertical part where PROJ cannot transform that here.
ReferenceSystem usable_system(const StatedReference& stated, const std::string& text,
                              std::vector<std::string>& notes) {
  const std::size_t plus = text.find('+');
  const bool two_codes = text.starts_with("EPSG:") && plus != text.npos;
  try {
    const ReferenceSystem system = ReferenceSystem::of(text);
    if (!system.vertical()) return system;
    try {
      system.to_geodetic(stated.sample);
      return system;
    } catch (const InputError&) {
      const ReferenceSystem across = system.horizontal();
      across.to_geodetic(stated.sample);  // what is wrong with x and y is said here
      notes.push_back("'" + stated.name + "': PROJ lacks the grid of the heights of '" +
                      system.name() + "'");
      return across;
    }
  } catch (const InputError&) {
    if (!two_codes || !ReferenceSystem::available()) throw;
    const ReferenceSystem across = ReferenceSystem::of(text.substr(0, plus));
    across.to_geodetic(stated.sample);
    notes.push_back("'" + stated.name + "': PROJ lacks the grid of the heights of '" + text + "'");
    return across;
  }
}

double unit_of_heights(const StatedReference& stated, const ReferenceSystem& system,
                       std::vector<std::string>& notes) {
  double unit = 1;
  std::string from = "of x and y";
  if (stated.height_unit) {
    return *stated.height_unit;
  } else if (stated.height_unit_of_data > 0) {
    unit = stated.height_unit_of_data;
    from = "that it states";
  } else if (!system.geographic()) {
    unit = system.metres_per_unit();
  }
  if (unit != 1)
    notes.push_back("'" + stated.name + "': heights are read in the unit " + from + ", " +
                    plain_number(unit, 9) + " m");
  return unit;
}

GeodeticPoint point_of_origin(const StatedReference& stated, const ReferenceSystem& system,
                              std::vector<std::string>& notes) {
  const GeodeticOrigin& origin = *stated.origin;
  if (origin.height_of == HeightOf::ground)
    refuse_site(stated,
                "origin.height is above the ground, which does not tell how high the "
                "heights of the data lie: state it above the ellipsoid or the sea");
  if (system.vertical()) return {origin.latitude_deg, origin.longitude_deg, *origin.altitude()};
  notes.push_back("'" + stated.name + "': its heights are taken to be above the " +
                  std::string(to_string(origin.height_of)) + ", as origin.height is");
  return {origin.latitude_deg, origin.longitude_deg, origin.height};
}

SiteReference of_system(const StatedReference& stated, const std::string& text) {
  if (stated.zero)
    refuse_site(stated, stated.option +
                            ".zero is the world's origin in coordinates without a "
                            "reference system: give it or " +
                            stated.option + ".system");
  if (stated.unit) refuse_site(stated, "its unit is that of its reference system: leave unit out");
  std::vector<std::string> notes;
  const ReferenceSystem system = usable_system(stated, text, notes);
  const double height_unit = system.vertical() ? 1 : unit_of_heights(stated, system, notes);
  std::optional<GeodeticOrigin> found;
  GeodeticPoint point;
  if (stated.world) {
    point = *stated.world;
  } else if (stated.origin) {
    point = point_of_origin(stated, system, notes);
  } else {
    point = system.to_geodetic({stated.sample.x(), stated.sample.y(), height_unit * stated.lowest});
    point.latitude_deg = std::round(point.latitude_deg * kRounding) / kRounding;
    point.longitude_deg = std::round(point.longitude_deg * kRounding) / kRounding;
    point.altitude = std::floor(point.altitude);
    if (system.vertical())
      found = stated_origin(point.latitude_deg, point.longitude_deg, point.altitude,
                            HeightOf::ellipsoid);
    notes.push_back("'" + stated.name + "': the world's origin is at latitude " +
                    plain_number(point.latitude_deg, 9) + ", longitude " +
                    plain_number(point.longitude_deg, 9) + ", and z = 0 is at " +
                    plain_number(point.altitude) + " m " +
                    (system.vertical() ? "above the ellipsoid" : "of its heights") +
                    "; origin states another one");
  }
  notes.insert(notes.begin(), "'" + stated.name + "': reference system '" + system.name() + "'" +
                                  (system.vertical() ? "" : ", heights as they are"));
  return {SiteFrame(system, point, height_unit), std::move(notes), found, point};
}

}  // namespace

SiteReference refer_site(const StatedReference& stated) {
  const bool own_zero = stated.zero && stated.system.empty();
  const std::string& text = stated.system.empty() ? stated.system_of_data : stated.system;
  return own_zero || text.empty() ? without_system(stated) : of_system(stated, text);
}

void require_no_degrees(const StatedReference& stated, const Eigen::AlignedBox3d& bounds) {
  const bool own_zero = stated.zero && stated.system.empty();
  if (own_zero || stated.unit || !stated.system.empty() || !stated.system_of_data.empty()) return;
  const Vector3d size = bounds.sizes();
  const Vector3d farthest = bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs());
  const double across = std::max(size.x(), size.y());
  if (!(farthest.x() <= 180 && farthest.y() <= 90 && across < kDegreesExtent &&
        across < kDegreesShare * size.z()))
    return;
  refuse_site(stated, "its x and y lie between " + three(bounds.min(), 8) + " and " +
                          three(bounds.max(), 8) +
                          " and look like degrees of longitude and latitude. State their reference "
                          "system, as " +
                          stated.option + ".system = \"EPSG:4326\"");
}

}  // namespace lapwing
