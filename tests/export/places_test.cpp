// SPDX-License-Identifier: Apache-2.0
// What a plan has on a map: points, zones, fences, names; and lines that keep clear of what is
// there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/export/camera_track.h"
#include "framework/export/earth_frame.h"
#include "framework/export/keep_clear.h"
#include "framework/export/map_features.h"
#include "framework/export/mission_fences.h"
#include "framework/export/route.h"
#include "tests/obstacles.h"
#include "tests/plugins/exporters/planned_camera.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

// Level, from (0, 0, 5) to (20, 0, 5) in 10 s.
Plan line() {
  Plan plan;
  plan.mission = "line";
  plan.kind = "film";
  plan.vehicle = to_value(filming_drone());
  plan.trajectory.has_gimbal = true;
  for (int i = 0; i <= 100; ++i) {
    Sample s;
    s.time = 0.1 * i;
    s.position = {0.2 * i, 0, 5};
    s.velocity = {2, 0, 0};
    plan.trajectory.samples.push_back(s);
  }
  return plan;
}

double twice_area(const std::vector<Eigen::Vector2d>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    sum += a.x() * b.y() - b.x() * a.y();
  }
  return sum;
}

TEST(MapFeatures, PointsAreNamedByThemselvesOrByKindAndNumber) {
  Plan plan = line();
  plan.task.keyframes = {{.time = 0, .position = {0, 0, 5}}, {.time = 4, .position = {8, 0, 5}}};
  GateTask gate;
  gate.position = {5, 0, 5};
  plan.task.gates = {gate, gate};
  plan.task.gates[1].name = "north";
  plan.environment.subjects = {{"boat", {0, 5}, {{1, 2, 3}, {4, 5, 6}}}, {"", {0}, {{7, 8, 9}}}};
  plan.home = Home{{0, -3, 0}, std::nullopt, std::nullopt, {{0, -3, 20}}};
  std::vector<std::string> names;
  for (const MapPoint& point : map_points(plan)) names.push_back(point.kind + ":" + point.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"keyframe:keyframe 1", "keyframe:keyframe 2", "gate:gate 1",
                                      "gate:north", "subject:boat", "subject:subject 2",
                                      "home:home", "rally_point:rally point 1"}));
  const std::vector<MapPoint> points = map_points(plan);
  EXPECT_EQ(points[1].time, 4.0);
  EXPECT_FALSE(points[2].time);
  EXPECT_EQ(points[4].position, Eigen::Vector3d(1, 2, 3)) << "where it begins";
}

TEST(MapFeatures, ZonesAreCounterClockwiseAndStandStill) {
  Plan plan = line();
  Obstacle moving = zone_at("ferry", {{0, 0}, {1, 0}, {1, 1}});
  moving.times = {0, 5};
  moving.moves = {{0, 0, 0}, {9, 0, 0}};
  plan.environment.obstacles = {zone_at("field", {{0, 9}, {4, 9}, {4, 6}}, 2, 30),
                                flight_zone_at("park", {{-5, -5}, {30, -5}, {30, 30}, {-5, 30}}),
                                moving, sphere_at("ball", {0, 0, 0}, 1)};
  const std::vector<MapZone> zones = map_zones(plan);
  ASSERT_EQ(zones.size(), 2u);
  EXPECT_GT(twice_area(zones[0].corners), 0) << "given clockwise";
  EXPECT_GT(twice_area(zones[1].corners), 0);
  EXPECT_FALSE(zones[0].keep_inside);
  EXPECT_TRUE(zones[1].keep_inside);
  EXPECT_EQ(zones[0].floor, 2.0);
  EXPECT_EQ(zones[0].ceiling, 30.0);
  EXPECT_FALSE(zones[1].floor);
  EXPECT_THAT(zones[0].name, HasSubstr("field"));
}

TEST(MapFeatures, NumbersOfFiles) {
  EXPECT_EQ(fixed_number(46.5191, 9), "46.519100000");
  EXPECT_EQ(fixed_number(-0.0004, 2), "0.00");
  EXPECT_EQ(fixed_number(-0.006, 2), "-0.01");
  EXPECT_EQ(fixed_number(1e9, 1), "1000000000.0");
  EXPECT_DOUBLE_EQ(compass_deg(0), 90);
  EXPECT_DOUBLE_EQ(compass_deg(M_PI / 2), 0);
  EXPECT_NEAR(compass_deg(M_PI), 270, 1e-9);
  EXPECT_NEAR(compass_deg(-5 * M_PI / 2), 180, 1e-9);
  Plan plan = line();
  EXPECT_EQ(stated_name(plan), "line (not certified)");
}

