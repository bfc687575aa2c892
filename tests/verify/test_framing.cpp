// Framing with known answers: a camera that hovers or turns evenly, and what it sees of a subject.
#include <gtest/gtest.h>

#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

// Ten seconds at the origin, looking along +x, with a point to film 10 m ahead.
Plan hover(double gimbal_yaw_rate = 0, double gimbal_pitch_rate = 0) {
  PlanBuilder builder(true);
  const Drive drive{.gimbal_yaw_rate = gimbal_yaw_rate, .gimbal_pitch_rate = gimbal_pitch_rate};
  for (int i = 0; i < 25; ++i) builder.add(0.4, drive);
  Plan plan = builder.finish(drive);
  plan.trajectory.has_gimbal = true;
  plan.environment.subjects = {{"point", {0}, {{10, 0, 0}}}};
  plan.task.framing = {{"point", {0, 10}}};
  return plan;
}

Check check_of(const Plan& plan, const char* name) {
  const Certificate certificate = verify(plan);
  for (const Check& check : certificate.failures()) {
    if (check.name != "framing") ADD_FAILURE() << to_line(check);
  }
  return *certificate.find(name);
}

double share_of(const Plan& plan, const char* name = "framing") {
  return check_of(plan, name).worst.value();
}

TEST(Framing, SubjectAheadIsSeenAllTheTime) {
  const Check check = check_of(hover(), "framing");
  EXPECT_EQ(*check.worst, 1);
  EXPECT_TRUE(check.pass);
  EXPECT_EQ(check.limit, 0.95);
  EXPECT_EQ(to_line(check), "framing 1 at 0 s, at least 0.95");
}

TEST(Framing, SubjectLeavesTheImageWhenItsPixelDoes) {
  // To the left the image reaches (959.5 + 0.5) / 890 = tan 47.17 degrees, downwards (539.5 + 0.5)
  // / 890 = tan 31.25 degrees; the camera turns away at 0.1 rad/s (left: the point moves right).
  for (const double rate : {0.1, -0.1}) {
    const double across = std::atan(960.0 / 890) / 0.1, up = std::atan(540.0 / 890) / 0.1;
    Plan plan = hover(rate);
    plan.trajectory.samples.back().gimbal_yaw_rate = rate;
    EXPECT_NEAR(share_of(plan), across / 10, 1e-6);
    EXPECT_NEAR(check_of(plan, "framing").at, across, 1e-5);
    EXPECT_EQ(check_of(plan, "framing").detail, "subject 'point'");
    EXPECT_FALSE(check_of(plan, "framing").pass);
    if (rate > 0) continue;  // this gimbal does not look up
    EXPECT_NEAR(share_of(hover(0, rate)), up / 10, 1e-6);
  }
}

TEST(Framing, TheVehiclesYawAndTheGimbalsAddUp) {
  Plan plan = hover();
  for (Sample& s : plan.trajectory.samples) s.yaw = 2.5, s.gimbal_yaw = -0.5;
  plan.environment.subjects[0].positions[0] = {10 * std::cos(2.0), 10 * std::sin(2.0), 0};
  EXPECT_EQ(share_of(plan), 1);
  plan.environment.subjects[0].positions[0] = {10 * std::cos(3.0), 10 * std::sin(3.0), 0};
  EXPECT_EQ(share_of(plan), 0);
  EXPECT_EQ(check_of(plan, "framing").at, 0);
}

TEST(Framing, SubjectBehindIsNotSeen) {
  Plan plan = hover();
  plan.environment.subjects[0].positions[0] = {-10, 0, 0};
  EXPECT_EQ(share_of(plan), 0);
  plan.environment.subjects[0].positions[0] = {0, 0, 0};  // at the camera itself
  EXPECT_EQ(share_of(plan), 0);
}

TEST(Framing, MovingSubjectIsSeenWhileItIsInTheImage) {
  // Crosses the image from the right to the left and beyond: 2 m/s, 10 m ahead.
  Plan plan = hover();
  plan.environment.subjects[0] = {"point", {0, 10}, {{10, -10, 0}, {10, 10, 0}}};
  const double half = 10 * 960.0 / 890;  // m, wider than the track
  ASSERT_GT(half, 10);
  EXPECT_EQ(share_of(plan), 1);
  plan.environment.subjects[0].positions = {{5, -10, 0}, {5, 10, 0}};
  EXPECT_NEAR(share_of(plan), 5 * 960.0 / 890 / 10, 1e-6);
  EXPECT_EQ(check_of(plan, "framing").at, 0);
}

TEST(Framing, OnlyTheTimeThatIsAskedForCounts) {
  Plan plan = hover(0.1);  // lost at 8.23 s
  plan.task.framing = {{"point", {1, 8}}};
  EXPECT_EQ(share_of(plan), 1);
  plan.task.framing = {{"point", {1, 2}}, {"point", {9, 10}}};
  EXPECT_NEAR(share_of(plan), 0.5, 1e-9);
  EXPECT_NEAR(check_of(plan, "framing").at, 9, 1e-9);
  plan.cuts = {{8.9, 10}};
  EXPECT_EQ(share_of(plan), 1);
  plan.cuts = {{1.5, 2.5}};
  EXPECT_NEAR(share_of(plan), 0.5 / 1.5, 1e-9);
  plan.task.framing = {{"point", {0, 4}}, {"point", {2, 5}}};  // their union, once
  plan.cuts = {};
  EXPECT_EQ(share_of(plan), 1);
  plan.cuts = {{0, 10}};
  EXPECT_FALSE(check_of(plan, "framing").skipped.empty());
}

