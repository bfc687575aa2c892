// SPDX-License-Identifier: Apache-2.0
// Where on the earth the world frame of a plan is, and what its height is measured from.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "framework/geometry/geodetic.h"

namespace lapwing {

// What the height of an origin is measured from. The three differ by up to 100 m and more.
//   ellipsoid: WGS 84, as receivers of satellite navigation compute it
//   sea:       the geoid, as maps and autopilots state it ("AMSL")
//   ground:    the ground at the origin itself: the point z = 0 of the world is so far above it
enum class HeightOf { ellipsoid, sea, ground };

std::string_view to_string(HeightOf reference);
// Nothing for another word.
std::optional<HeightOf> height_of_named(std::string_view word);

struct GeodeticOrigin {
  double latitude_deg = 0;   // north positive, -90 to 90
  double longitude_deg = 0;  // east positive, -180 to 180
  double height = 0;         // m, above what `height_of` says
  HeightOf height_of = HeightOf::ellipsoid;
  // m, of the sea above the ellipsoid at the origin; of a height above the sea alone, else 0.
  double geoid_height = 0;

  // m above the ellipsoid; nothing for a height above the ground, which does not tell.
  std::optional<double> altitude() const;
  // The point, for the frame. A height above the ground counts from the ellipsoid: 1 km of it would
  // move a point 1 km away by 16 cm.
  GeodeticPoint point() const;

  bool operator==(const GeodeticOrigin&) const = default;
};

// An origin from figures that somebody states; heights above the sea look up the geoid. Throws
// InputError, beginning with `what` and the key ("origin.latitude_deg: ..."), for figures that are
// not finite or out of range, for 0, 0 and for heights where nobody flies: below -500 m or above
// 9000 m; of the ground below -100 m or above 1000 m.
GeodeticOrigin stated_origin(double latitude_deg, double longitude_deg, double height,
                             HeightOf height_of, const std::string& what = "origin");

// m of the geoid above the ellipsoid, of the model that GeographicLib finds (its environment
// variables GEOGRAPHICLIB_GEOID_NAME and GEOGRAPHICLIB_GEOID_PATH apply). Throws InputError, which
// says how to install one, where there is none, and beginning with `what`.
double geoid_height_at(double latitude_deg, double longitude_deg, const std::string& what);

}  // namespace lapwing
