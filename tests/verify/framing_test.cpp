// SPDX-License-Identifier: Apache-2.0
// Framing with known answers: a camera that hovers or turns evenly, and what it sees of a subject.
#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_file.h"
#include "framework/map/map_file.h"
#include "framework/plugin/registry.h"
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
    if (check.name != "framing" && check.name != "line_of_sight") ADD_FAILURE() << to_line(check);
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

TEST(Framing, ObstaclesInTheLineOfSightFailTheFilm) {
  Plan plan = hover();
  EXPECT_EQ(share_of(plan, "line_of_sight"), 1);
  plan.environment.obstacles = {sphere_at("balloon", {5, 1.9, 0}, 1.5),
                                box_at("wall", {4, -9, -9}, {4.1, -1.5, 9})};
  EXPECT_EQ(share_of(plan, "line_of_sight"), 1);
  plan.environment.obstacles[0].parameters.set("radius", 2.0);
  EXPECT_EQ(share_of(plan, "line_of_sight"), 0);
  plan.environment.obstacles = {box_at("wall", {4, -9, -9}, {4.1, 0.1, 9})};
  EXPECT_EQ(share_of(plan, "line_of_sight"), 0);
  EXPECT_FALSE(verify(plan).feasible());
  EXPECT_TRUE(check_of(plan, "line_of_sight").required);
  EXPECT_EQ(check_of(plan, "line_of_sight").detail, "subject 'point' behind box 'wall'");
  plan.task.line_of_sight_required = false;
  EXPECT_TRUE(verify(plan).feasible());
  EXPECT_FALSE(check_of(plan, "line_of_sight").pass);
  EXPECT_FALSE(check_of(plan, "line_of_sight").required);
  plan.task.line_of_sight_required = true;
  plan.environment.obstacles[0].opaque = false;
  EXPECT_TRUE(check_of(plan, "line_of_sight").pass) << "airspace hides nothing";
  // A wall that ends beside the way of a walker: seen from the time on when he passes its edge.
  plan.environment.obstacles = {box_at("wall", {4, -9, -9}, {4.1, 0, 9})};
  plan.environment.subjects[0] = {"point", {0, 10}, {{10, -3, 0}, {10, 7, 0}}};
  EXPECT_NEAR(share_of(plan, "line_of_sight"), 0.7, 1e-6);
  // Obstacles that contain the subject are part of it, others behind it do not matter.
  plan.environment.obstacles = {box_at("house", {8, -4, -1}, {12, 8, 3}),
                                box_at("hill", {13, -9, -9}, {99, 9, 9})};
  EXPECT_EQ(share_of(plan, "line_of_sight"), 1);
}

TEST(Framing, ZonesHideWhatIsBehindThem) {
  Plan plan = hover();  // along y = 0, z = 0, from x = 0 to 10
  const auto share = [&](std::vector<Eigen::Vector2d> corners, double floor = -INFINITY,
                         double ceiling = INFINITY) {
    plan.environment.obstacles = {zone_at("block", corners, floor, ceiling)};
    return share_of(plan, "line_of_sight");
  };
  const std::vector<Eigen::Vector2d> across{{4, -2}, {5, -2}, {5, 2}, {4, 2}};
  EXPECT_EQ(share(across), 0);
  EXPECT_EQ(share({across.rbegin(), across.rend()}), 0);
  EXPECT_EQ(share(across, -1, 1), 0);
  EXPECT_EQ(share(across, 0.1, 1), 1) << "its floor is above the line";
  EXPECT_EQ(share(across, -1, -0.1), 1) << "its ceiling is below the line";
  EXPECT_EQ(share(across, 0, 1), 1) << "the line grazes its floor";
  EXPECT_EQ(share({{4, 0}, {5, 0}, {5, 2}, {4, 2}}), 1) << "the line grazes its side";
  EXPECT_EQ(share({{4, -0.001}, {5, -0.001}, {5, 2}, {4, 2}}), 0);
  EXPECT_EQ(share({{4, 0.1}, {5, 0.1}, {5, 2}, {4, 2}}), 1);
  EXPECT_EQ(share({{11, -2}, {12, -2}, {12, 2}, {11, 2}}), 1) << "behind the subject";
  EXPECT_EQ(share({{9, -1}, {11, -1}, {11, 1}, {9, 1}}), 1) << "around the subject";
  EXPECT_EQ(share({{9, -1}, {11, -1}, {11, 1}, {9, 1}}, 0.5, 2), 1) << "above the subject";
  // A fork: the line passes between its prongs, or through the bottom of its notch.
  EXPECT_EQ(share({{2, 3}, {2, 1}, {8, 1}, {8, -1}, {2, -1}, {2, -3}, {9, -3}, {9, 3}}), 0);
  EXPECT_EQ(share({{2, -3}, {8, -3}, {8, 3}, {7, 3}, {7, -1}, {3, -1}, {3, 3}, {2, 3}}), 0);
  EXPECT_EQ(share({{2, -3}, {8, -3}, {8, -1}, {5, -0.2}, {2, -1}}), 1);
}

