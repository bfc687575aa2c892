// SPDX-License-Identifier: Apache-2.0
// Tour solvers against each other on made-up scans, and on input that is none.
#include <cmath>

#include "framework/conformance/tour_worlds.h"
#include "tests/plugins/tour_solvers/terrain_scene.h"
#include "tests/plugins/tour_solvers/tour_plugins.h"

namespace lapwing {
namespace {

TourReport report_of(const char* solver, const TourProblem& problem,
                     Value parameters = Value::map(),
                     std::optional<std::int64_t> evaluations = std::nullopt) {
  TourRequest request;
  request.bound = false;
  request.evaluation_limit = evaluations;
  const auto plugin = tour_plugins().create<TourSolver>(solver, parameters);
  return plugin->solve(problem, request).report;
}

Value with(const char* name, Value value) {
  Value parameters = Value::map();
  parameters.set(name, std::move(value));
  return parameters;
}

// Equal work: what the start takes is part of it, and the rival repeats itself with other shares
// until the same number of evaluations is used.
TEST(LocalSearch, BeatsRecursiveGreedyAtEqualWork) {
  double margins = 0;
  int counted = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    TourDefinition definition = terrain_tour(seed, {.views = 300, .size = 40, .blocks = 8});
    for (const double budget : {90.0, 180.0, 300.0}) {
      definition.budget = budget;
      const TourProblem problem(definition);
      const TourReport once = report_of("recursive_greedy", problem);
      ASSERT_EQ(once.status, TourStatus::feasible);
      // With no more than the rival's own evaluations never below it.
      const TourReport tied = report_of("local_search", problem, {}, once.evaluations);
      EXPECT_GE(tied.score, once.score) << seed << ", " << budget << " s";
      const std::int64_t work = 5 * problem.views();
      const TourReport rival =
          report_of("recursive_greedy", problem, with("rounds", 1'000'000), work);
      const TourReport ours = report_of("local_search", problem, {}, work);
      EXPECT_GE(ours.score, rival.score) << seed << ", " << budget << " s";
      if (rival.score >= 0.9 * rival.reachable_score) continue;
      margins += ours.score / rival.score - 1;
      ++counted;
    }
  }
  ASSERT_GE(counted, 5);
  EXPECT_GE(margins / counted, 0.03);
  RecordProperty("mean_margin_percent", std::to_string(100 * margins / counted));
}

TEST(Greedy, LazyEvaluationSavesNineTenths) {
  const TourProblem problem(terrain_tour(4, {.views = 300, .size = 40, .blocks = 8}));
  for (const char* solver : {"greedy", "cost_benefit"}) {
    const TourReport lazy = report_of(solver, problem);
    const TourReport plain = report_of(solver, problem, with("lazy", false));
    EXPECT_EQ(lazy.score, plain.score) << solver;
    EXPECT_GE(plain.evaluations, (solver[0] == 'g' ? 10 : 5) * lazy.evaluations) << solver;
  }
}

TEST(TourSolvers, AllSayWhatWasReachable) {
  TourDefinition apart = random_tour(9, {.loop = false});
  std::erase_if(apart.motions, [](const TourMotion& m) { return m.a == 9 || m.b == 9; });
  TourDefinition poor = random_tour(10, {});
  poor.budget = 0;
  TourDefinition dull = random_tour(11, {.legs = true});
  dull.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>(10, 0)));
  for (const char* solver :
       {"greedy", "cost_benefit", "recursive_greedy", "local_search", "milp"}) {
    const auto plugin = tour_plugins().create<TourSolver>(solver, Value());
    const auto message = [&](const TourDefinition& definition) {
      const TourResult result = plugin->solve(TourProblem(definition));
      EXPECT_EQ(result.report.status, TourStatus::infeasible);
      EXPECT_TRUE(result.walk.empty());
      return result.report.message;
    };
    EXPECT_NE(message(apart).find("9 of 10 views can be reached"), std::string::npos);
    EXPECT_NE(message(poor).find("too small"), std::string::npos);
    EXPECT_NE(message(dull).find("adds information"), std::string::npos);
  }
}

TEST(TourSolvers, RefuseAnInitialTourOfAnotherProblem) {
  const TourProblem problem(random_tour(1, {}));
  TourRequest request;
  request.initial = std::vector<int>{0, 55, 0};
  const auto plugin = tour_plugins().create<TourSolver>("local_search", Value());
  const TourResult result = plugin->solve(problem, request);
  EXPECT_EQ(result.report.status, TourStatus::failed);
  EXPECT_NE(result.report.message.find("view 55 does not exist"), std::string::npos);
}

}  // namespace
}  // namespace lapwing
