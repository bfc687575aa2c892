// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/conformance/path_worlds.h"
#include "framework/core/error.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/path/path_planner.h"
#include "framework/plugin/registry.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::shared_ptr<const MeshScene> wall_with_window() {
  MeshBuilder builder;
  builder.box({-0.2, -6, 0}, {0.2, 2, 4});
  builder.box({-0.2, 4, 0}, {0.2, 6, 4});
  return std::make_shared<const MeshScene>(builder.take());
}

// A planner whose searches return what it is told.
class Told final : public PathPlanner {
 public:
  mutable int searches = 0;
  std::vector<Vector3d> points;
  PathStatus status = PathStatus::found;
  bool throws = false;

 protected:
  Search search(const PathProblem&, const PathRequest&) const override {
    ++searches;
    if (throws) throw std::runtime_error("out of luck");
    return {status, "as told", 7, points};
  }
};

PathProblem through(const FreeSpace& space) {
  return {&space, {-5, 0, 2}, {5, 0, 2}, {0.3, 0.3, 0.2}, {Vector3d(-6, -6, 0), Vector3d(6, 6, 4)}};
}

TEST(FreeSpaces, OfMeshesAnswerAllQuestions) {
  const auto space = free_space_of(wall_with_window());
  EXPECT_TRUE(space->point_free({3, 0, 2}));
  EXPECT_FALSE(space->point_free({0.2, 0, 2}));
  EXPECT_TRUE(space->segment_free({-3, 3, 2}, {3, 3, 2}));
  EXPECT_FALSE(space->segment_free({-3, 0, 2}, {3, 0, 2}));
  EXPECT_TRUE(space->swept_box_free({-3, 3, 2}, {3, 3, 2}, {1, 1, 1}));
  EXPECT_FALSE(space->swept_box_free({-3, 3.1, 2}, {3, 3.1, 2}, {1, 1, 1}));
  EXPECT_NEAR(space->bounds().max().y(), 6, 1e-9);
  EXPECT_THROW(free_space_of(std::shared_ptr<const MeshScene>()), Error);
  EXPECT_THROW(free_space_of(std::shared_ptr<const Map>()), Error);
}

TEST(FreeSpaces, OfMapsBlockWhatIsUnknown) {
  const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  Value parameters = Value::map();
  parameters.set("resolution", 0.5);
  std::shared_ptr<Map> map = registry.create<Map>("brick", parameters);
  // A free hall of 10 x 4 x 4 m with an occupied voxel in its middle.
  std::vector<VoxelLeaf> leaves;
  const auto key = [&](double x, double y, double z) { return map->grid().key({x, y, z}); };
  for (double x = 0.25; x < 10; x += 0.5) {
    for (double y = 0.25; y < 4; y += 0.5) {
      for (double z = 0.25; z < 4; z += 0.5) {
        const bool middle = x == 5.25 && y == 2.25 && z == 2.25;
        leaves.push_back({key(x, y, z), 0, 0, middle ? 3.f : -2.f});
      }
    }
  }
  map->import(leaves);
  const auto space = free_space_of(std::shared_ptr<const Map>(map));
  EXPECT_TRUE(space->point_free({1, 1, 1}));
  EXPECT_FALSE(space->point_free({5.25, 2.25, 2.25}));
  EXPECT_FALSE(space->point_free({-1, 1, 1})) << "unknown";
  EXPECT_TRUE(space->segment_free({1, 1, 1}, {9, 1, 1}));
  EXPECT_FALSE(space->segment_free({1, 2.25, 2.25}, {9, 2.25, 2.25}));
  EXPECT_TRUE(space->swept_box_free({1, 1, 2}, {9, 1, 2}, {1, 1, 1}));
  EXPECT_FALSE(space->swept_box_free({1, 1.1, 2}, {9, 1.1, 2}, {1, 1, 1}));
  EXPECT_FALSE(space->swept_box_free({0.9, 1, 2}, {2, 1, 2}, {1, 1, 1})) << "reaches the unknown";
  EXPECT_LT((space->bounds().min() - Vector3d(0, 0, 0)).norm(), 1e-9);
  EXPECT_LT((space->bounds().max() - Vector3d(10, 4, 4)).norm(), 1e-9);
  const auto both = free_in_both(free_space_of(std::shared_ptr<const Map>(map)),
                                 free_space_of(wall_with_window()));
  EXPECT_FALSE(both->point_free({5.25, 2.25, 2.25}));
  EXPECT_TRUE(both->segment_free({1, 1, 1}, {9, 1, 1}));
  EXPECT_FALSE(both->segment_free({0.1, 1, 1}, {9, 1, 1})) << "the mesh's wall";
}

