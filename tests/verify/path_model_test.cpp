// SPDX-License-Identifier: Apache-2.0
// Plans of the motion model `path`, and meshes to keep away from.
#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_file.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

class PathModel : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_path_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    // A wall from y = -5 to 5 with a window 2 m wide and high.
    MeshBuilder builder;
    builder.box({-0.1, -5, 0}, {0.1, -1, 6});
    builder.box({-0.1, 1, 0}, {0.1, 5, 6});
    builder.box({-0.1, -1, 0}, {0.1, 1, 2});
    builder.box({-0.1, -1, 4}, {0.1, 1, 6});
    write_ply(builder.mesh(), folder_ / "wall.ply");
  }
  void TearDown() override { fs::remove_all(folder_); }

  Obstacle wall() const {
    return file_at("wall", "mesh", "wall.ply", sha256(read_file(folder_ / "wall.ply")));
  }
  // At 1 m/s through the points.
  Plan plan(const std::vector<Vector3d>& points, double speed = 1) const {
    Plan plan;
    plan.mission = "path";
    plan.kind = "scan";
    plan.vehicle = to_value(reference_vehicle());
    plan.trajectory.motion = path_motion();
    Sample sample;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) sample.time += (points[i] - points[i - 1]).norm() / speed;
      sample.position = points[i];
      plan.trajectory.samples.push_back(sample);
    }
    plan.environment.obstacles = {wall()};
    plan.environment.margin = 0.5;
    return plan;
  }
  Certificate judged(const Plan& plan) const { return verify(plan, folder_); }
  static const Check& check(const Certificate& certificate, const std::string& name) {
    for (const Check& c : certificate.checks)
      if (c.name == name) return c;
    throw std::runtime_error("no check " + name);
  }

  fs::path folder_;
};

TEST_F(PathModel, ThroughTheWindowIsClear) {
  const Certificate certificate = judged(plan({{-4, -3, 1}, {-1, 0, 3}, {1, 0, 3}, {4, 2, 5}}));
  for (const Check& c : certificate.checks) {
    EXPECT_TRUE(!c.skipped.empty() || c.pass || !c.required) << c.name << " " << c.detail;
  }
  EXPECT_TRUE(certificate.feasible());
  EXPECT_NEAR(check(certificate, "clearance").worst.value(), 1, 1e-2);
  EXPECT_NE(check(certificate, "thrust_max").skipped, "");
  EXPECT_NE(check(certificate, "defect_position").skipped, "");
}

TEST_F(PathModel, ThroughTheWallIsNot) {
  // Both samples are far from the wall: only what lies between them meets it.
  const Check clearance = check(judged(plan({{-4, 3, 3}, {4, 3, 3}})), "clearance");
  EXPECT_FALSE(clearance.pass);
  EXPECT_NEAR(clearance.worst.value(), 0, 1e-2);
  EXPECT_NEAR(clearance.at, 4, 0.2);
  EXPECT_NE(clearance.detail.find("mesh 'wall'"), std::string::npos);
  // Off the middle of the window by more than there is room for.
  EXPECT_FALSE(judged(plan({{-4, 0.6, 3}, {4, 0.6, 3}})).feasible());
  EXPECT_TRUE(judged(plan({{-4, 0.49, 3}, {4, 0.49, 3}})).feasible());
}

TEST_F(PathModel, SpeedsOfTheLinesCount) {
  const std::vector<Vector3d> away = {{-20, 9, 3}, {-10, 9, 3}, {-10, 9, 8}};
  EXPECT_TRUE(judged(plan(away)).feasible());
  const Certificate fast = judged(plan(away, 11));
  EXPECT_FALSE(check(fast, "speed_across").pass);
  EXPECT_NEAR(check(fast, "speed_across").worst.value(), 11, 1e-9);
  EXPECT_FALSE(check(fast, "climb_speed").pass);
  Plan turning = plan(away);
  turning.trajectory.samples[1].yaw = 20;
  EXPECT_FALSE(check(judged(turning), "yaw_rate").pass);
}

TEST_F(PathModel, KeyframesAreMetOnTheLines) {
  Plan p = plan({{-20, 9, 3}, {-10, 9, 3}});
  p.task.keyframes = {{.time = 5, .position = {-15, 9, 3}}};
  EXPECT_TRUE(judged(p).feasible());
  p.task.keyframes[0].position.z() = 4;
  EXPECT_FALSE(check(judged(p), "keyframe_miss").pass);
}

TEST_F(PathModel, MeshesMustBeWhatThePlanSays) {
  const auto said = [&](const Plan& p) {
    const Check document = check(judged(p), "document");
    EXPECT_FALSE(document.pass);
    return document.detail;
  };
  Plan p = plan({{-20, 9, 3}, {-10, 9, 3}});
  p.environment.obstacles[0].parameters.set("sha256", std::string(64, '0'));
  EXPECT_NE(said(p).find("has changed"), std::string::npos);
  p.environment.obstacles[0].parameters.set("file", "gone.ply");
  EXPECT_NE(said(p).find("gone.ply"), std::string::npos);
  for (const char* file : {"../wall.ply", "/etc/passwd", ""}) {
    p.environment.obstacles[0].parameters.set("file", file);
    EXPECT_NE(said(p).find("below the plan's folder"), std::string::npos) << file;
  }
  write_file_atomically(folder_ / "broken.ply", "ply\nno more");
  p.environment.obstacles[0] = file_at("broken", "mesh", "broken.ply", sha256("ply\nno more"));
  EXPECT_NE(said(p).find("broken.ply"), std::string::npos);
}

TEST_F(PathModel, AFlightUnderForceKeepsAwayFromMeshesToo) {
  Plan reference = reference_plan();
  MeshBuilder builder;
  builder.box({-100, 40, 0}, {100, 41, 30});
  write_ply(builder.mesh(), folder_ / "far.ply");
  reference.environment.obstacles.push_back(
      file_at("far", "mesh", "far.ply", sha256(read_file(folder_ / "far.ply"))));
  EXPECT_TRUE(judged(reference).feasible());
  const Vector3d middle = reference.task.keyframes[1].position;
  MeshBuilder near;
  near.box(middle + Vector3d(-1, -3, -1), middle + Vector3d(1, -0.3, 1));
  write_ply(near.mesh(), folder_ / "far.ply");
  reference.environment.obstacles.back().parameters.set("sha256",
                                                        sha256(read_file(folder_ / "far.ply")));
  const Check clearance = check(judged(reference), "clearance");
  EXPECT_FALSE(clearance.pass);
  EXPECT_NEAR(clearance.worst.value(), 0.3, 1e-2);
}

TEST_F(PathModel, ThePlanCarriesItsMeshes) {
  const Plan p = plan({{-20, 9, 3}, {-10, 9, 3}});
  write_plan(p, folder_ / "plan.json");
  const Plan back = read_plan(folder_ / "plan.json");
  ASSERT_EQ(back.environment.obstacles.size(), 1u);
  EXPECT_EQ(back.environment.obstacles[0].parameters, p.environment.obstacles[0].parameters);
  EXPECT_EQ(back.trajectory.motion.name, "path");
  EXPECT_TRUE(verify(back, folder_).feasible());
  EXPECT_EQ(plan_text(back), plan_text(p));
}

}  // namespace
}  // namespace lapwing
