// SPDX-License-Identifier: Apache-2.0
// Known answers: plans whose worst values can be written down.
#include <gtest/gtest.h>

#include "framework/core/json.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

Check check_of(const Certificate& certificate, const char* name) {
  const Check* check = certificate.find(name);
  if (!check) throw Error(std::string("no check ") + name);
  return *check;
}

void set_limit(Plan& plan, const char* name, double value) {
  plan.vehicle.find("limits")->set(name, value);
}

// 3 m/s^2 for 2 s, then -3 m/s^2 for 2 s: 12 m, peak 6 m/s.
Plan bang_bang() {
  const Drive forward{{3, 0, 0}}, back{{-3, 0, 0}};
  return PlanBuilder(true).add(2, forward).add(2, back).finish();
}

TEST(Verify, BangBangHasItsKnownFigures) {
  const Plan plan = bang_bang();
  EXPECT_NEAR(plan.trajectory.samples.back().position.x(), 12, 1e-12);
  const Certificate c = verify(plan);
  EXPECT_TRUE(c.feasible());
  EXPECT_NEAR(*check_of(c, "speed_across").worst, 6, 1e-9);
  EXPECT_NEAR(check_of(c, "speed_across").at, 2, 1e-9);
  EXPECT_NEAR(*check_of(c, "acceleration_across").worst, 3, 1e-12);
  EXPECT_NEAR(*check_of(c, "thrust_max").worst, 1.5 * std::hypot(3, kGravity), 1e-9);
  EXPECT_NEAR(*check_of(c, "flight_time").worst, 4, 1e-12);
  EXPECT_LT(*check_of(c, "defect_position").worst, 1e-12);
}

// Two samples, both at rest; in between the speed rises to 4 m/s and falls again.
Plan hidden_peak() {
  const Drive forward{{4, 0, 0}}, back{{-4, 0, 0}};
  return PlanBuilder(false).add(4, forward, back).finish(back);
}

TEST(Verify, SpeedPeakBetweenSparseSamplesIsFound) {
  Plan plan = hidden_peak();
  ASSERT_EQ(plan.trajectory.samples.size(), 2u);
  EXPECT_TRUE(verify(plan).feasible());
  EXPECT_NEAR(*check_of(verify(plan), "speed_across").worst, 4, 1e-4);
  EXPECT_NEAR(check_of(verify(plan), "speed_across").at, 2, 0.05);
  set_limit(plan, "speed_across", 3.99);
  EXPECT_FALSE(check_of(verify(plan), "speed_across").pass);
  EXPECT_FALSE(verify(plan).feasible());
}

TEST(Verify, YawAndGimbalPeaksBetweenSparseSamplesAreFound) {
  const Drive one{{0, 0, 0}, 0.5, 0.4, 0}, other{{0, 0, 0}, -0.5, -0.4, 0};
  Plan plan = PlanBuilder(false).add(4, one, other).finish(other);
  plan.trajectory.has_gimbal = true;
  const Certificate c = verify(plan);
  EXPECT_TRUE(c.feasible());
  EXPECT_NEAR(*check_of(c, "yaw_rate").worst, 0.5, 1e-4);
  EXPECT_NEAR(*check_of(c, "gimbal_yaw").worst, 0.4, 1e-4);
}

TEST(Verify, ThrustDipBetweenSparseSamplesIsFound) {
  // The force swings from one side to the other: 11.3 N at both ends, 8 N in the middle.
  const double up = 8 / 1.5 - kGravity;
  const Drive left{{8 / 1.5, 0, up}}, right{{-8 / 1.5, 0, up}};
  const Plan plan = PlanBuilder(false).add(1, left, right).finish(right);
  EXPECT_NEAR(*check_of(verify(plan), "thrust_min").worst, 8, 1e-9);
}

TEST(Verify, HoveringIsSafeButMissesTheKeyframes) {
  PlanBuilder builder(true);
  for (int i = 0; i < 80; ++i) builder.add(0.1, {});
  Plan plan = builder.finish();
  plan.task.keyframes = {{.time = 0}, {.time = 8, .position = {3, 4, 0}}};
  const Certificate c = verify(plan);
  EXPECT_FALSE(c.feasible());
  ASSERT_EQ(c.failures().size(), 1u);
  EXPECT_EQ(to_line(c.failures()[0]), "keyframe_miss 5 m exceeds 0.5 m at 8 s (keyframe 2)");
}

