// SPDX-License-Identifier: Apache-2.0
// Plans as waypoints, the flight that becomes of them, and how it is compared with the plan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/export/flown_comparison.h"
#include "framework/export/waypoint_flight.h"
#include "framework/export/waypoint_timing.h"
#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/interpolate.h"
#include "tests/obstacles.h"
#include "tests/plugins/exporters/planned_camera.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

// A flight along x at 2 m/s, sped up and braked at 1 m/s^2, over 20 m in 12 s; `bow`: m that it
// swings aside.
Plan straight_flight(double bow = 0) {
  Plan plan;
  plan.mission = "line";
  plan.kind = "film";
  plan.vehicle = to_value(filming_drone());
  plan.trajectory.has_gimbal = true;
  for (int i = 0; i <= 120; ++i) {
    const double t = 0.1 * i;
    Sample s;
    s.time = t;
    const double v = std::min({t, 2.0, 12 - t});
    const double x = t < 2 ? t * t / 2 : t < 10 ? 2 + 2 * (t - 2) : 20 - (12 - t) * (12 - t) / 2;
    s.position = {x, bow * std::sin(M_PI * x / 20), 5};
    s.velocity = {v, bow * M_PI / 20 * std::cos(M_PI * x / 20) * v, 0};
    plan.trajectory.samples.push_back(s);
  }
  return plan;
}

TEST(Waypoints, TheFewestStepsAreThoseOfASearchThroughAll) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = 2 + static_cast<std::size_t>(random.uniform(0, 9));
    std::vector<std::vector<bool>> good(count, std::vector<bool>(count));
    for (auto& row : good)
      for (std::size_t j = 0; j < count; ++j) row[j] = random.uniform(0, 1) < 0.4;
    const auto holds = [&](std::size_t i, std::size_t j) { return j == i + 1 || good[i][j]; };
    std::size_t fewest = count;
    for (unsigned set = 0; set < (1u << (count - 2)); ++set) {
      std::size_t at = 0, steps = 0;
      bool all = true;
      for (std::size_t k = 1; k < count; ++k)
        if (k + 1 == count || (set >> (k - 1) & 1u)) {
          all = all && holds(at, k);
          at = k, ++steps;
        }
      if (all) fewest = std::min(fewest, steps);
    }
    const auto found =
        fewest_steps(count, count, holds, [](std::size_t, std::size_t) { return false; });
    EXPECT_EQ(found.size(), fewest + 1);
  }
}

TEST(Waypoints, AStraightFlightIsOneLineAndABowManyMore) {
  EXPECT_EQ(fewest_waypoints(straight_flight(), {0.25, 5, 0.1}, "test").size(), 2u);
  // The time of a flight at even speed is another where it is sped up.
  EXPECT_GT(fewest_waypoints(straight_flight(), {0.25, 0.3, 0.1}, "test").size(), 2u);
  const std::size_t coarse = fewest_waypoints(straight_flight(5), {0.5, 5, 0.1}, "test").size();
  const std::size_t fine = fewest_waypoints(straight_flight(5), {0.05, 5, 0.1}, "test").size();
  EXPECT_GT(coarse, 2u);
  EXPECT_GT(fine, 2 * coarse);
}

TEST(Waypoints, LinesKeepTheTolerance) {
  const Plan plan = planned_camera();
  for (const double across : {0.05, 0.2, 1.0}) {
    auto waypoints = fewest_waypoints(plan, {across, 1, 0.2}, "test");
    time_waypoints(waypoints, filming_drone(), across);
    FlownFile flown = fly_waypoints(flight_along(waypoints), filming_drone(), true);
    flown.finish = plan.trajectory.samples.back().time;
    EXPECT_LE(compare_flown(plan, flown, {}).across, across);
  }
}

TEST(Waypoints, ACameraThatTurnsHasMoreOfThem) {
  Plan plan = straight_flight();
  for (Sample& s : plan.trajectory.samples) s.gimbal_yaw = 0.1 * s.time, s.gimbal_yaw_rate = 0.1;
  const auto waypoints = fewest_waypoints(plan, {0.25, 5, 0.1}, "test");
  EXPECT_GE(waypoints.size(), 7u);  // 1.2 rad in lines of 0.2 rad
  EXPECT_LE(waypoints.size(), 8u);
  EXPECT_NEAR(waypoints[1].camera_yaw, waypoints[1].time * 0.05, 0.02);
  // Who follows a subject that stands still needs none of them.
  plan.environment.subjects.push_back({.name = "tree", .times = {0}, .positions = {{10, 30, 5}}});
  plan.task.framing.push_back({"tree", {0, 12}});
  for (Sample& s : plan.trajectory.samples)
    s.gimbal_yaw = std::atan2(30.0, 10 - s.position.x()), s.gimbal_yaw_rate = 0;
  const auto followed = fewest_waypoints(plan, {0.25, 5, 0.1}, "test");
  ASSERT_EQ(followed.size(), 2u);
  EXPECT_EQ(followed[1].subject, 0);
}