TEST(Framing, EverySubjectOfAMomentMustBeSeen) {
  Plan plan = hover();
  plan.environment.subjects.push_back({"behind", {0}, {{-10, 0, 0}}});
  plan.task.framing = {{"point", {0, 10}}, {"behind", {6, 10}}};
  EXPECT_NEAR(share_of(plan), 0.6, 1e-9);
  EXPECT_EQ(check_of(plan, "framing").detail, "subject 'behind'");
  plan.task.framing = {{"point", {0, 6}}, {"behind", {6, 10}}};
  EXPECT_NEAR(share_of(plan), 0.6, 1e-9);
}

TEST(Framing, ShareIsJudgedAgainstWhatTheTaskAsks) {
  Plan plan = hover(0.1);  // 0.823
  EXPECT_FALSE(verify(plan).feasible());
  plan.task.framing_share = 0.82;
  EXPECT_TRUE(verify(plan).feasible());
}

TEST(Framing, WholeSubjectIsReportedButNotRequired) {
  Plan plan = hover();
  Subject& subject = plan.environment.subjects[0];
  // 10 m ahead the image is 12.13 m high and 21.57 m wide, a little less at the near rim.
  subject.height = 12, subject.width = 0;
  EXPECT_EQ(share_of(plan, "whole_subject"), 1);
  subject.height = 12.3;
  EXPECT_EQ(share_of(plan, "whole_subject"), 0);
  EXPECT_FALSE(check_of(plan, "whole_subject").required);
  EXPECT_TRUE(verify(plan).feasible());
  subject.height = 1, subject.width = 14;  // half angle asin(7 / 10) = 44.4 of 47.2 degrees
  EXPECT_EQ(share_of(plan, "whole_subject"), 1);
  subject.width = 15;  // 48.6 degrees
  EXPECT_EQ(share_of(plan, "whole_subject"), 0);
  EXPECT_EQ(share_of(plan), 1);
}

TEST(Framing, ObstaclesInTheLineOfSightAreReported) {
  Plan plan = hover();
  EXPECT_EQ(share_of(plan, "line_of_sight"), 1);
  plan.environment.spheres = {{"balloon", {5, 1.9, 0}, 1.5}};
  plan.environment.boxes = {{"wall", {4, -9, -9}, {4.1, -1.5, 9}}};
  EXPECT_EQ(share_of(plan, "line_of_sight"), 1);
  plan.environment.spheres[0].radius = 2;
  EXPECT_EQ(share_of(plan, "line_of_sight"), 0);
  plan.environment.spheres.clear();
  plan.environment.boxes[0].upper.y() = 0.1;
  EXPECT_EQ(share_of(plan, "line_of_sight"), 0);
  EXPECT_TRUE(verify(plan).feasible());
  EXPECT_FALSE(check_of(plan, "line_of_sight").required);
  // A wall that ends beside the way of a walker: seen from the time on when he passes its edge.
  plan.environment.boxes[0].upper.y() = 0;
  plan.environment.subjects[0] = {"point", {0, 10}, {{10, -3, 0}, {10, 7, 0}}};
  EXPECT_NEAR(share_of(plan, "line_of_sight"), 0.7, 1e-6);
  // Obstacles that contain the subject are part of it, others behind it do not matter.
  plan.environment.boxes = {{"house", {8, -4, -1}, {12, 8, 3}}, {"hill", {13, -9, -9}, {99, 9, 9}}};
  EXPECT_EQ(share_of(plan, "line_of_sight"), 1);
}

TEST(Framing, WithoutAGimbalOrATaskItIsSkipped) {
  Plan plan = hover();
  plan.trajectory.has_gimbal = false;
  EXPECT_NE(verify(plan).find("framing")->skipped.find("no gimbal"), std::string::npos);
  plan = hover();
  plan.task.framing.clear();
  for (const char* name : {"framing", "whole_subject", "line_of_sight"}) {
    EXPECT_NE(verify(plan).find(name)->skipped.find("no framing"), std::string::npos);
  }
}

TEST(Framing, LimitsHoldInCutsToo) {
  Plan plan = hover(0, -0.2);  // 2 rad down, beyond 90 degrees, from 7.85 s on
  plan.task.framing.clear();
  plan.cuts = {{7, 10}};
  const Certificate certificate = verify(plan);
  ASSERT_EQ(certificate.failures().size(), 1u);
  EXPECT_EQ(certificate.failures()[0].name, "gimbal_pitch");
}

TEST(Framing, LinearInputsAreFollowedBetweenSparseSamples) {
  // One interval: the gimbal turns out and back; neither sample shows it.
  const Drive out{.gimbal_yaw_rate = 1.2}, back{.gimbal_yaw_rate = -1.2};
  Plan plan = PlanBuilder(false).add(4, out, back).finish(back);  // 1.2 rad at 2 s
  plan.trajectory.has_gimbal = true;
  plan.environment.subjects = {{"point", {0}, {{10, 0, 0}}}};
  plan.task.framing = {{"point", {0, 4}}};
  Vehicle v = reference_vehicle();
  v.gimbal->yaw_max = 2;
  plan.vehicle = to_value(v);
  // Out while 1.2 t - 0.3 t^2 > 47.17 degrees.
  const double half = std::sqrt(4 - std::atan(960.0 / 890) / 0.3);
  EXPECT_NEAR(share_of(plan), 1 - 2 * half / 4, 1e-4);
  EXPECT_NEAR(check_of(plan, "framing").at, 2 - half, 1e-3);
}

}  // namespace
}  // namespace lapwing