TEST(Verify, KeyframeMayBeMetWithinItsTimeTolerance) {
  Plan plan = bang_bang();  // 6 m/s at 2 s, where x = 6
  plan.task.keyframes = {{.time = 2, .position = {6.59, 0, 0}, .tolerance = 0.01}};
  EXPECT_TRUE(verify(plan).feasible());
  plan.task.keyframes[0].time_tolerance = 0.05;
  EXPECT_FALSE(verify(plan).feasible());
  plan.task.keyframes[0].time_tolerance = 0;
  EXPECT_NEAR(*check_of(verify(plan), "keyframe_miss").worst, 0.59, 1e-3);
}

TEST(Verify, WorstKeyframeIsJudgedAgainstItsOwnTolerance) {
  Plan plan = bang_bang();
  plan.task.keyframes = {{.time = 0, .position = {0, 0.4, 0}, .tolerance = 0.5},
                         {.time = 4, .position = {12, 0.2, 0}, .tolerance = 0.1}};
  const Check check = check_of(verify(plan), "keyframe_miss");
  EXPECT_NEAR(*check.worst, 0.2, 1e-6);
  EXPECT_EQ(check.limit, 0.1);
  EXPECT_EQ(check.detail, "keyframe 2");
}

TEST(Verify, KeyframeYawCountsOnTheCircle) {
  Plan plan = reference_plan();
  *plan.task.keyframes[2].yaw += 4 * std::numbers::pi;
  EXPECT_TRUE(verify(plan).feasible());
  *plan.task.keyframes[2].yaw += std::numbers::pi;
  EXPECT_NEAR(*check_of(verify(plan), "keyframe_yaw").worst, std::numbers::pi, 1e-4);
}

// x = 5 t, y = t^2 - 2 t over 2 s: both samples lie on y = 0, the path dips to y = -1 at t = 1.
Plan dip() {
  Sample start;
  start.velocity = {5, -2, 0};
  return PlanBuilder(true, start).add(2, {{0, 2, 0}}).finish({{0, 2, 0}});
}

TEST(Verify, ObstacleGrazedBetweenSamplesIsFound) {
  Plan plan = dip();
  plan.environment.obstacles = {sphere_at("pole", {5, -3, 0}, 0.5)};
  const Check check = check_of(verify(plan), "clearance");
  EXPECT_LE(*check.worst, 1.5);
  EXPECT_NEAR(*check.worst, 1.5, 3e-4);
  EXPECT_NEAR(check.at, 1, 0.05);
  EXPECT_EQ(check.detail, "sphere 'pole'");
  plan.environment.margin = 1.502;
  EXPECT_FALSE(verify(plan).feasible());
  plan.environment.margin = 1.49;
  EXPECT_TRUE(verify(plan).feasible());
}

TEST(Verify, DistanceFromSubjectsHasKnownValues) {
  Plan plan = dip();  // at (5, -1, 0) after 1 s
  EXPECT_NE(check_of(verify(plan), "subject_distance").skipped, "");
  Subject still{.name = "still", .times = {0}, .positions = {{5, -3, 0}}};
  Subject runner{
      .name = "runner", .times = {0, 1, 2}, .positions = {{5, -9, 0}, {5, -2, 0}, {5, -9, 0}}};
  plan.environment.subjects = {still, runner};
  EXPECT_NE(check_of(verify(plan), "subject_distance").skipped, "") << "none asks";
  plan.environment.subjects[0].distance = 1.9;
  Check check = check_of(verify(plan), "subject_distance");
  EXPECT_TRUE(check.pass);
  EXPECT_LE(*check.worst, 2);
  EXPECT_NEAR(*check.worst, 2, 3e-4);
  EXPECT_EQ(check.detail, "subject 'still'");
  plan.environment.subjects[1].distance = 1.5;  // it comes within 1 m at the corner of its track
  check = check_of(verify(plan), "subject_distance");
  EXPECT_FALSE(check.pass);
  EXPECT_FALSE(verify(plan).feasible());
  EXPECT_LE(*check.worst, 1);
  EXPECT_NEAR(*check.worst, 1, 3e-4);
  EXPECT_NEAR(check.at, 1, 1e-6);
  EXPECT_EQ(check.detail, "subject 'runner'; subject 'still' 2 m at 1 s, requires 1.9 m");
  EXPECT_EQ(check.limit, 1.5);
  plan.environment.subjects[0].distance = -1;
  EXPECT_FALSE(check_of(verify(plan), "document").pass);
}