TEST(Fences, ZonesBallsAndUprightCylinders) {
  Plan plan = line();
  plan.environment.obstacles = {
      zone_at("field", {{0, 6}, {4, 6}, {4, 9}}),
      flight_zone_at("park", {{-5, -5}, {30, -5}, {30, 30}, {-5, 30}}),
      sphere_at("ball", {10, 4, 5}, 2),
      obstacle_at("silo", "cylinder",
                  {{"base", place_value({3, -4, 0})}, {"radius", 1.5}, {"height", 9.0}}),
      box_at("house", {0, 2, 0}, {1, 3, 4})};
  std::vector<std::string> said;
  const std::vector<MissionFence> fences = mission_fences(plan, said);
  EXPECT_TRUE(said.empty());
  ASSERT_EQ(fences.size(), 4u) << "a box has no fence";
  EXPECT_LT(twice_area(fences[0].corners), 0) << "clockwise";
  EXPECT_TRUE(fences[1].inclusion);
  EXPECT_EQ(fences[2].center, Eigen::Vector2d(10, 4));
  EXPECT_EQ(fences[2].radius, 2);
  EXPECT_TRUE(fences[2].corners.empty());
  EXPECT_EQ(fences[3].center, Eigen::Vector2d(3, -4));
}

TEST(Fences, WhatTheFlightPassesAboveIsLeftOutAndSaid) {
  Plan plan = line();
  plan.environment.obstacles = {zone_at("low field", {{4, -3}, {9, -3}, {9, 3}, {4, 3}}, 0, 3),
                                sphere_at("pond", {15, 0, -4}, 6),
                                zone_at("aside", {{4, 5}, {9, 5}, {9, 7}})};
  std::vector<std::string> said;
  const std::vector<MissionFence> fences = mission_fences(plan, said);
  ASSERT_EQ(fences.size(), 1u);
  EXPECT_THAT(fences[0].name, HasSubstr("aside"));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], HasSubstr("low field"));
  EXPECT_THAT(said[0], HasSubstr("pond"));
}

TEST(Fences, WhatHomeOrARallyPointWouldBreakIsLeftOutAndSaid) {
  Plan plan = line();
  plan.environment.obstacles = {zone_at("lawn", {{-9, -9}, {-4, -9}, {-4, -4}, {-9, -4}}),
                                zone_at("field", {{0, 6}, {4, 6}, {4, 9}}),
                                zone_at("aside", {{14, 5}, {19, 5}, {19, 7}})};
  plan.home = Home{{-5, -5, 0}, std::nullopt, std::nullopt, {{3.9, 6.5, 20}}};
  std::vector<std::string> said;
  const std::vector<MissionFence> fences = mission_fences(plan, said);
  ASSERT_EQ(fences.size(), 1u);
  EXPECT_THAT(fences[0].name, HasSubstr("aside"));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], HasSubstr("home or a rally point would break: zone 'lawn', zone 'field'"));
}

TEST(Frames, AreEvenAndEndWithTheFlight) {
  const Plan plan = line();
  const std::vector<double> times = frame_times(plan.trajectory, 24, "film");
  ASSERT_EQ(times.size(), 241u);
  EXPECT_DOUBLE_EQ(times.front(), 0);
  EXPECT_NEAR(times.back(), 10, 1e-9);
  for (std::size_t i = 1; i < times.size(); ++i)
    EXPECT_NEAR(times[i] - times[i - 1], 1.0 / 24, 1e-9);
  EXPECT_EQ(frame_times(plan.trajectory, 0.3, "film").size(), 4u) << "0, 3.3, 6.7 and 10 s";
  EXPECT_EQ(frame_times(plan.trajectory, 0.29, "film").size(), 3u) << "the fourth is too late";
  EXPECT_THROW(frame_times({}, 24, "film"), InputError);
  EXPECT_THROW(frame_times(plan.trajectory, 1e6, "film"), InputError);
}

TEST(Frames, ADeviationIsTheLargestAndItsTime) {
  const Plan plan = line();
  const TrackDeviation none =
      deviation_of(plan, 0, 10, 50, [&](double t) { return filming_pose(plan, t); });
  EXPECT_LT(none.distance, 1e-12);
  EXPECT_LT(none.angle, 1e-6);
  const TrackDeviation bumped = deviation_of(plan, 0, 10, 100, [&](double t) {
    Pose pose = filming_pose(plan, t);
    if (std::abs(t - 4) < 1e-6) pose.position += Eigen::Vector3d(0, 0.3, 0.4);
    if (std::abs(t - 7) < 1e-6)
      pose.orientation =
          pose.orientation * Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 3).normalized());
    return pose;
  });
  EXPECT_NEAR(bumped.distance, 0.5, 1e-9);
  EXPECT_NEAR(bumped.distance_time, 4, 1e-9);
  EXPECT_NEAR(bumped.angle, 0.2, 1e-6);
  EXPECT_NEAR(bumped.angle_time, 7, 1e-9);
  EXPECT_THAT(sentence_of(bumped), HasSubstr("at 4 s"));
}