TEST(PathPlanners, TryTheStraightLineFirst) {
  const auto space = free_space_of(wall_with_window());
  PathProblem problem = through(*space);
  Told planner;
  problem.start.y() = problem.goal.y() = 3;
  const PathResult straight = planner.plan(problem);
  EXPECT_EQ(straight.report.status, PathStatus::found);
  EXPECT_TRUE(straight.report.straight);
  EXPECT_EQ(straight.points.size(), 2u);
  EXPECT_EQ(straight.report.length, 10);
  EXPECT_EQ(planner.searches, 0);
}

TEST(PathPlanners, AreNotTrusted) {
  const auto space = free_space_of(wall_with_window());
  const PathProblem problem = through(*space);
  Told planner;
  planner.points = {problem.start, {-1, 3, 2}, {1, 3, 2}, problem.goal};
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::found);
  planner.points = {problem.start, {1, 3, 2}, problem.goal};
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::failed) << "through the jamb";
  EXPECT_TRUE(planner.plan(problem).points.empty());
  planner.points = {problem.start, {-1, 3, 2}, {1, 3, 2}};
  EXPECT_NE(planner.plan(problem).report.message.find("join"), std::string::npos);
  planner.points = {problem.start, {-1, 3, 2}, {1, 3, 2}, {1, 3, 9}, problem.goal};
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::failed) << "out of bounds";
  planner.points = {};
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::failed);
  planner.status = PathStatus::iteration_limit;
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::iteration_limit);
  EXPECT_EQ(planner.plan(problem).report.iterations, 7);
  planner.throws = true;
  EXPECT_EQ(planner.plan(problem).report.message, "out of luck");
}

TEST(PathPlanners, SayWhatBlocksTheEnds) {
  const auto space = free_space_of(wall_with_window());
  const Told planner;
  PathProblem problem = through(*space);
  problem.start = {0.3, 0, 2};
  const PathReport report = planner.plan(problem).report;
  EXPECT_EQ(report.status, PathStatus::start_blocked);
  EXPECT_EQ(report.message,
            "the start (0.30, 0.00, 2.00) is blocked for a body of (0.60, 0.60, 0.40) m");
  problem = through(*space);
  problem.goal.z() = 4.5;
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::goal_blocked);
  problem = through(*space);
  problem.half.x() = -1;
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::unsupported);
  problem.half = through(*space).half;
  problem.bounds.setEmpty();
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::unsupported);
  problem.space = nullptr;
  EXPECT_EQ(planner.plan(problem).report.status, PathStatus::unsupported);
}

TEST(PathPlanners, DetoursAreLeftOut) {
  const auto space = free_space_of(wall_with_window());
  const PathProblem problem = through(*space);
  Told planner;
  planner.points = {problem.start, {-4, 1, 3}, {-4, 5, 1}, {-1, 3, 2},
                    {1, 3, 2},     {2, 5, 3},  {3, -5, 1}, problem.goal};
  const PathResult result = planner.plan(problem);
  EXPECT_EQ(result.points.size(), 4u);
  EXPECT_LT(result.report.length, path_length(planner.points));
  EXPECT_EQ(result.report.length, path_length(result.points));
}

TEST(BlockSpaces, TouchingIsFree) {
  const BlockSpace space({AlignedBox3d(Vector3d(0, 0, 0), Vector3d(1, 1, 1))});
  const Vector3d half(0.5, 0.5, 0.5);
  EXPECT_TRUE(space.swept_box_free({-3, 1.5, 0}, {3, 1.5, 0}, half));
  EXPECT_FALSE(space.swept_box_free({-3, 1.49, 0}, {3, 1.49, 0}, half));
  EXPECT_TRUE(space.swept_box_free({-0.5, 0.5, 0.5}, {-0.5, 0.5, 0.5}, half));
  EXPECT_FALSE(space.swept_box_free({-0.4, 0.5, 0.5}, {-0.4, 0.5, 0.5}, half));
  EXPECT_FALSE(space.segment_free({-1, 0.5, 0.5}, {2, 0.5, 0.5}));
  EXPECT_TRUE(space.segment_free({-1, 0.5, 0.5}, {-0.1, 0.5, 0.5}));
}

}  // namespace
}  // namespace lapwing
