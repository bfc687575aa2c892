// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/local_prisms.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/geometry/geodetic.h"
#include "framework/geometry/polygon.h"
#include "framework/survey/reference_system.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;

class Placing {
 public:
  Placing(const SurveyPolygon& polygon, const PrismReference& reference)
      : polygon_(polygon), reference_(reference) {
    if (reference.system == PolygonSystem::local) return;
    if (!reference.origin)
      fail(
          "its corners are on the earth, and the mission has no origin: state origin = "
          "{ latitude_deg =, longitude_deg =, height =, height_of = }");
    if (reference.system == PolygonSystem::named)
      system_.emplace(ReferenceSystem::of(reference.name));
  }

  GroundPolygon placed(const std::vector<Vector2d>& corners) const {
    GroundPolygon local;
    for (const Vector2d& corner : corners) local.push_back(placed(corner, local.size() + 1));
    return local;
  }

  // `middle`: of the prism, world. Curvature of the earth moves its ends by less than 1 m within
  // 3.5 km of the origin.
  double height(double stated, const Vector2d& middle) const {
    switch (height_reference()) {
      case HeightAbove::world:
        return stated;
      case HeightAbove::ground:
        if (!reference_.ground_level)
          fail(
              "its heights are above the ground, and no ground is known: state ground_level, the "
              "height of level ground in the world");
        return *reference_.ground_level + stated;
      case HeightAbove::sea:
      case HeightAbove::ellipsoid:
        return above_earth(stated, middle);
    }
    return stated;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(polygon_.place + ": " + what);
  }

  HeightAbove height_reference() const {
    if (reference_.heights) return *reference_.heights;
    if (reference_.system == PolygonSystem::local) return HeightAbove::world;
    fail(
        "its heights could be above the ground, the sea, the ellipsoid or the origin of the "
        "world, up to 100 m and more apart: state heights = \"ground\", \"sea\", \"ellipsoid\" "
        "or \"world\"");
  }

  double above_earth(double stated, const Vector2d& middle) const {
    const bool sea = height_reference() == HeightAbove::sea;
    const char* what = sea ? "the sea" : "the ellipsoid";
    if (!reference_.origin || !reference_.origin->altitude())
      fail(std::string("its heights are above ") + what +
           ", and how high the world's origin is above it is not known: state origin.height with "
           "height_of = \"sea\" or \"ellipsoid\"");
    const GeodeticOrigin& origin = *reference_.origin;
    GeodeticPoint point = to_geodetic(origin.point(), Eigen::Vector3d(middle.x(), middle.y(), 0));
    double geoid = 0;
    if (sea)
      geoid = origin.height_of == HeightOf::sea
                  ? origin.geoid_height
                  : geoid_height_at(point.latitude_deg, point.longitude_deg, polygon_.place);
    point.altitude = stated + geoid;
    return to_local(origin.point(), point).z();
  }

  Vector2d placed(const Vector2d& corner, std::size_t number) const {
    if (reference_.system == PolygonSystem::local) return corner;
    const std::string which = "corner " + std::to_string(number) + ", (" +
                              plain_number(corner.x(), 9) + ", " + plain_number(corner.y(), 9) +
                              "): ";
    GeodeticPoint point;
    if (system_) {
      try {
        point = system_->to_geodetic({corner.x(), corner.y(), 0});
      } catch (const InputError& error) {
        fail(which + error.what());
      }
    } else {
      if (!(std::abs(corner.x()) <= 180 && std::abs(corner.y()) <= 90))
        fail(which +
             "expected a longitude from -180 to 180 and a latitude from -90 to 90; for "
             "coordinates of another reference system state coordinates = \"EPSG:...\"");
      point = {corner.y(), corner.x(), 0};
    }
    point.altitude = reference_.origin->point().altitude;
    const Vector2d local = to_local(reference_.origin->point(), point).head<2>();
    if (!(local.norm() <= kFarthestPrism))
      fail(which + "it lies " + plain_number(local.norm() / 1000, 4) +
           " km from the origin of the world, and 100 km are the most: are longitude and latitude "
           "exchanged, or is the origin elsewhere?");
    return local;
  }

  const SurveyPolygon& polygon_;
  const PrismReference& reference_;
  std::optional<ReferenceSystem> system_;
};

}  // namespace

std::optional<HeightAbove> height_above_named(const std::string& word) {
  if (word == "world") return HeightAbove::world;
  if (word == "ground") return HeightAbove::ground;
  if (word == "sea") return HeightAbove::sea;
  if (word == "ellipsoid") return HeightAbove::ellipsoid;
  return std::nullopt;
}

LocalPrism local_prism(const SurveyPolygon& polygon, const PrismReference& reference) {
  const Placing placing(polygon, reference);
  LocalPrism prism;
  prism.name = polygon.name;
  prism.outline = placing.placed(polygon.outline);
  for (const auto& hole : polygon.holes) prism.holes.push_back(placing.placed(hole));
  prism.weight = polygon.weight.value_or(1);
  // The outline first: heights may need its middle.
  constexpr double kAnyHeight = 1;
  RegionPrism judged{polygon.name, prism.outline, prism.holes, 0, kAnyHeight, prism.weight};
  if (const std::string fault = region_fault(judged); !fault.empty())
    throw InputError(polygon.place + ": " + fault);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : prism.outline)
    middle += corner / static_cast<double>(prism.outline.size());
  if (polygon.from) prism.low = placing.height(*polygon.from, middle);
  if (polygon.to) prism.high = placing.height(*polygon.to, middle);
  if (prism.low && prism.high && !(*prism.low < *prism.high))
    throw InputError(polygon.place + ": its lower end must be below its upper one: " +
                     plain_number(*polygon.from) + " m and " + plain_number(*polygon.to) + " m");
  return prism;
}

}  // namespace lapwing