TEST(Verify, ClearanceOfBoxesHasKnownValues) {
  Plan plan = dip();
  const auto clearance = [&](const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
    plan.environment.obstacles = {box_at("", lower, upper)};
    return *check_of(verify(plan), "clearance").worst;
  };
  EXPECT_NEAR(clearance({4, -3, -1}, {6, -2, 1}), 1, 3e-4);         // its upper face below the dip
  EXPECT_NEAR(clearance({4, -3, 3}, {6, -1, 4}), 3, 3e-4);          // an edge above the dip
  EXPECT_NEAR(clearance({-4, -9, -9}, {-3, 9, 9}), 3, 3e-4);        // behind the start
  EXPECT_NEAR(clearance({4, -1.4, -9}, {6, -0.8, 9}), -0.2, 5e-3);  // the dip enters 0.2 m
  EXPECT_EQ(check_of(verify(plan), "clearance").detail, "box 1");
  EXPECT_FALSE(verify(plan).feasible());
}

TEST(Verify, ClearanceOfZonesHasKnownValues) {
  Plan plan = dip();  // along x = 0 to 10 at z = 0, down to y = -1 at x = 5
  const auto clearance = [&](const Obstacle& zone) {
    plan.environment.obstacles = {zone};
    return *check_of(verify(plan), "clearance").worst;
  };
  const std::vector<Eigen::Vector2d> square{{4, -3}, {6, -3}, {6, -2}, {4, -2}};
  EXPECT_NEAR(clearance(zone_at("", square)), 1, 6e-4);
  EXPECT_NEAR(clearance(zone_at("", {square.rbegin(), square.rend()})), 1, 6e-4);
  const std::vector<Eigen::Vector2d> around{{-1, -3}, {11, -3}, {11, 3}, {-1, 3}};
  EXPECT_NEAR(clearance(zone_at("", around, 2, INFINITY)), 2, 6e-4);    // below its floor
  EXPECT_NEAR(clearance(zone_at("", around, -INFINITY, -3)), 3, 6e-4);  // above its ceiling
  EXPECT_NEAR(clearance(zone_at("", around, -0.25, 4)), -0.25, 6e-4);   // just above its floor
  // Deepest where the walls at x = -1 and y = -3 are equally far: 5 t + 1 = 3 + t^2 - 2 t.
  const double deepest = 5 * (7 - std::sqrt(41)) / 2 + 1;
  EXPECT_NEAR(clearance(zone_at("", around)), -deepest, 6e-4);
  EXPECT_NEAR(clearance(zone_at("", square, 3, 4)), std::sqrt(10),
              6e-4);  // an edge above, 1 m aside
  // A fork: the dip passes between its prongs, 1.5 m above the bottom of the notch.
  const std::vector<Eigen::Vector2d> fork{{2, -4},   {8, -4},   {8, 2}, {7, 2},
                                          {7, -2.5}, {3, -2.5}, {3, 2}, {2, 2}};
  EXPECT_LT(clearance(zone_at("", fork)), 0);  // the prongs stand in the way
  EXPECT_NEAR(clearance(zone_at("", fork, 1, 2)), 1, 6e-4);
  const std::vector<Eigen::Vector2d> notch{{-3, -4},   {13, -4},   {13, 2}, {12, 2},
                                           {12, -2.5}, {-2, -2.5}, {-2, 2}, {-3, 2}};
  EXPECT_NEAR(clearance(zone_at("", notch)), 1.5, 6e-4);
  EXPECT_EQ(check_of(verify(plan), "clearance").detail, "zone 1");
  EXPECT_NEAR(check_of(verify(plan), "clearance").at, 1, 0.05);
}

