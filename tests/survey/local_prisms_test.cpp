// SPDX-License-Identifier: Apache-2.0
// Polygons of surveyors in the world frame, and heights that could be either.
#include "framework/survey/local_prisms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/geometry/geodetic.h"
#include "framework/survey/reference_system.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

const GeodeticOrigin kOrigin{52.0, 4.37, 40, HeightOf::ellipsoid, 0};

// Corners of a square of 20 m, 30 m east of the origin, in degrees.
SurveyPolygon square() {
  SurveyPolygon polygon;
  polygon.name = "square";
  polygon.place = "a.kml: 'square'";
  for (const Vector2d& p : {Vector2d(30, 0), Vector2d(50, 0), Vector2d(50, 20), Vector2d(30, 20)}) {
    const GeodeticPoint point = to_geodetic(kOrigin.point(), Vector3d(p.x(), p.y(), 0));
    polygon.outline.emplace_back(point.longitude_deg, point.latitude_deg);
  }
  return polygon;
}

PrismReference degrees() {
  PrismReference reference;
  reference.system = PolygonSystem::degrees;
  reference.origin = kOrigin;
  return reference;
}

std::string refusal(const SurveyPolygon& polygon, const PrismReference& reference) {
  try {
    local_prism(polygon, reference);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LocalPrisms, OfDegreesLieWhereTheyWereMeasured) {
  const LocalPrism prism = local_prism(square(), degrees());
  ASSERT_EQ(prism.outline.size(), 4u);
  EXPECT_LT((prism.outline[0] - Vector2d(30, 0)).norm(), 1e-6);
  EXPECT_LT((prism.outline[2] - Vector2d(50, 20)).norm(), 1e-6);
  EXPECT_FALSE(prism.low);
  EXPECT_EQ(prism.weight, 1);
}

TEST(LocalPrisms, OfAReferenceSystemLieWhereItsCoordinatesAre) {
  if (!ReferenceSystem::available()) GTEST_SKIP() << "built without PROJ (libproj-dev)";
  const ReferenceSystem dutch = ReferenceSystem::of("EPSG:28992");
  SurveyPolygon polygon = square();
  for (Vector2d& corner : polygon.outline)
    corner = dutch.from_geodetic({corner.y(), corner.x(), 40}).head<2>();
  PrismReference reference = degrees();
  reference.system = PolygonSystem::named;
  reference.name = "EPSG:28992";
  const LocalPrism prism = local_prism(polygon, reference);
  EXPECT_LT((prism.outline[2] - Vector2d(50, 20)).norm(), 0.01);
  std::swap(polygon.outline[1].x(), polygon.outline[1].y());
  EXPECT_THAT(refusal(polygon, reference), HasSubstr("corner 2"));
}

TEST(LocalPrisms, HeightsSayWhatTheyAreAbove) {
  SurveyPolygon polygon = square();
  polygon.from = 2;
  polygon.to = 30;
  EXPECT_THAT(refusal(polygon, degrees()), HasSubstr("state heights"));
  PrismReference reference = degrees();
  reference.heights = HeightAbove::world;
  EXPECT_EQ(local_prism(polygon, reference).high, 30);
  reference.heights = HeightAbove::ground;
  EXPECT_THAT(refusal(polygon, reference), HasSubstr("state ground_level"));
  reference.ground_level = -1.5;
  EXPECT_EQ(local_prism(polygon, reference).low, 0.5);
  EXPECT_EQ(local_prism(polygon, reference).high, 28.5);
  reference.heights = HeightAbove::ellipsoid;
  polygon.from = 42, polygon.to = 70;
  EXPECT_NEAR(*local_prism(polygon, reference).low, 2, 1e-3);
  EXPECT_NEAR(*local_prism(polygon, reference).high, 30, 1e-3);
  // Above the sea, with an origin above the sea as well: the geoid cancels.
  reference.heights = HeightAbove::sea;
  reference.origin = GeodeticOrigin{52.0, 4.37, 1, HeightOf::sea, 43.2};
  polygon.from = 3, polygon.to = 31;
  EXPECT_NEAR(*local_prism(polygon, reference).low, 2, 1e-3);
  reference.origin = GeodeticOrigin{52.0, 4.37, 0, HeightOf::ground, 0};
  EXPECT_THAT(refusal(polygon, reference), HasSubstr("origin.height"));
}

TEST(LocalPrisms, BadPolygonsGetOneMessageThatNamesThem) {
  PrismReference reference = degrees();
  reference.origin.reset();
  EXPECT_THAT(refusal(square(), reference), HasSubstr("the mission has no origin"));
  SurveyPolygon exchanged = square();
  for (Vector2d& corner : exchanged.outline) std::swap(corner.x(), corner.y());
  EXPECT_THAT(refusal(exchanged, degrees()), HasSubstr("longitude and latitude exchanged"));
  SurveyPolygon metres = square();
  metres.outline[2] = {84000, 447000};
  EXPECT_THAT(refusal(metres, degrees()), HasSubstr("coordinates = \"EPSG:...\""));
  SurveyPolygon crossed = square();
  std::swap(crossed.outline[1], crossed.outline[2]);
  EXPECT_THAT(refusal(crossed, degrees()), HasSubstr("a.kml: 'square': its edges"));
  SurveyPolygon flat = square();
  flat.outline.resize(3);
  flat.outline[2] = (flat.outline[0] + flat.outline[1]) / 2;
  EXPECT_THAT(refusal(flat, degrees()), HasSubstr("a.kml: 'square'"));
  SurveyPolygon holed = square();
  holed.holes.push_back(holed.outline);
  for (Vector2d& corner : holed.holes[0]) corner.x() += 2e-4;
  EXPECT_THAT(refusal(holed, degrees()), HasSubstr("hole 1: it must lie within the outline"));
  SurveyPolygon turned = square();
  turned.from = 9, turned.to = 3;
  reference = degrees();
  reference.heights = HeightAbove::world;
  EXPECT_THAT(refusal(turned, reference), HasSubstr("9 m and 3 m"));
}

}  // namespace
}  // namespace lapwing
