// SPDX-License-Identifier: Apache-2.0
// A shape that the verifier does not know: its distances, and plans that are judged by triangles.
#include <gtest/gtest.h>

#include "framework/core/json.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

Obstacle silo(const Vector3d& base, double radius, double height) {
  Environment one;
  one.obstacles = {obstacle_at(
      "silo", "cylinder", {{"base", place_value(base)}, {"radius", radius}, {"height", height}})};
  return with_shapes(one).obstacles[0];
}

TEST(Cylinder, DistancesAreKnown) {
  const Obstacle tower = silo({1, 2, 3}, 2, 5);
  const auto distance = [&](const Vector3d& p) { return tower.shape->distance(p, nullptr); };
  EXPECT_DOUBLE_EQ(distance({6, 2, 4}), 3);   // beside its wall
  EXPECT_DOUBLE_EQ(distance({1, 2, 10}), 2);  // above it
  EXPECT_DOUBLE_EQ(distance({1, 7, -1}), 5);  // off its lower rim: 3 aside, 4 below
  EXPECT_DOUBLE_EQ(distance({1, 3.5, 5}), -0.5);
  EXPECT_DOUBLE_EQ(distance({1, 2, 3.25}), -0.25);
}

// The reference plan with a silo beside its middle keyframe, recorded as a mission records it.
Plan beside_a_silo(double gap) {
  Plan plan = reference_plan();
  const Vector3d middle = plan.task.keyframes[1].position;
  Obstacle obstacle = silo(middle + Vector3d(0, 2 + gap, -4), 2, 8);
  obstacle.tolerance = 5e-3;
  obstacle.triangles = std::make_shared<TriangleMesh>(obstacle.shape->triangles(5e-3, {}));
  plan.environment.obstacles = {obstacle};
  return plan;
}

TEST(Cylinder, IsJudgedByItsTriangles) {
  const Certificate near = verify(beside_a_silo(0.3));
  const Check* clearance = near.find("clearance");
  EXPECT_FALSE(clearance->pass);
  EXPECT_EQ(clearance->detail, "cylinder 'silo', judged by its triangles");
  EXPECT_LE(*clearance->worst, 0.3);
  const Certificate far = verify(beside_a_silo(2));
  EXPECT_TRUE(far.find("clearance")->pass) << far.find("clearance")->detail;
  // Through it, where no triangle is near.
  EXPECT_LT(*verify(beside_a_silo(-2)).find("clearance")->worst, -1);
}

TEST(Cylinder, TheDocumentKeepsItAndHolesAreFound) {
  Plan plan = beside_a_silo(2);
  const Plan back = plan_from_value(from_json(plan_text(plan), "plan.json"));
  EXPECT_EQ(*verify(back).find("clearance")->worst, *verify(plan).find("clearance")->worst);
  auto open = std::make_shared<TriangleMesh>(*plan.environment.obstacles[0].triangles);
  open->triangles.pop_back();
  plan.environment.obstacles[0].triangles = open;
  EXPECT_NE(verify(plan).find("document")->detail.find("do not bound a solid: 3 edges"),
            std::string::npos);
  plan.environment.obstacles[0].triangles = nullptr;
  EXPECT_NE(verify(plan).find("document")->detail.find("records no triangles"), std::string::npos);
}

}  // namespace
}  // namespace lapwing
