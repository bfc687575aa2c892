// SPDX-License-Identifier: Apache-2.0
// The integer program against enumeration, on fixed rewards and on published instances.
#include <cmath>

#include "framework/conformance/tour_worlds.h"
#include "framework/view/orienteering_file.h"
#include "tests/plugins/tour_solvers/terrain_scene.h"
#include "tests/plugins/tour_solvers/tour_plugins.h"

namespace lapwing {
namespace {

TourResult milp(const TourProblem& problem, const TourRequest& request = {},
                std::initializer_list<std::pair<const char*, Value>> parameters = {}) {
  Value all = Value::map();
  for (const auto& [name, value] : parameters) all.set(name, value);
  return tour_plugins().create<TourSolver>("milp", all)->solve(problem, request);
}

// Where views are independent its optimum is that of the problem: over motions, over legs, loops
// and ways, with and without a limit of images. Its own proof is the upper bound.
TEST(Milp, FindsTheBestTourOfIndependentViews) {
  int tours = 0;
  for (const std::uint64_t seed : {21, 22, 23}) {
    for (const bool legs : {false, true}) {
      for (const bool loop : {false, true}) {
        for (const int images : {0, 5}) {
          const TourDefinition definition = random_tour(seed, {.views = 9,
                                                               .legs = legs,
                                                               .loop = loop,
                                                               .additive = true,
                                                               .budget_share = 0.6,
                                                               .image_limit = images});
          const double best = best_score_by_enumeration(definition);
          const TourProblem problem(definition);
          const TourResult result = milp(problem, {}, {{"neighbours", 0}});
          const std::string which = std::to_string(seed) + (legs ? " legs" : " motions") +
                                    (loop ? " loop " : " way ") + std::to_string(images);
          if (best <= 0) {
            EXPECT_EQ(result.report.status, TourStatus::infeasible) << which;
            continue;
          }
          ++tours;
          EXPECT_EQ(result.report.score, best) << which << ": " << result.report.message;
          EXPECT_EQ(problem.problem_of(result.walk), "") << which;
          if (images > 0) continue;
          EXPECT_EQ(result.report.status, TourStatus::optimal) << which;
        }
      }
    }
  }
  EXPECT_GE(tours, 15);
}

// Without a start of its own the search still comes to the same end.
TEST(Milp, NeedsNoStart) {
  const TourDefinition definition =
      random_tour(24, {.views = 9, .additive = true, .budget_share = 0.6});
  const TourResult result =
      milp(TourProblem(definition), {}, {{"neighbours", 0}, {"start", false}});
  EXPECT_EQ(result.report.score, best_score_by_enumeration(definition)) << result.report.message;
}

// Three directions at one place, of which the best is fixed; a place beside it.
TEST(Milp, OnePlaceHasOneDirection) {
  ViewScoreBuilder builder(6);
  const auto view = [&](std::initializer_list<std::uint32_t> voxels) {
    std::vector<ViewScore::Contribution> seen;
    for (const std::uint32_t voxel : voxels) seen.push_back({voxel, 1});
    builder.add_view(seen);
  };
  view({});
  view({0, 1});
  view({2, 3, 4});
  view({5});
  view({0});
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(std::move(builder).take());
  d.view_seconds = {1};
  d.motions = {{0, 1, 2}, {0, 2, 2}, {0, 3, 2}, {1, 2, 0}, {2, 3, 0}, {1, 3, 0}, {0, 4, 1}};
  d.budget = 100;
  const TourResult result = milp(TourProblem(d));
  // The other directions are worth nothing to it, though there is time for them.
  EXPECT_EQ(result.report.score, 4) << result.report.message;
  EXPECT_EQ(
      tour_plugins().create<TourSolver>("greedy", Value())->solve(TourProblem(d)).report.score, 6);
}

// Never below greedy in the sum that it maximises; what it says of that sum is in its message.
TEST(Milp, TakesACapAndALimit) {
  const TourProblem problem(terrain_tour(5, {.views = 25, .size = 15, .blocks = 2, .budget = 40}));
  const TourResult all = milp(problem, {}, {{"nodes", 5}});
  ASSERT_EQ(problem.problem_of(all.walk), "") << all.report.message;
  EXPECT_EQ(all.report.status, TourStatus::feasible);
  EXPECT_NE(all.report.message.find("sum of rewards"), std::string::npos);
  EXPECT_LE(all.report.iterations, 6);
  const TourResult capped = milp(problem, {}, {{"nodes", 5}, {"candidates", 10}});
  ASSERT_EQ(problem.problem_of(capped.walk), "");
  EXPECT_GT(capped.report.score, 0);
  const std::string& said = capped.report.message;
  EXPECT_NE(said.find("; left out for less reward: "), said.npos) << said;
  const std::string near = milp(problem, {}, {{"nodes", 5}, {"neighbours", 2}}).report.message;
  EXPECT_NE(near.find("; arcs to all but the 2 nearest views are left out"), near.npos) << near;
  EXPECT_EQ(all.report.message.find("left out for less reward"), said.npos);
  TourRequest request;
  request.iteration_limit = 1;
  EXPECT_LE(milp(problem, request, {{"candidates", 10}}).report.iterations, 2);
}

// A program cut off at once has found nothing, and says so.
TEST(Milp, NoTourFoundIsAnAnswer) {
  const TourProblem problem(terrain_tour(6, {.views = 60, .size = 20, .blocks = 3}));
  TourRequest request;
  request.wall_clock_guard = 0;
  const TourResult result = milp(problem, request, {{"start", false}});
  EXPECT_TRUE(result.walk.empty());
  EXPECT_EQ(result.report.status, TourStatus::time_limit);
  EXPECT_FALSE(result.report.message.empty());
}

TEST(Milp, PublishedInstance) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  const auto path = std::filesystem::path(data) / "orienteering" / "tsiligirides" /
                    "tsiligirides_problem_1_budget_15.txt";
  const TourProblem problem(read_orienteering_file(path).definition);
  const TourResult result = milp(problem, {}, {{"nodes", 20}, {"neighbours", 6}});
  EXPECT_EQ(problem.problem_of(result.walk), "");
  EXPECT_EQ(result.report.score, 45) << result.report.message;  // the published optimum
}

}  // namespace
}  // namespace lapwing
