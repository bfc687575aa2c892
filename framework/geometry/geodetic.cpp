// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/geodetic.h"

#include <GeographicLib/Geoid.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/geometry/geodetic_origin.h"

namespace lapwing {
namespace {

GeographicLib::LocalCartesian frame_at(const GeodeticPoint& origin) {
  check_geodetic(origin, "geodetic origin");
  return {origin.latitude_deg, origin.longitude_deg, origin.altitude,
          GeographicLib::Geocentric::WGS84()};
}

}  // namespace

void check_geodetic(const GeodeticPoint& point, const char* what) {
  // Comparisons with NaN are false, so each condition is written for the good case.
  const std::string name(what);
  if (!(std::abs(point.latitude_deg) <= 90)) {
    throw InputError(name + ": latitude must lie between -90 and 90 degrees");
  }
  if (!(std::abs(point.longitude_deg) <= 180)) {
    throw InputError(name + ": longitude must lie between -180 and 180 degrees");
  }
  if (!(std::abs(point.altitude) <= 1e6)) {
    throw InputError(name + ": altitude must lie within 1000 km of the ellipsoid");
  }
}

Eigen::Vector3d to_local(const GeodeticPoint& origin, const GeodeticPoint& point) {
  const GeographicLib::LocalCartesian frame = frame_at(origin);
  check_geodetic(point, "geodetic point");
  Eigen::Vector3d local;
  frame.Forward(point.latitude_deg, point.longitude_deg, point.altitude, local.x(), local.y(),
                local.z());
  return local;
}

GeodeticPoint to_geodetic(const GeodeticPoint& origin, const Eigen::Vector3d& local) {
  const GeographicLib::LocalCartesian frame = frame_at(origin);
  if (!local.allFinite()) throw InputError("local point: expected finite numbers");
  GeodeticPoint point;
  frame.Reverse(local.x(), local.y(), local.z(), point.latitude_deg, point.longitude_deg,
                point.altitude);
  return point;
}

std::string_view to_string(HeightOf reference) {
  return reference == HeightOf::ellipsoid ? "ellipsoid"
         : reference == HeightOf::sea     ? "sea"
                                          : "ground";
}

std::optional<HeightOf> height_of_named(std::string_view word) {
  for (const HeightOf reference : {HeightOf::ellipsoid, HeightOf::sea, HeightOf::ground})
    if (word == to_string(reference)) return reference;
  return std::nullopt;
}

std::optional<double> GeodeticOrigin::altitude() const {
  if (height_of == HeightOf::ground) return std::nullopt;
  return height + geoid_height;
}

GeodeticPoint GeodeticOrigin::point() const {
  return {latitude_deg, longitude_deg, height + geoid_height};
}

GeodeticOrigin stated_origin(double latitude_deg, double longitude_deg, double height,
                             HeightOf height_of, const std::string& what) {
  const auto expect = [&](bool good, const char* key, double given, const std::string& wanted) {
    if (!good)
      throw InputError(what + "." + key + ": expected " + wanted + ", got " +
                       plain_number(given, 10));
  };
  expect(std::abs(latitude_deg) <= 90, "latitude_deg", latitude_deg,
         "degrees north between -90 and 90");
  expect(std::abs(longitude_deg) <= 180, "longitude_deg", longitude_deg,
         "degrees east between -180 and 180");
  if (latitude_deg == 0 && longitude_deg == 0)
    throw InputError(what + ".latitude_deg: 0, 0 lies in the Gulf of Guinea, and is what " +
                     "receivers state before they know; expected the place of the flight");
  const bool ground = height_of == HeightOf::ground;
  const double lowest = ground ? -100 : -500, highest = ground ? 1000 : 9000;
  expect(height >= lowest && height <= highest, "height", height,
         "m above the " + std::string(to_string(height_of)) + " between " + plain_number(lowest) +
             " and " + plain_number(highest));
  GeodeticOrigin origin{latitude_deg, longitude_deg, height, height_of};
  if (height_of == HeightOf::sea)
    origin.geoid_height = geoid_height_at(latitude_deg, longitude_deg, what + ".height_of");
  return origin;
}

double geoid_height_at(double latitude_deg, double longitude_deg, const std::string& what) {
  using GeographicLib::Geoid;
  try {
    return Geoid(Geoid::DefaultGeoidName())(latitude_deg, longitude_deg);
  } catch (const GeographicLib::GeographicErr& error) {
    throw InputError(what + ": heights above the sea need a model of the geoid, and '" +
                     Geoid::DefaultGeoidName() + "' cannot be read from " +
                     Geoid::DefaultGeoidPath() + " (" + error.what() +
                     "). On Debian, as root: apt-get install geographiclib-tools, then " +
                     "geographiclib-get-geoids minimal. Or state a height above the ellipsoid " +
                     "or the ground");
  }
}

}  // namespace lapwing
