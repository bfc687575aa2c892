// SPDX-License-Identifier: Apache-2.0
// Between two ends of a gallery that bends twice (tests/data), by a vehicle of 0.4 m about its
// middle; judged by the verifier alone.
#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_file.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/path/free_space.h"
#include "framework/path/path_planner.h"
#include "framework/plugin/registry.h"
#include "framework/verify/verify.h"
#include "tests/obstacles.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr double kGalleryReach = 0.4;  // m

// Whether the polyline through `points` is clear of the gallery by the reach.
Certificate judged(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points) {
  const fs::path folder =
      fs::temp_directory_path() / ("lapwing_gallery_" + std::to_string(::getpid()));
  write_ply(mesh, folder / "gallery.ply");
  Plan plan;
  plan.mission = "gallery";
  plan.kind = "scan";
  plan.vehicle = to_value(reference_vehicle());
  plan.trajectory.motion = path_motion();
  plan.environment.margin = kGalleryReach;
  plan.environment.obstacles = {
      file_at("gallery", "mesh", "gallery.ply", sha256(read_file(folder / "gallery.ply")))};
  Sample sample;
  for (const Eigen::Vector3d& p : points) {
    if (!plan.trajectory.samples.empty()) sample.time += (p - sample.position).norm();
    sample.position = p;
    plan.trajectory.samples.push_back(sample);
  }
  const Certificate certificate = verify(plan, folder);
  fs::remove_all(folder);
  return certificate;
}

TEST(Gallery, IsFlownThroughAroundItsBends) {
  const TriangleMesh mesh = read_mesh(LAPWING_SOURCE_DIR "/tests/data/meshes/gallery.obj").mesh;
  const auto space = free_space_of(std::make_shared<const MeshScene>(mesh));
  // The gallery is open above: the bounds keep the way between its walls.
  const PathProblem problem{space.get(),
                            {1, 0, 1.3},
                            {51, 3, 1.3},
                            Eigen::Vector3d::Constant(kGalleryReach),
                            {Eigen::Vector3d(-2, -6, 0.6), Eigen::Vector3d(56, 20, 2.2)}};
  const Registry registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  Value parameters = Value::map();
  parameters.set("iterations", 4000);
  const auto planner = registry.create<PathPlanner>("rrt_star", parameters);
  for (const std::uint64_t seed : {1, 2}) {
    const PathResult result = planner->plan(problem, {.seed = seed});
    ASSERT_EQ(result.report.status, PathStatus::found) << seed << result.report.message;
    EXPECT_GT(result.report.length, (problem.goal - problem.start).norm() + 3) << seed;
    EXPECT_LT(result.report.length, 75) << seed;
    EXPECT_TRUE(judged(mesh, result.points).feasible()) << seed;
  }
  EXPECT_FALSE(judged(mesh, {problem.start, problem.goal}).feasible());
}

}  // namespace
}  // namespace lapwing
