// SPDX-License-Identifier: Apache-2.0
// What is in the shot when: subjects by the camera's geometry, cuts, lights, gates, images.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/export/shot_list.h"
#include "tests/plugins/exporters/planned_camera.h"

namespace lapwing {
namespace {

// Stands at the origin and turns to the left by 0.3 rad/s for 10 s, the camera level.
Plan turning() {
  Plan plan;
  plan.mission = "pan";
  plan.kind = "film";
  plan.vehicle = to_value(filming_drone());
  plan.trajectory.has_gimbal = true;
  for (int i = 0; i <= 100; ++i) {
    Sample s;
    s.time = 0.1 * i;
    s.position = {0, 0, 5};
    s.yaw = 0.3 * s.time;
    s.yaw_rate = 0.3;
    plan.trajectory.samples.push_back(s);
  }
  return plan;
}

// Half the angle that the camera sees across.
double half_view() {
  const Camera camera = filming_drone().camera;
  return std::atan2(camera.width / 2.0, camera.focal_x);
}

TEST(ShotList, ASubjectIsThereWhileTheCameraSeesIt) {
  Plan plan = turning();
  const double bearing = 1.5;
  plan.environment.subjects = {
      {"tree", {0}, {{20 * std::cos(bearing), 20 * std::sin(bearing), 5}}, 2, 1}};
  const std::vector<Shot> shots = shot_list(plan, "list");
  ASSERT_EQ(shots.size(), 3u);
  EXPECT_TRUE(shots[0].subjects.empty());
  ASSERT_EQ(shots[1].subjects.size(), 1u);
  EXPECT_EQ(shots[1].subjects[0], "tree");
  EXPECT_TRUE(shots[2].subjects.empty());
  EXPECT_NEAR(shots[1].span.start, (bearing - half_view()) / 0.3, 0.06);
  EXPECT_NEAR(shots[1].span.finish, (bearing + half_view()) / 0.3, 0.06);
  EXPECT_DOUBLE_EQ(shots[0].span.start, 0);
  EXPECT_DOUBLE_EQ(shots[2].span.finish, 10);
  for (std::size_t i = 1; i < shots.size(); ++i)
    EXPECT_DOUBLE_EQ(shots[i].span.start, shots[i - 1].span.finish) << "no gaps";
}

TEST(ShotList, BystandersAndFlightsWithoutAGimbalShowNobody) {
  Plan plan = turning();
  Subject bystander{"guard", {0}, {{20, 0, 5}}, 2, 1};
  bystander.filmed = false;
  plan.environment.subjects = {bystander};
  ASSERT_EQ(shot_list(plan, "list").size(), 1u);
  EXPECT_TRUE(shot_list(plan, "list")[0].subjects.empty());
  plan.environment.subjects[0].filmed = true;
  EXPECT_GT(shot_list(plan, "list").size(), 1u);
  plan.trajectory.has_gimbal = false;
  ASSERT_EQ(shot_list(plan, "list").size(), 1u);
}

TEST(ShotList, CutsAndLightsEndExactly) {
  Plan plan = turning();
  plan.cuts = {{2.125, 3.375}};
  plan.lights = {{3, 6.0625}};
  const std::vector<Shot> shots = shot_list(plan, "list");
  std::vector<double> ends;
  for (const Shot& shot : shots) ends.push_back(shot.span.finish);
  EXPECT_EQ(ends, (std::vector<double>{2.125, 3, 3.375, 6.0625, 10}));
  const auto marks = [&](std::size_t i) { return std::pair(shots[i].cut, shots[i].lit); };
  EXPECT_EQ(marks(0), std::pair(false, false));
  EXPECT_EQ(marks(1), std::pair(true, false));
  EXPECT_EQ(marks(2), std::pair(true, true));
  EXPECT_EQ(marks(3), std::pair(false, true));
  EXPECT_EQ(marks(4), std::pair(false, false));
}

TEST(ShotList, GatesAreMomentsInTheirOrder) {
  Plan plan = turning();
  for (Sample& s : plan.trajectory.samples) {
    s.position = {2 * s.time, 0, 5};
    s.velocity = {2, 0, 0};
  }
  GateTask first, second, aside;
  first.position = {5, 0, 5};
  first.radius = 0.5;
  second = first;
  second.name = "north";
  second.position = {15, 0.2, 5};
  aside = first;
  aside.position = {18, 4, 5};
  plan.task.gates = {first, second, aside};
  const std::vector<Moment> moments = moments_of(plan);
  ASSERT_EQ(moments.size(), 2u) << "the last one is missed";
  EXPECT_EQ(moments[0].what, "gate 1");
  EXPECT_NEAR(moments[0].time, 2.5, 0.26);
  EXPECT_EQ(moments[1].what, "gate 2: north");
  EXPECT_NEAR(moments[1].time, 7.5, 0.26);
}

TEST(ShotList, AFlightOfNoLengthIsRefused) {
  Plan plan = turning();
  plan.trajectory.samples.resize(1);
  EXPECT_THROW(shot_list(plan, "list"), InputError);
  plan = turning();
  for (Sample& s : plan.trajectory.samples) s.time = 3;
  EXPECT_THROW(shot_list(plan, "list"), InputError);
}

}  // namespace
}  // namespace lapwing
