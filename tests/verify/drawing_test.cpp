// SPDX-License-Identifier: Apache-2.0
// Drawings: the light against the strokes, and the strokes against the light.
#include <gtest/gtest.h>

#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

// From rest over 2 m to rest, along x; light on all the way.
Plan line() {
  const Drive forward{{2, 0, 0}}, back{{-2, 0, 0}};
  Plan plan = PlanBuilder(true).add(1, forward).add(1, back).finish();
  plan.task.strokes = {{{0, 0, 0}, {2, 0, 0}}};
  plan.lights = {{0, 2}};
  return plan;
}

double drawing_of(const Plan& plan) {
  return verify(plan).find("drawing")->worst.value_or(1e9);
}

TEST(Drawing, FollowedStrokesAreDrawn) {
  EXPECT_LT(drawing_of(line()), 1e-6);
  EXPECT_TRUE(verify(line()).find("drawing")->pass);
}

TEST(Drawing, DistancesAreMeansOverLength) {
  Plan plan = line();
  for (Eigen::Vector3d& p : plan.task.strokes[0]) p.y() += 0.04;
  EXPECT_NEAR(drawing_of(plan), 0.04, 1e-6);
  EXPECT_TRUE(verify(plan).find("drawing")->pass);
  for (Eigen::Vector3d& p : plan.task.strokes[0]) p.y() += 0.02;
  EXPECT_FALSE(verify(plan).find("drawing")->pass);
  EXPECT_FALSE(verify(plan).feasible());
}

TEST(Drawing, WhatIsNotLitIsNotDrawn) {
  Plan plan = line();
  plan.lights = {};
  EXPECT_FALSE(verify(plan).find("drawing")->pass);
  plan.lights = {{0, 1}};  // the second half is missing: a metre, at 0.5 m on the mean, of two
  EXPECT_NEAR(drawing_of(plan), 0.25, 0.01);
  EXPECT_EQ(verify(plan).find("drawing")->detail, "stroke 1 from the light");
}

TEST(Drawing, LightBesideTheStrokesCounts) {
  Plan plan = line();
  plan.task.strokes = {{{0, 0, 0}, {1, 0, 0}}};
  EXPECT_NEAR(drawing_of(plan), 0.25, 0.01);
  EXPECT_EQ(verify(plan).find("drawing")->detail, "light 1 from the strokes");
}

// Of many strokes each counts: one that is not lit is not lost in the mean of the others.
TEST(Drawing, NoStrokeIsLostAmongOthers) {
  Plan plan = line();
  for (int i = 0; i < 50; ++i) plan.task.strokes.push_back({{0, 0, 0}, {2, 0, 0}});
  EXPECT_TRUE(verify(plan).find("drawing")->pass);
  plan.task.strokes.push_back({{0, 0, 1}, {0, 0, 1.1}});
  EXPECT_NEAR(drawing_of(plan), 1.05, 0.01);
  EXPECT_EQ(verify(plan).find("drawing")->detail, "stroke 52 from the light");
}

TEST(Drawing, TheFlightIsJudgedToo) {
  Plan plan = line();
  plan.task.drawing_tolerance = 0.001;
  EXPECT_TRUE(verify(plan).find("drawing_flown")->pass);
  Vehicle slow = vehicle_from_value(plan.vehicle);
  slow.rotors.lag = 0.25;
  plan.vehicle = to_value(slow);
  EXPECT_TRUE(verify(plan).find("drawing")->pass);
  EXPECT_FALSE(verify(plan).find("drawing_flown")->pass);
}

TEST(Drawing, ContradictionsAreRefused) {
  const auto document = [](auto change) {
    Plan plan = line();
    change(plan);
    return verify(plan).find("document")->pass;
  };
  EXPECT_TRUE(document([](Plan&) {}));
  EXPECT_FALSE(document([](Plan& p) { p.lights = {{1, 3}}; }));
  EXPECT_FALSE(document([](Plan& p) { p.lights = {{0, 1}, {0.5, 2}}; }));
  EXPECT_FALSE(document([](Plan& p) { p.task.strokes.push_back({{1, 1, 1}}); }));
  EXPECT_FALSE(document([](Plan& p) { p.task.strokes[0][0].x() = std::nan(""); }));
  EXPECT_FALSE(document([](Plan& p) { p.task.drawing_tolerance = 0; }));
  EXPECT_FALSE(document([](Plan& p) { p.task.drawing_view.setZero(); }));
}

}  // namespace
}  // namespace lapwing
