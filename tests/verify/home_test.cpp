// SPDX-License-Identifier: Apache-2.0
// Heights above home and above the ground of the origin, distances from home, rally points.
#include <gmock/gmock.h>

#include <limits>
#include <set>

#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

std::set<std::string> failures_of_plan(const Plan& plan) {
  std::set<std::string> names;
  for (const Check& check : verify(plan).failures()) names.insert(check.name);
  return names;
}

Check home_check_of(const Plan& plan, const char* name) {
  const Certificate certificate = verify(plan);
  const Check* check = certificate.find(name);
  EXPECT_NE(check, nullptr) << name;
  return check ? *check : Check{};
}

// The reference flight, which climbs steadily, with a home 4 m below its begin.
Plan plan_from_home() {
  Plan plan = reference_plan();
  plan.home = Home{{-8, 0, 6}, std::nullopt, std::nullopt, {}};
  return plan;
}

double climb_of(const Plan& plan) {
  return plan.trajectory.samples.back().position.z() - plan.home->position.z();
}

TEST(HomeChecks, PlansWithoutAHomeHaveNone) {
  const Certificate certificate = verify(reference_plan());
  for (const char* name :
       {"height_above_home", "distance_from_home", "height_above_ground", "rally_points"})
    EXPECT_EQ(certificate.find(name), nullptr) << name;
  // A home alone asks for nothing.
  EXPECT_EQ(verify(plan_from_home()).checks.size(), certificate.checks.size());
}

TEST(HomeChecks, TheLargestHeightIsKeptToTheMillimetre) {
  Plan plan = plan_from_home();
  const double climb = climb_of(plan);
  plan.home->max_height = climb + 0.01;
  EXPECT_NEAR(*home_check_of(plan, "height_above_home").worst, climb, 1e-3);
  EXPECT_TRUE(verify(plan).feasible());
  plan.home->max_height = 0.999 * climb;
  EXPECT_EQ(failures_of_plan(plan), std::set<std::string>{"height_above_home"});
  EXPECT_THAT(home_check_of(plan, "height_above_home").detail,
              HasSubstr("take-off place is at z = 6 m"));
}

TEST(HomeChecks, ThePathBetweenSamplesCounts) {
  // Up with 1 m/s, turned round by -0.5 m/s^2 within one interval of 4 s: 1 m higher in its middle.
  Sample start;
  start.position = {0, 0, 10};
  start.velocity = {0, 0, 1};
  Plan plan = PlanBuilder(true, start).add(4, {{0, 0, -0.5}}).finish({{0, 0, -0.5}});
  plan.home = Home{{0, 0, 0}, 10.9, std::nullopt, {}};
  const Check check = home_check_of(plan, "height_above_home");
  EXPECT_NEAR(*check.worst, 11, 1e-3);
  EXPECT_NEAR(check.at, 2, 0.05);
  EXPECT_FALSE(check.pass);
}

TEST(HomeChecks, TheLargestDistanceIsThatAcrossTheGround) {
  Plan plan = plan_from_home();
  plan.home->position = {-8, 3, -500};
  const Eigen::Vector3d end = plan.trajectory.samples.back().position;
  const double distance = std::hypot(end.x() + 8, end.y() - 3);
  plan.home->max_distance = distance + 0.01;
  EXPECT_NEAR(*home_check_of(plan, "distance_from_home").worst, distance, 1e-3);
  EXPECT_TRUE(verify(plan).feasible());
  plan.home->max_distance = distance - 0.1;
  EXPECT_EQ(failures_of_plan(plan), std::set<std::string>{"distance_from_home"});
}

TEST(HomeChecks, WithAnOriginHeightsFollowTheEllipsoid) {
  Plan plan = plan_from_home();
  plan.home->position = {-10008, 0, 6};  // 10 km away
  plan.home->max_height = 120;
  const double flat = *home_check_of(plan, "height_above_home").worst;
  plan.geodetic_origin = GeodeticOrigin{46.5, 6.6, 400, HeightOf::ellipsoid};
  // The origin's plane is 10008^2 / 2R above the ellipsoid at home, and R is 6,390 km along the
  // prime vertical at that latitude.
  EXPECT_NEAR(*home_check_of(plan, "height_above_home").worst,
              flat - 10008.0 * 10008 / (2 * 6.39e6), 0.01);
}

