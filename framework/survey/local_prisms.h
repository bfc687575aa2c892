// SPDX-License-Identifier: Apache-2.0
// Polygons of surveyors in the world frame: x east, y north in metres, heights above its origin.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/geometry/geodetic_origin.h"
#include "framework/geometry/interest_region.h"
#include "framework/survey/polygon_file.h"

namespace lapwing {

// What polygons are stated in.
enum class PolygonSystem {
  local,    // m, east and north of the world's origin
  degrees,  // longitude and latitude of WGS 84
  named     // a reference system: "EPSG:28992"
};

// What heights are stated above.
enum class HeightAbove { world, ground, sea, ellipsoid };
std::optional<HeightAbove> height_above_named(const std::string& word);

struct PrismReference {
  PolygonSystem system = PolygonSystem::local;
  std::string name;                      // of the system, where it has a name
  std::optional<GeodeticOrigin> origin;  // of the world
  std::optional<HeightAbove> heights;    // absent: not stated, which is the world of local polygons
  std::optional<double> ground_level;    // m, world: level ground
};

// A prism whose ends may be missing.
struct LocalPrism {
  std::string name;
  GroundPolygon outline;
  std::vector<GroundPolygon> holes;
  std::optional<double> low, high;  // m, world
  double weight = 1;
};

// InputError, beginning with the polygon's place: no origin where one is needed, coordinates out of
// range or more than kFarthestPrism from the origin, what region_fault finds, heights whose
// reference is not stated or not known (level ground, the height of the origin, the geoid).
LocalPrism local_prism(const SurveyPolygon& polygon, const PrismReference& reference);

inline constexpr double kFarthestPrism = 1e5;  // m

}  // namespace lapwing