TEST(Waypoints, ARestIsAWaypointTwice) {
  Plan plan = straight_flight();
  Sample still = plan.trajectory.samples.back();
  still.velocity.setZero();
  for (int i = 1; i <= 30; ++i) {
    still.time += 0.1;
    plan.trajectory.samples.push_back(still);
  }
  const auto waypoints = fewest_waypoints(plan, {0.25, 5, 0.1}, "test");
  ASSERT_EQ(waypoints.size(), 3u);
  EXPECT_TRUE(waypoints[2].rests());
  EXPECT_NEAR(waypoints[2].hold, 3, 0.3);
}

TEST(Waypoints, LinesAreKeptClearOfWhatIsRound) {
  // The flight passes a ball at the margin; lines across its bow would be nearer.
  Plan plan = straight_flight(5);
  plan.environment.margin = 1;
  plan.environment.obstacles.push_back(sphere_at("ball", {10, 0, 5}, 4));
  plan.environment = with_shapes(plan.environment);
  const auto nearest = [&](const std::vector<PlannedWaypoint>& waypoints) {
    double least = INFINITY;
    for (std::size_t k = 1; k < waypoints.size(); ++k)
      for (int i = 0; i <= 100; ++i) {
        const Eigen::Vector3d p = waypoints[k - 1].position +
                                  i / 100.0 * (waypoints[k].position - waypoints[k - 1].position);
        least = std::min(least, (p - Eigen::Vector3d(10, 0, 5)).norm() - 4);
      }
    return least;
  };
  EXPECT_GE(nearest(fewest_waypoints(plan, {0.5, 5, 0.5}, "test")), 1);
  plan.environment.margin = 0;
  EXPECT_LT(nearest(fewest_waypoints(plan, {0.5, 5, 0.5}, "test")), 1);
}

TEST(WaypointFlight, ALineIsSpedUpFlownAndBraked) {
  WaypointFlight flight;
  flight.points = {{{0, 0, 5}, 3, 0, 0, {}}, {{30, 0, 5}, 3, 2, 0, {}}};
  Vehicle drone = filming_drone();
  drone.acceleration_across_max = 3;
  const FlownFile flown = fly_waypoints(flight, drone, true);
  // 1 s and 1.5 m each to speed up and to brake, 27 m at 3 m/s.
  EXPECT_NEAR(flown.reached[1], 11, 0.1);
  EXPECT_NEAR(flown.trajectory.samples.back().time, 13, 0.1);
  EXPECT_THROW(fly_waypoints({}, drone, true), InputError);
}

TEST(WaypointFlight, CornersAreCutWithinTheirRadius) {
  WaypointFlight flight;
  flight.points = {{{0, 0, 5}, 5, 0, 1, {}}, {{20, 0, 5}, 5, 0, 1, {}}, {{20, 20, 5}, 5, 0, 1, {}}};
  const FlownFile flown = fly_waypoints(flight, filming_drone(), true);
  double least = INFINITY, fastest = 0;
  const auto& samples = flown.trajectory.samples;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double away = (samples[i].position - Eigen::Vector3d(20, 0, 5)).norm();
    least = std::min(least, away);
    if (away < 0.6)
      fastest = std::max(fastest, (samples[i].position - samples[i - 1].position).norm() /
                                      (samples[i].time - samples[i - 1].time));
  }
  EXPECT_NEAR(least, std::sqrt(0.5) / 2, 0.01);  // half the way to the chord of the cut
  EXPECT_LE(fastest, std::sqrt(3.0) + 0.1);      // 3 m/s^2 on a radius of 1 m
}

TEST(WaypointFlight, CameraAndNoseTurnAsFastAsTheyCan) {
  Vehicle drone = filming_drone();
  drone.yaw_rate_max = 0.5;
  WaypointFlight flight;
  flight.points = {{{0, 0, 5}, 2, 0, 0, 0.0}, {{30, 0, 5}, 2, 0, 0, 1.0}};
  flight.orders.push_back({0, -0.3, 0.2, false, std::nullopt});
  const FlownFile flown = fly_waypoints(flight, drone, true);
  EXPECT_EQ(flown.trajectory.samples[0].gimbal_pitch, -0.3);
  EXPECT_NEAR(sample_at(flown.trajectory, 1).yaw, 0.5, 0.1);
  EXPECT_NEAR(flown.trajectory.samples.back().yaw, 1, 1e-9);
  flight.orders[0].target = Eigen::Vector3d(15, 20, 5);
  const FlownFile followed = fly_waypoints(flight, filming_drone(), true);
  for (const Sample& s : followed.trajectory.samples) {
    const Eigen::Vector3d axis = camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch).forward;
    EXPECT_NEAR(axis.dot((*flight.orders[0].target - s.position).normalized()), 1, 1e-3);
  }
}

