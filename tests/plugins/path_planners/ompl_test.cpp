// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "framework/conformance/path_worlds.h"
#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_file.h"
#include "framework/plugin/registry.h"
#include "framework/verify/verify.h"
#include "tests/obstacles.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

std::unique_ptr<PathPlanner> planner(const std::string& name, Value parameters = Value::map()) {
  static const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  return registry.create<PathPlanner>(name, parameters);
}

const PathWorld& world(const std::string& name) {
  static const std::vector<PathWorld> worlds = path_worlds();
  for (const PathWorld& w : worlds)
    if (w.name == name) return w;
  throw Error("no world " + name);
}

PathResult plan(const PathPlanner& planner, const PathWorld& w, const PathRequest& request = {}) {
  PathProblem problem = w.problem;
  problem.space = &w.space;
  return planner.plan(problem, request);
}

TEST(OmplPlanners, MoreWorkGivesShorterPaths) {
  for (const char* name : {"rrt_star", "informed_rrt_star", "bit_star"}) {
    const PathWorld& w = world("two walls to go round");
    const auto few = plan(*planner(name), w, {.seed = 3, .iteration_limit = 600});
    const auto many = plan(*planner(name), w, {.seed = 3, .iteration_limit = 8000});
    ASSERT_EQ(many.report.status, PathStatus::found) << name << ": " << many.report.message;
    EXPECT_LT(many.report.length, 1.1 * w.shortest) << name;
    if (few.report.status == PathStatus::found) {
      EXPECT_LE(many.report.length, few.report.length + 1e-9) << name;
    }
  }
}

TEST(OmplPlanners, TheFirstPathEndsTheSearchOfSome) {
  for (const char* name : {"rrt", "rrt_connect"}) {
    const auto result = plan(*planner(name), world("a wall with a window"), {.seed = 2});
    ASSERT_EQ(result.report.status, PathStatus::found) << name;
    EXPECT_LT(result.report.iterations, 50000) << name;
    EXPECT_FALSE(result.report.straight);
  }
}

TEST(OmplPlanners, SeedsDecide) {
  for (const char* name : {"rrt", "rrt_star", "rrt_connect", "informed_rrt_star", "bit_star"}) {
    const auto made = planner(name);
    const PathWorld& w = world("two walls to go round");
    const auto go = [&](std::uint64_t seed) {
      return plan(*made, w, {.seed = seed, .iteration_limit = 1500}).points;
    };
    const auto one = go(1);
    EXPECT_FALSE(one.empty()) << name;
    EXPECT_EQ(go(1), one) << name;
    EXPECT_NE(go(2), one) << name;
    EXPECT_EQ(go(1), one) << name << " after another seed";
  }
}

TEST(OmplPlanners, SearchesOfSeveralThreadsRepeat) {
  const PathWorld& w = world("two walls to go round");
  const auto alone = plan(*planner("rrt_connect"), w, {.seed = 5}).points;
  std::vector<std::vector<Vector3d>> found(6);
  std::vector<std::thread> threads;
  for (auto& points : found) {
    threads.emplace_back([&] { points = plan(*planner("rrt_connect"), w, {.seed = 5}).points; });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& points : found) EXPECT_EQ(points, alone);
}

TEST(OmplPlanners, FlatBoundsAreAllowed) {
  PathWorld w = world("a pillar");
  w.problem.bounds.min().z() = w.problem.bounds.max().z() = 2;
  const auto result = plan(*planner("rrt_connect"), w);
  ASSERT_EQ(result.report.status, PathStatus::found) << result.report.message;
  for (const Vector3d& p : result.points) EXPECT_EQ(p.z(), 2);
}

TEST(OmplPlanners, ParametersAreChecked) {
  Value bad = Value::map();
  bad.set("iterations", 0);
  EXPECT_THROW(planner("rrt_star", bad), InputError);
  Value unknown = Value::map();
  unknown.set("goal_bias", 0.1);
  EXPECT_THROW(planner("rrt_connect", unknown), InputError) << "it has no goal bias";
  EXPECT_THROW(planner("prm"), InputError);
}

// Between two ends of a gallery of a real mine, some 260 m apart, by a vehicle of 0.4 m about its
// middle; judged by the verifier alone.
TEST(OmplPlanners, FindTheWayThroughAMine) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  namespace fs = std::filesystem;
  constexpr double kReach = 0.4;  // m
  const fs::path file = fs::path(data) / "meshes" / "edgar_mine.dae";
  const TriangleMesh mesh = read_mesh(file, {.up = UpAxis::y}).mesh;
  const auto scene = std::make_shared<const MeshScene>(mesh);
  const auto space = free_space_of(scene);
  const fs::path folder =
      fs::temp_directory_path() / ("lapwing_mine_" + std::to_string(::getpid()));
  write_ply(mesh, folder / "mine.ply");
  Plan plan;
  plan.mission = "mine";
  plan.kind = "scan";
  plan.vehicle = to_value(reference_vehicle());
  plan.trajectory.motion = path_motion();
  plan.environment.margin = kReach;
  plan.environment.obstacles = {
      file_at("mine", "mesh", "mine.ply", sha256(read_file(folder / "mine.ply")))};
  const auto flown_through = [&](const std::vector<Vector3d>& points) {
    Sample sample;
    plan.trajectory.samples.clear();
    for (const Vector3d& p : points) {
      if (!plan.trajectory.samples.empty()) sample.time += (p - sample.position).norm();
      sample.position = p;
      plan.trajectory.samples.push_back(sample);
    }
    return verify(plan, folder);
  };
  // 1.2 m above the floor; the galleries have no roof, so the bounds keep the way between walls.
  const PathProblem problem{space.get(),
                            {27.7, -235.1, 1.34},
                            {244.2, -86.5, 1.34},
                            Vector3d::Constant(kReach),
                            {Vector3d(0, -300, 0.6), Vector3d(287, -60, 2.1)}};
  Value parameters = Value::map();
  parameters.set("iterations", 50000);
  for (const std::uint64_t seed : {1, 2}) {
    const PathResult result = planner("rrt_star", parameters)->plan(problem, {.seed = seed});
    ASSERT_EQ(result.report.status, PathStatus::found) << seed << result.report.message;
    EXPECT_GT(result.points.size(), 5u);
    EXPECT_LT(result.report.length, 300) << seed;
    const Certificate clear = flown_through(result.points);
    EXPECT_TRUE(clear.feasible()) << seed << clear.to_value().find("checks");
  }
  // The straight way is not clear, and the verifier says so.
  EXPECT_FALSE(flown_through({problem.start, problem.goal}).feasible());
  fs::remove_all(folder);
}

}  // namespace
}  // namespace lapwing