TEST(HomeChecks, NothingFliesBelowTheGroundOfItsOrigin) {
  Plan plan = reference_plan({.lift = -0.4});
  const double lowest = plan.trajectory.samples.back().position.z();
  plan.geodetic_origin = GeodeticOrigin{46.5, 6.6, -lowest + 0.01, HeightOf::ground};
  EXPECT_NEAR(*home_check_of(plan, "height_above_ground").worst, 0.01, 1e-3);
  EXPECT_TRUE(verify(plan).feasible());
  plan.geodetic_origin->height = -lowest - 0.1;
  EXPECT_EQ(failures_of_plan(plan), std::set<std::string>{"height_above_ground"});
  // Heights above the sea tell nothing of the ground.
  plan.geodetic_origin->height_of = HeightOf::sea;
  EXPECT_EQ(verify(plan).find("height_above_ground"), nullptr);
}

TEST(HomeChecks, RallyPointsKeepWhatTheFlightKeeps) {
  Plan plan = plan_from_home();
  plan.home->rally_points = {{-8, 0, 8}};
  EXPECT_TRUE(home_check_of(plan, "rally_points").pass);
  const auto broken = [&](const Eigen::Vector3d& point, const std::string& by) {
    Plan bad = plan;
    bad.home->rally_points.push_back(point);
    EXPECT_EQ(failures_of_plan(bad), std::set<std::string>{"rally_points"}) << by;
    EXPECT_THAT(home_check_of(bad, "rally_points").detail, HasSubstr("rally point 2, " + by));
  };
  const Obstacle& tree = plan.environment.obstacles[0];
  const auto center = recorded_numbers(tree.parameters, "center");
  broken({center[0], center[1], center[2] + 1.2}, "sphere 'tree'");  // 0.2 m of the 0.5 m
  plan.home->max_height = 20;
  broken({-8, 0, 27}, "the largest height above home");
  plan.home->max_distance = 60;
  broken({-8, 61, 12}, "the largest distance from home");
  plan.environment.obstacles.push_back(
      flight_zone_at("park", {{-50, -50}, {50, -50}, {50, 50}, {-50, 50}}));
  broken({-8, 49.8, 12}, "flight zone 'park'");
  plan.geodetic_origin = GeodeticOrigin{46.5, 6.6, 3, HeightOf::ground};
  broken({-40, 0, -3.5}, "the ground");
}

TEST(HomeChecks, ARallyPointWithNothingToKeepIsNotJudged) {
  Plan plan = plan_from_home();
  plan.environment.obstacles.clear();
  plan.home->rally_points = {{0, 0, 20}};
  EXPECT_THAT(home_check_of(plan, "rally_points").skipped, HasSubstr("no obstacle and no limit"));
}

TEST(HomeChecks, NumbersThatNobodyCanMeanFailTheDocument) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto problem = [](const std::function<void(Home&)>& change) {
    Plan plan = plan_from_home();
    change(*plan.home);
    return home_check_of(plan, "document").detail;
  };
  EXPECT_THAT(problem([&](Home& h) { h.position.z() = nan; }), HasSubstr("take-off place"));
  EXPECT_THAT(problem([&](Home& h) { h.max_height = nan; }), HasSubstr("largest height"));
  EXPECT_THAT(problem([&](Home& h) { h.max_height = 0; }), HasSubstr("must be above 0"));
  EXPECT_THAT(problem([&](Home& h) { h.max_distance = -5; }), HasSubstr("largest distance"));
  EXPECT_THAT(problem([&](Home& h) {
                h.rally_points = {{0, 0, 1e9}};
              }),
              HasSubstr("rally point 1 holds"));
}

}  // namespace
}  // namespace lapwing