TEST(FlownComparison, FindsDistanceTimeAndAngle) {
  const Plan plan = straight_flight();
  FlownFile flown;
  flown.finish = 12;
  flown.trajectory = plan.trajectory;
  flown.trajectory.motion = path_motion();
  const FlownComparison same = compare_flown(plan, flown, {});
  EXPECT_LT(same.across, 1e-3);
  EXPECT_LT(std::abs(same.late), 0.05);
  EXPECT_LT(same.camera, 1e-9);
  EXPECT_TRUE(same.refusals.empty());
  for (Sample& s : flown.trajectory.samples) {
    s.position.y() += 0.2;
    s.gimbal_pitch = 0.1;
    if (s.position.x() > 10) s.time += 2;  // a stop on the way
  }
  const FlownComparison other = compare_flown(plan, flown, {});
  EXPECT_NEAR(other.across, 0.2, 1e-3);
  EXPECT_NEAR(other.late, 2, 0.1);
  EXPECT_NEAR(other.camera, 0.1, 1e-6);
  EXPECT_NEAR(other.longer, 2, 1e-9);
}

TEST(FlownComparison, RefusesWhatThePlanKeepsAndTheFlightDoesNot) {
  Plan plan = straight_flight();
  plan.environment.margin = 0.5;
  plan.environment.obstacles.push_back(sphere_at("tree", {10, 3, 5}, 2));
  FlownFile flown;
  flown.finish = 12;
  flown.trajectory = plan.trajectory;
  flown.trajectory.motion = path_motion();
  EXPECT_TRUE(compare_flown(plan, flown, {}).refusals.empty());
  for (Sample& s : flown.trajectory.samples) s.position.y() += 0.7;
  const FlownComparison nearer = compare_flown(plan, flown, {});
  ASSERT_EQ(nearer.refusals.size(), 1u);
  EXPECT_THAT(nearer.refusals[0], HasSubstr("clearance 0.3 m"));
  EXPECT_THAT(nearer.refusals[0], HasSubstr("tree"));
  for (Sample& s : flown.trajectory.samples) s.position.y() -= 0.7, s.time /= 20;
  EXPECT_THAT(compare_flown(plan, flown, {}).refusals[0], HasSubstr("speed_across"));
}

// The second half of the straight flight, from x = 10 m at 6 s to its end.
FlownFile second_half(const Plan& plan) {
  FlownFile flown;
  flown.start = 6;
  flown.finish = 12;
  flown.trajectory.motion = path_motion();
  flown.trajectory.has_gimbal = true;
  for (const Sample& s : plan.trajectory.samples)
    if (s.time >= 6 - 1e-9) {
      flown.trajectory.samples.push_back(s);
      flown.trajectory.samples.back().time -= 6;
    }
  return flown;
}

Subject bystander_at(std::vector<double> times, std::vector<Eigen::Vector3d> positions) {
  Subject bystander;
  bystander.name = "walker";
  bystander.filmed = false;
  bystander.distance = 3;
  bystander.times = std::move(times);
  bystander.positions = std::move(positions);
  return bystander;
}

TEST(FlownComparison, ALaterPartIsJudgedAgainstWhatMovesAtItsTimes) {
  // Beside the second half until 5 s, and gone when it is flown, from 6 s on.
  Plan gone = straight_flight();
  gone.environment.subjects = {bystander_at({5, 6}, {{14, 1, 5}, {14, 40, 5}})};
  EXPECT_TRUE(compare_flown(gone, second_half(gone), {}).refusals.empty());
  // There only after 7 s: the flight of the second half passes at 8 s, 2 s after its start.
  Plan comes = straight_flight();
  comes.environment.subjects = {bystander_at({6, 7}, {{14, 40, 5}, {14, 1, 5}})};
  const FlownComparison met = compare_flown(comes, second_half(comes), {});
  ASSERT_EQ(met.refusals.size(), 1u);
  EXPECT_THAT(met.refusals[0], HasSubstr("walker"));
  // Obstacles likewise.
  gone.environment.subjects.clear();
  gone.environment.margin = 0.5;
  gone.environment.obstacles = {sphere_at("door", {14, 0, 5}, 1)};
  gone.environment.obstacles[0].times = {5, 6};
  gone.environment.obstacles[0].moves = {{0, 0, 0}, {0, 40, 0}};
  EXPECT_TRUE(compare_flown(gone, second_half(gone), {}).refusals.empty());
  gone.environment.obstacles[0].times = {6.5, 7.5};  // it closes
  gone.environment.obstacles[0].moves = {{0, 40, 0}, {0, 0, 0}};
  EXPECT_FALSE(compare_flown(gone, second_half(gone), {}).refusals.empty());
}

TEST(FlownComparison, TheFramingOfALaterPartIsJudgedAtItsTimes) {
  Plan plan = straight_flight();
  Subject runner;
  runner.name = "runner";
  runner.height = 1.7;
  runner.width = 0.6;
  for (const Sample& s : plan.trajectory.samples) {
    runner.times.push_back(s.time);
    runner.positions.push_back(s.position + Eigen::Vector3d(8, 0, 0));
  }
  plan.environment.subjects = {runner};
  plan.task.framing = {{"runner", {7, 11}}};
  const FlownComparison compared = compare_flown(plan, second_half(plan), {});
  std::string framing;
  for (const std::string& sentence : compared.sentences)
    if (sentence.find("framing") != std::string::npos) framing = sentence;
  EXPECT_THAT(framing, HasSubstr("flown so: framing 1"));
  EXPECT_TRUE(compared.refusals.empty());
}

}  // namespace
}  // namespace lapwing