TEST(Verify, ClearanceOfZonesIsNeverOverestimated) {
  // Stars of ten corners around the dip, against a fine walk along its known path.
  for (int shape = 0; shape < 40; ++shape) {
    Plan plan = dip();
    std::vector<Eigen::Vector2d> corners;
    for (int i = 0; i < 10; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.05 * shape) / 10;
      const double radius = i % 2 ? 0.7 : 1.4 + 0.2 * std::sin(7 * i + shape);
      corners.emplace_back(5 + 0.15 * (shape % 7) + radius * std::cos(angle),
                           -3.5 + 0.1 * shape + radius * std::sin(angle));
    }
    plan.environment.obstacles = {zone_at("star", corners, -1.0 - 0.1 * shape, 0.03 * shape)};
    // By the plugin's code, which is not the verifier's.
    const Environment around = with_shapes(plan.environment);
    const Shape& zone = *around.obstacles[0].shape;
    double true_clearance = INFINITY;
    for (int i = 0; i <= 40000; ++i) {
      const double t = 2.0 * i / 40000;
      true_clearance = std::min(true_clearance, zone.distance({5 * t, t * t - 2 * t, 0}, nullptr));
    }
    const double found = *check_of(verify(plan), "clearance").worst;
    EXPECT_LE(found, true_clearance + 1e-9) << shape;
    EXPECT_NEAR(found, true_clearance, 1e-3) << shape;
  }
}

TEST(Verify, FastPassThroughAThinWallBetweenSamplesIsFound) {
  Plan plan = hidden_peak();  // 10.67 m between two samples
  plan.environment.obstacles = {box_at("wall", {5, -1, -1}, {5.001, 1, 1})};
  EXPECT_LT(*check_of(verify(plan), "clearance").worst, 0);
}

TEST(Verify, ManyTinyDefectsMayNotTeleport) {
  // Samples a millisecond apart that hover by their inputs and advance 0.9 mm each.
  PlanBuilder builder(true);
  for (int i = 0; i < 2000; ++i) builder.add(0.001, {});
  Plan plan = builder.finish();
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i) {
    plan.trajectory.samples[i].position.x() += 0.0009 * static_cast<double>(i);
  }
  const Certificate c = verify(plan);
  EXPECT_TRUE(check_of(c, "defect_position").pass);
  EXPECT_NEAR(*check_of(c, "drift").worst, 90, 1);
  EXPECT_FALSE(c.feasible());
}

TEST(Verify, TheLastSampleIsJudgedToo) {
  Plan plan = reference_plan();
  plan.trajectory.samples.back().columns.set("force", Eigen::Vector3d(0, 0, 0));
  plan.trajectory.samples.back().acceleration = {0, 0, -kGravity};
  EXPECT_FALSE(check_of(verify(plan), "thrust_min").pass);
}

TEST(Verify, LimitsHaveATenThousandthToSpare) {
  Plan plan = bang_bang();
  set_limit(plan, "speed_across", 6 / 1.00009);
  EXPECT_TRUE(verify(plan).feasible());
  set_limit(plan, "speed_across", 6 / 1.0002);
  EXPECT_FALSE(verify(plan).feasible());
}

TEST(Verify, FailureReadsAsOneLine) {
  Plan plan = bang_bang();
  set_limit(plan, "speed_across", 5);
  set_limit(plan, "yaw_rate", radians(90));
  EXPECT_EQ(to_line(verify(plan).failures().at(0)), "speed_across 6 m/s exceeds 5 m/s at 2 s");
  plan = reference_plan();
  plan.vehicle.find("gimbal")->set("pitch_min", radians(-30));
  const std::string line = to_line(verify(plan).failures().at(0));
  EXPECT_EQ(line, "gimbal_pitch -40.11 deg falls below -30 deg at 8 s");
}

TEST(Verify, CertificateInsideThePlanIsNotLookedAt) {
  Plan plan = bang_bang();
  plan.certificate = verify(plan).to_value();
  set_limit(plan, "speed_across", 5);
  EXPECT_FALSE(verify(plan).feasible());
}

TEST(Verify, SameVerdictFromTheWrittenFile) {
  const Plan plan = reference_plan();
  const Plan reread = plan_from_value(from_json(plan_text(plan), "plan.json"));
  EXPECT_EQ(verify(plan).to_value(), verify(reread).to_value());
}

TEST(Verify, WhatDoesNotApplyIsSkippedWithAReason) {
  const Certificate c = verify(bang_bang());
  for (const char* name :
       {"clearance", "budget", "keyframe_miss", "framing", "gimbal_pitch", "coverage",
        "subject_distance", "rotor_thrust", "whole_subject", "line_of_sight"}) {
    EXPECT_FALSE(check_of(c, name).skipped.empty()) << name;
  }
}

}  // namespace
}  // namespace lapwing