TEST(Lines, ThroughACircleAreOffByTheSagitta) {
  Plan plan = line();
  plan.trajectory.samples.clear();
  constexpr double kRadius = 10;
  for (int i = 0; i <= 2000; ++i) {
    Sample s;
    s.time = 0.01 * i;
    s.position = {kRadius * std::cos(0.1 * s.time), kRadius * std::sin(0.1 * s.time), 5};
    s.velocity = {-std::sin(0.1 * s.time), std::cos(0.1 * s.time), 0};
    plan.trajectory.samples.push_back(s);
  }
  const std::vector<double> times{0, 4, 8, 12, 16, 20};
  const std::vector<Eigen::Vector3d> points = path_at(plan, times, "map");
  ASSERT_EQ(points.size(), times.size());
  const double sagitta = kRadius * (1 - std::cos(0.2));
  const PathDeviation off = deviation_of_path(plan, times, points);
  EXPECT_GT(off.distance, 0.9 * sagitta);
  EXPECT_LT(off.distance, 1.01 * sagitta);
  EXPECT_THROW(path_at(plan, {1}, "map"), InputError);
}

PlannedWaypoint waypoint(double time, const Eigen::Vector3d& position) {
  PlannedWaypoint made;
  made.time = time;
  made.position = position;
  made.speed = 2;
  return made;
}

double nearest_on(const std::vector<PlannedWaypoint>& waypoints, const Eigen::Vector3d& center) {
  double least = 1e9;
  for (std::size_t i = 1; i < waypoints.size(); ++i)
    for (int k = 0; k <= 200; ++k) {
      const double s = k / 200.0;
      const Eigen::Vector3d p = (1 - s) * waypoints[i - 1].position + s * waypoints[i].position;
      least = std::min(least, (p - center).norm());
    }
  return least;
}

TEST(Lines, AreMovedAwayFromWhatThePlanKeepsClearOf) {
  Environment environment;
  environment.margin = 0.5;
  environment.obstacles = {sphere_at("ball", {5, 0.4, 5}, 1)};
  environment = with_shapes(environment);
  std::vector<PlannedWaypoint> straight = {waypoint(0, {0, 0, 5}), waypoint(5, {10, 0, 5})};
  ASSERT_LT(nearest_on(straight, {5, 0.4, 5}), 0.5);
  keep_clear(straight, environment);
  EXPECT_GE(nearest_on(straight, {5, 0.4, 5}), 1.5);
  // What is clear already stays where it is.
  std::vector<PlannedWaypoint> clear = {waypoint(0, {0, -9, 5}), waypoint(5, {10, -9, 5})};
  keep_clear(clear, environment);
  EXPECT_EQ(clear[0].position, Eigen::Vector3d(0, -9, 5));
  EXPECT_EQ(clear[1].position, Eigen::Vector3d(10, -9, 5));
  // Outside of the flight zone is as much in the way.
  Environment park;
  park.margin = 0.5;
  park.obstacles = {flight_zone_at("park", {{-5, -1}, {15, -1}, {15, 20}, {-5, 20}})};
  park = with_shapes(park);
  std::vector<PlannedWaypoint> edge = {waypoint(0, {0, -0.8, 5}), waypoint(5, {10, -0.8, 5})};
  keep_clear(edge, park);
  for (const PlannedWaypoint& at : edge) EXPECT_GE(at.position.y(), -0.5);
}

TEST(Lines, KeepTheDistanceOfAMovingSubject) {
  Environment environment;
  environment.subjects = {{"runner", {0, 5}, {{0, 1, 5}, {10, 1, 5}}, 0, 0, 2.0}};
  std::vector<PlannedWaypoint> beside = {waypoint(0, {0, 0, 5}), waypoint(5, {10, 0, 5})};
  keep_clear(beside, environment);
  for (int k = 0; k <= 100; ++k) {
    const double s = k / 100.0;
    const Eigen::Vector3d p = (1 - s) * beside[0].position + s * beside[1].position;
    EXPECT_GE((p - environment.subjects[0].position(5 * s)).norm(), 2.0) << s;
  }
  // The same lines at another time, when the runner is elsewhere, are free.
  std::vector<PlannedWaypoint> later = {waypoint(50, {0, 0, 5}), waypoint(55, {4, 0, 5})};
  keep_clear(later, environment);
  EXPECT_EQ(later[1].position, Eigen::Vector3d(4, 0, 5));
}

}  // namespace
}  // namespace lapwing
