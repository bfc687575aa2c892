// SPDX-License-Identifier: Apache-2.0
// A script's constraint on distances: the verifier's reading of the plan against the framework's
// own tape, and against the certificate.
#include "framework/core/random.h"
#include "framework/geometry/mesh_file.h"
#include "framework/problem/environment_distance.h"
#include "framework/problem/tape.h"
#include "framework/verify/constraint_evaluation.h"
#include "tests/mission/mission_fixture.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

constexpr const char* kNames[] = {"tower", "room", "stage", "crate", "ball"};

// In the free room of the map, with one obstacle of every form; a constraint a form.
class ConstraintDistance : public MissionTest {
 protected:
  MissionResult flown(const std::string& bound) {
    const fs::path data = fs::path(LAPWING_SOURCE_DIR) / "tests/data";
    fs::copy_file(data / "maps/room.bt", folder_ / "room.bt", fs::copy_options::overwrite_existing);
    fs::copy_file(data / "meshes/tower.obj", folder_ / "tower.obj",
                  fs::copy_options::overwrite_existing);
    std::string constraints;
    for (const char* name : kNames)
      constraints += std::string("{ name = 'from ") + name + "', held = false, " + bound +
                     ", value = function(s) return s:distance(s.position, '" + name + "') end }, ";
    mission_ = load(
        "return require('mission.film').shot { margin = 0.1, "
        "keyframes = { { time = 0, position = {4.2, 1.8, 1.4} }, "
        "{ time = 6, position = {1.8, 3.2, 1.4} } }, obstacles = { "
        "{ type = 'mesh', name = 'tower', file = 'tower.obj' }, "
        "{ type = 'map', name = 'room', file = 'room.bt' }, "
        "{ type = 'no_fly_zone', name = 'stage', corners = { {5, 3}, {6, 3}, {6, 5}, {5, 4} }, "
        "floor = 0, ceiling = 2 }, "
        "{ type = 'box', name = 'crate', lower = {0, 0, 0}, upper = {1, 1, 1} }, "
        "{ type = 'sphere', name = 'ball', center = {8, 4, 2}, radius = 0.7 } }, constraints = { " +
        constraints + "} }");
    mission_->configure({}, {});
    return mission_->plan();
  }
  std::unique_ptr<Mission> mission_;  // keeps the obstacles' files
};

double by_tape(const Environment& environment, const std::string& name, const Eigen::Vector3d& p) {
  ExpressionGraph graph;
  const int point[] = {graph.input(0), graph.input(1), graph.input(2)};
  const std::vector<int> outputs{
      nearest_distance(graph, environment, name, {point[0], point[1], point[2]}, 1e-3)};
  const Tape tape(graph, outputs, {0, 1, 2}, 3);
  double value = 0;
  Workspace workspace;
  tape.evaluate(1, p.data(), nullptr, &value, nullptr, workspace);
  return value;
}

TEST_F(ConstraintDistance, TheVerifierReadsWhatTheTapeReads) {
  const MissionResult result = flown("lower = 0");
  const Environment& environment = result.plan.environment;
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-8, -8, -8), Eigen::Vector3d(16, 16, 16));
  std::vector<std::unique_ptr<JudgedShape>> shapes;
  double voxel = 0;
  for (const Obstacle& obstacle : environment.obstacles) {
    const Value* file = obstacle.parameters.find("file");
    shapes.push_back(judged_shape(
        obstacle, file ? result.obstacle_folder / file->as_text() : std::filesystem::path(), box));
    if (shapes.back()->voxels()) voxel = shapes.back()->voxels()->grid().resolution();
  }
  ASSERT_EQ(shapes.size(), std::size(kNames));
  ASSERT_GT(voxel, 0);
  for (const std::string name : kNames) {
    const StatedConstraint* stated = nullptr;
    for (const StatedConstraint& one : result.plan.constraints)
      if (one.name == "from " + name) stated = &one;
    ASSERT_TRUE(stated && stated->unjudged.empty()) << name;
    ASSERT_EQ(problem_of(*stated, result.plan), "") << name;
    ConstraintEvaluation evaluation(*stated, Trajectory{}, {environment, shapes});
    Random random(11);
    double nearest = 1e9, farthest = -1e9;
    for (int trial = 0; trial < 2000; ++trial) {
      ConstraintPoint point;
      Eigen::Vector3d& p = point.motion.position;
      for (int k = 0; k < 3; ++k) p(k) = random.uniform(0.2, k == 0 ? 5.8 : k == 1 ? 4.8 : 2.6);
      // The map's field is exact at the middles of voxels, and interpolated in between.
      const bool middle = name == "room" && trial % 2;
      if (middle) p = voxel * ((p / voxel).array().floor() + 0.5).matrix();
      double read = 0;
      evaluation.evaluate({&point, 1}, {&read, 1});
      const double wanted = by_tape(environment, name, p);
      nearest = std::min(nearest, read);
      farthest = std::max(farthest, read);
      if (name != "room") {
        EXPECT_NEAR(read, wanted, 1e-9) << name << " at " << p.transpose();
        continue;
      }
      // Solvers are given a quarter of a voxel less, so that no interpolation promises too much.
      if (read < voxel) continue;
      if (middle) {
        EXPECT_NEAR(read, wanted + voxel / 4, 1e-5) << p.transpose();
      }
      EXPECT_GE(read, wanted - 1e-5) << p.transpose();
      EXPECT_LE(read, wanted + 1.3 * voxel) << p.transpose();
    }
    EXPECT_GT(farthest - nearest, 0.5) << name << ": every place is as far as every other";
  }
}

// A bound that the flight breaks by a little, and one that it keeps by a little: the certificate
// tells them apart, from the plan's own files.
TEST_F(ConstraintDistance, TheCertificateMeasuresThem) {
  const MissionResult loose = flown("lower = -1");
  const Certificate all = verify(loose.plan, loose.obstacle_folder);
  for (const Check& check : all.failures()) ADD_FAILURE() << to_line(check);
  for (const std::string name : kNames) {
    const Check* check = all.find("constraint \"from " + name + "\"");
    ASSERT_TRUE(check && check->worst) << name;
    EXPECT_EQ(check->skipped, "") << name;
    double least = 1e9;
    for (const Sample& sample : loose.plan.trajectory.samples)
      least = std::min(least, by_tape(loose.plan.environment, name, sample.position));
    EXPECT_NEAR(*check->worst, least, name == "room" ? 0.2 : 0.01) << name;
    for (const double off : {-0.05, 0.05}) {
      Plan plan = loose.plan;
      for (StatedConstraint& one : plan.constraints)
        if (one.name == "from " + name) one.results[0].lower = *check->worst + off;
      const Certificate judged = verify(plan, loose.obstacle_folder);
      EXPECT_EQ(judged.find("constraint \"from " + name + "\"")->pass, off < 0) << name;
      EXPECT_EQ(judged.feasible(), off < 0) << name;
    }
  }
}

}  // namespace
}  // namespace lapwing