// What comes in files.
class Sight : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("lapwing_sight_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Of the reference's flight beside the mesh, which lies in the file `wall.ply`.
  double share_past(const MeshBuilder& builder, Plan plan) const {
    write_ply(builder.mesh(), folder_ / "wall.ply");
    plan.environment.obstacles = {
        file_at("wall", "mesh", "wall.ply", sha256(read_file(folder_ / "wall.ply")))};
    const Certificate certificate = verify(plan, folder_);
    const Check& check = *certificate.find("line_of_sight");
    EXPECT_EQ(check.skipped, "") << certificate.find("document")->detail;
    EXPECT_EQ(check.pass, *check.worst > 0.9);
    return *check.worst;
  }
  static MeshBuilder quad(double x, double from, double to) {
    MeshBuilder builder;
    builder.quad({x, from, -3}, {x, to, -3}, {x, to, 3}, {x, from, 3});
    return builder;
  }

  std::filesystem::path folder_;
};

TEST_F(Sight, MeshesHideWhatIsBehindThem) {
  EXPECT_EQ(share_past(quad(5, -2, 2), hover()), 0);
  EXPECT_EQ(share_past(quad(5, 0.01, 2), hover()), 1);
  EXPECT_EQ(share_past(quad(5, -2, -0.01), hover()), 1);
  EXPECT_EQ(share_past(quad(10.5, -2, 2), hover()), 1) << "behind the subject";
  EXPECT_EQ(share_past(quad(-1, -2, 2), hover()), 1) << "behind the camera";
  // A walker passes its edge.
  Plan walking = hover();
  walking.environment.subjects[0] = {"point", {0, 10}, {{10, -3, 0}, {10, 7, 0}}};
  EXPECT_NEAR(share_past(quad(5, -4, 1), walking), 0.5, 1e-6);
  // Both sides of a face hide.
  MeshBuilder turned;
  turned.quad({5, -2, 3}, {5, 2, 3}, {5, 2, -3}, {5, -2, -3});
  EXPECT_EQ(share_past(turned, hover()), 0);
}

TEST_F(Sight, AMeshWithinTheSubjectsOwnSizeIsTheSubject) {
  Plan plan = hover();
  plan.environment.subjects[0].height = 2;
  plan.environment.subjects[0].width = 1;
  MeshBuilder statue;  // 1 m around its middle
  statue.box({9.1, -0.9, -0.9}, {10.9, 0.9, 0.9});
  EXPECT_EQ(share_past(statue, plan), 1);
  plan.environment.subjects[0].height = 1;  // its face is 0.9 m in front of the middle
  EXPECT_EQ(share_past(statue, plan), 0);
  plan.environment.subjects[0].width = 2;
  EXPECT_EQ(share_past(statue, plan), 1);
  EXPECT_EQ(share_past(quad(8.9, -2, 2), plan), 0) << "a wall just before it";
}

TEST_F(Sight, MapsHideWhatIsBehindThem) {
  // Free around the line, but for a post at x = 5 whose side is at y = `side`.
  const auto share = [&](double side, bool unknown, double reach) {
    Value parameters = Value::map();
    parameters.set("resolution", 0.25);
    const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
    const std::shared_ptr<Map> map = registry.create<Map>("brick", parameters, "map");
    std::vector<VoxelLeaf> leaves;
    const auto key = [](int v) { return static_cast<std::uint16_t>(kCenterKey + v); };
    for (int x = -8; x < 4 * reach; ++x)
      for (int y = -8; y < 8; ++y)
        for (int z = -8; z < 8; ++z) {
          const bool post = x == 20 && y >= 4 * side;
          if (post && unknown) continue;
          leaves.push_back({{key(x), key(y), key(z)}, 0, 0, post ? 2.0f : -2.0f});
        }
    map->import(leaves);
    write_map_file(folder_ / "hall.ot", *map);
    Plan plan = hover();
    plan.environment.obstacles = {
        file_at("hall", "map", "hall.ot", sha256(read_file(folder_ / "hall.ot")))};
    const Certificate certificate = verify(plan, folder_);
    EXPECT_EQ(certificate.find("document")->detail, "");
    return *certificate.find("line_of_sight")->worst;
  };
  EXPECT_EQ(share(-0.5, false, 12), 0);
  EXPECT_EQ(share(0.5, false, 12), 1);
  EXPECT_EQ(share(-0.5, true, 12), 0) << "what nobody knows hides as well";
  EXPECT_EQ(share(0.5, true, 12), 1);
  EXPECT_EQ(share(0.5, false, 8), 0) << "the subject stands beyond the map";
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
