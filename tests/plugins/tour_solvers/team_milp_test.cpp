// SPDX-License-Identifier: Apache-2.0
// The integer program of a team against enumeration, and local search against the integer program.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "framework/conformance/tour_worlds.h"
#include "framework/core/error.h"
#include "framework/view/orienteering_file.h"
#include "tests/plugins/tour_solvers/terrain_scene.h"
#include "tests/plugins/tour_solvers/tour_plugins.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;

using Settings = std::initializer_list<std::pair<const char*, Value>>;

TeamResult solve_team(const char* solver, const TeamProblem& problem,
                      const TeamRequest& request = {}, Settings parameters = {}) {
  Value all = Value::map();
  for (const auto& [name, value] : parameters) all.set(name, value);
  return tour_plugins().create<TourSolver>(solver, all)->solve(problem, request);
}

// With every arc, and nodes enough for a proof.
TeamResult proven(const TeamProblem& problem, const TeamRequest& request = {}) {
  return solve_team("milp", problem, request, {{"neighbours", 0}, {"nodes", 100'000}});
}

// The best tours by enumeration, and the proof that they are.
void expect_best(const TeamWorld& world) {
  SCOPED_TRACE(world.name);
  const TeamProblem problem = team_of(world);
  const TeamResult result = proven(problem);
  if (world.best <= 0) {
    EXPECT_EQ(result.report.status, TourStatus::infeasible) << result.report.message;
    EXPECT_TRUE(result.walks.empty());
    return;
  }
  EXPECT_EQ(result.report.score, world.best) << result.report.message;
  EXPECT_EQ(result.report.status, TourStatus::optimal) << result.report.message;
  ASSERT_EQ(result.walks.size(), world.tours.size());
  for (std::size_t t = 0; t < world.tours.size(); ++t)
    EXPECT_EQ(fault_of_walk(world.tours[t], result.walks[t]), "");
}

TeamWorld world_of(std::string name, std::vector<TourDefinition> tours) {
  const double best = best_team_score_by_enumeration(tours);
  return {std::move(name), std::move(tours), best};
}

// Two and three tours over motions and over legs, loops and ways: alike ones, ones with other
// budgets, and ones from other homes by another vehicle.
TEST(TeamMilp, FindsTheBestToursOfIndependentViews) {
  int worlds = 0, empty = 0;
  for (std::uint64_t seed = 1; seed <= 48; ++seed) {
    TourWorldOptions options;
    options.views = 6 + static_cast<int>(seed % 3);
    options.legs = seed % 2 == 0;
    options.loop = seed % 4 < 2;
    options.additive = true;
    options.budget_share = 0.4 + 0.1 * static_cast<double>(seed % 4);
    const TourDefinition first = random_tour(seed, options);
    std::vector<TourDefinition> tours{first, first};
    if (seed % 3 != 1) tours.push_back(first);
    if (seed % 3 == 2) tours.back().budget *= 1.5;
    if (seed % 5 == 0) {
      tours.back().start = 3;
      if (options.loop) tours.back().end = 3;
      for (TourMotion& motion : tours.back().motions) motion.seconds *= 1.25;
    }
    const TeamWorld world = world_of("seed " + std::to_string(seed), std::move(tours));
    expect_best(world);
    worlds += world.best > 0;
    if (world.best <= 0) ++empty;
  }
  EXPECT_GE(worlds, 30);
  EXPECT_LE(empty, 18);
}

// Legs that break the triangle inequality: going past a view that another tour has can be quicker.
TEST(TeamMilp, ToursMayShareAViewThatShortensTheWay) {
  // Past 4 it is 1 s from anywhere to anywhere; the stated legs are up to 9 s.
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>{0, 5, 7, 2, 1}));
  d.view_seconds = {0};
  d.legs = {0,  5,  9,  9,  .5,  //
            5,  0,  9,  9,  .5,  //
            9,  9,  0,  2,  .5,  //
            9,  9,  2,  0,  .5,  //
            .5, .5, .5, .5, 0};
  d.end = 1;
  d.budget = 10.5;  // 0 4 2 1, or 0 2 4 1
  const TeamWorld world = world_of("past one view", {d, d});
  EXPECT_EQ(world.best, 15);
  expect_best(world);
  // Worth nothing it is not in the program, whose best is no proof then.
  d.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>{0, 5, 7, 2, 0}));
  const TeamResult without = proven(equal_tours(d, 2));
  EXPECT_NE(without.report.status, TourStatus::optimal);
  EXPECT_GE(without.report.upper_bound, 14);
  EXPECT_THAT(without.report.message, HasSubstr("that shorten ways are left out"));
  const auto alone = tour_plugins().create<TourSolver>("milp", Value());
  EXPECT_NE(alone->solve(TourProblem(d)).report.status, TourStatus::optimal);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TourDefinition bent = random_tour(
        seed,
        {.views = 6, .legs = true, .loop = seed % 2 == 0, .additive = true, .budget_share = 0.3});
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b < 6; ++b) {
        if ((a + b) % 3 == 0) bent.legs[static_cast<std::size_t>(a) * 6 + b] *= 3;
      }
    }
    expect_best(world_of("bent, seed " + std::to_string(seed), {bent, bent, bent}));
  }
}

TEST(TeamMilp, LimitsOfImagesHoldForEachTour) {
  for (const bool legs : {true, false}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const TourDefinition d = random_tour(
          seed,
          {.views = 7, .legs = legs, .additive = true, .budget_share = 0.6, .image_limit = 3});
      const TeamWorld world = world_of("seed " + std::to_string(seed), {d, d});
      if (legs) {
        expect_best(world);
        continue;
      }
      // Over motions the limit counts what ways pass again and again: no proof, but an answer.
      const TeamProblem problem = team_of(world);
      const TeamResult result = proven(problem);
      EXPECT_EQ(problem.problem_of(result.walks), "") << result.report.message;
      EXPECT_LE(result.report.score, world.best);
      EXPECT_GE(result.report.upper_bound, world.best);
    }
  }
}

// A view that no tour can reach, one that a single tour can reach, and a tour that stays at home.
TEST(TeamMilp, ViewsOutOfReachAndToursThatStayAtHome) {
  const double x[] = {0, 1, 2, 40, 15, 14};
  TourDefinition near;
  near.score =
      std::make_shared<const ViewScore>(additive_score(std::vector<double>{0, 3, 4, 50, 0, 6}));
  near.view_seconds = {0};
  for (const double a : x)
    for (const double b : x) near.legs.push_back(std::abs(a - b));
  near.budget = 4;
  TourDefinition far = near;
  far.start = far.end = 4;
  far.budget = 2;
  TourDefinition idle = near;
  idle.budget = 1;  // too little for the nearest view
  const TeamWorld world = world_of("a row of views", {near, idle, far});
  EXPECT_EQ(world.best, 13);
  expect_best(world);
  const TeamResult result = proven(team_of(world));
  EXPECT_EQ(result.walks[1], (std::vector<int>{0}));
  EXPECT_EQ(result.report.reachable, 5);
  // All views on one of two alike tours: the other one has nothing to do.
  const TeamProblem two = equal_tours(near, 2);
  const TeamResult one_does_all = proven(two);
  EXPECT_EQ(one_does_all.report.status, TourStatus::optimal);
  EXPECT_EQ(one_does_all.report.score, 7);
  // Ways have their end even so.
  TourDefinition way = near;
  way.end = 2;
  way.budget = 2;
  expect_best(world_of("ways along the row", {way, way, way}));
}

TEST(TeamMilp, LocalSearchFindsWhatItProves) {
  double missing = 0;
  int short_of_it = 0;
  int problems = 0;
  for (std::uint64_t seed = 1; problems < 20; ++seed) {
    ASSERT_LE(seed, 40u);
    TourWorldOptions options;
    options.views = 12 + static_cast<int>(seed % 4);
    options.legs = seed % 2 == 0;
    options.loop = seed % 4 < 2;
    options.additive = true;
    options.budget_share = options.legs ? 0.3 : options.loop ? 0.2 : 0.26;
    TourDefinition d = random_tour(seed, options);
    TeamWorld world{"", {d, d}};
    if (seed % 3 == 0) world.tours.back().budget *= 1.4;
    const TeamProblem problem = team_of(world);
    if (!problem.why_infeasible().empty()) continue;
    const TeamResult best = proven(problem);
    if (best.report.status == TourStatus::infeasible) continue;
    ++problems;
    ASSERT_EQ(best.report.status, TourStatus::optimal) << seed << ": " << best.report.message;
    const TeamResult found = solve_team("local_search", problem);
    EXPECT_LE(found.report.score, best.report.score) << seed;
    if (found.report.score == best.report.score) continue;
    ++short_of_it;
    std::printf("seed %d: local_search %g of %g\n", static_cast<int>(seed), found.report.score,
                best.report.score);
    EXPECT_GE(found.report.score, 0.95 * best.report.score) << seed;
    missing += 1 - found.report.score / best.report.score;
  }
  EXPECT_LE(short_of_it, 2);
  EXPECT_LE(missing / problems, 0.005);
}

// What is proven within a minute, for the README: with LAPWING_LONG a table, else a size that takes
// no time.
TEST(TeamMilp, SizesThatItProves) {
  const bool whole = std::getenv("LAPWING_LONG") != nullptr;
  const std::vector<int> sizes = whole ? std::vector<int>{12, 16, 20, 30} : std::vector<int>{9};
  for (const std::string kind : {"legs, alike", "motions, alike", "legs, other budgets"}) {
    if (whole) std::printf("%-20s", kind.c_str());
    for (const int views : sizes) {
      int proofs = 0;
      double longest = 0;
      for (const std::uint64_t seed : {1, 2, 3}) {
        TourDefinition d =
            random_tour(seed, {.views = views, .legs = kind[0] == 'l', .additive = true});
        d.budget = 13;
        std::vector<TeamTour> tours;
        for (int t = 0; t < 3; ++t) {
          tours.push_back({std::to_string(t), TourProblem(d)});
          if (kind == "legs, other budgets") d.budget *= 1.1;
        }
        TeamRequest request;
        request.limits.wall_clock_guard = 60;
        const TeamReport report = proven(TeamProblem(std::move(tours)), request).report;
        proofs += report.status == TourStatus::optimal;
        longest = std::max(longest, report.wall_seconds);
      }
      if (whole)
        std::printf("  %d: %d of 3, %4.1f s", views, proofs, longest);
      else
        EXPECT_EQ(proofs, 3) << kind;
    }
    if (whole) std::printf("\n");
  }
}

// Views that overlap: the answer is of the sum of rewards, and the bound is not CBC's.
TEST(TeamMilp, OverlappingViewsAreNotProven) {
  const TourDefinition d = random_tour(21, {.views = 9, .budget_share = 0.3});
  const TeamWorld world = world_of("coverage", {d, d});
  const TeamProblem problem = team_of(world);
  const TeamResult result = proven(problem);
  EXPECT_EQ(problem.problem_of(result.walks), "");
  EXPECT_THAT(result.report.message, HasSubstr("the best tours for the sum of rewards"));
  EXPECT_EQ(result.report.status, TourStatus::feasible);
  EXPECT_GE(result.report.upper_bound, world.best - 1e-6);
}

TourDefinition meadow() {
  return read_orienteering_file(std::string(LAPWING_SOURCE_DIR) +
                                "/tests/data/orienteering/meadow13.txt")
      .definition;
}

TEST(TeamMilp, LeftOutViewsAndArcsAreSaidAndNothingIsProven) {
  TourDefinition d = meadow();
  d.budget = 12;
  const TeamProblem problem = equal_tours(d, 2);
  const TeamResult few = solve_team("milp", problem, {}, {{"candidates", 4}});
  EXPECT_EQ(problem.problem_of(few.walks), "");
  EXPECT_THAT(few.report.message, HasSubstr("left out for less reward: 2 of 6 views"));
  EXPECT_NE(few.report.status, TourStatus::optimal);
  const TeamResult near = solve_team("milp", problem, {}, {{"neighbours", 2}});
  EXPECT_EQ(problem.problem_of(near.walks), "");
  EXPECT_THAT(near.report.message, HasSubstr("all but the 2 nearest views are left out"));
  EXPECT_NE(near.report.status, TourStatus::optimal);
}

TEST(TeamMilp, KeepsItsLimitsAndRepeats) {
  TourDefinition d = terrain_tour(5, {.views = 25, .size = 15, .blocks = 2, .budget = 25});
  const TeamProblem problem = equal_tours(d, 3);
  TeamRequest request;
  request.limits.iteration_limit = 2;
  const Settings small{{"candidates", 10}, {"nodes", 5}};
  const TeamResult first = solve_team("milp", problem, request, small);
  ASSERT_EQ(problem.problem_of(first.walks), "") << first.report.message;
  EXPECT_LE(first.report.iterations, 3);
  EXPECT_EQ(solve_team("milp", problem, request, small).walks, first.walks);
  // From there it never ends below.
  request.initial = solve_team("local_search", problem).walks;
  const TeamResult begun = solve_team("milp", problem, request, small);
  EXPECT_GE(begun.report.score, problem.score_of(*request.initial));
  // Out of time at once: the greedy tours, or without them none.
  TeamRequest none;
  none.limits.wall_clock_guard = 0;
  const TeamResult greedy = solve_team("milp", problem, none);
  EXPECT_EQ(greedy.report.status, TourStatus::time_limit);
  EXPECT_EQ(problem.problem_of(greedy.walks), "");
  const TeamResult nothing = solve_team("milp", problem, none, {{"start", false}});
  EXPECT_EQ(nothing.report.status, TourStatus::time_limit);
  EXPECT_TRUE(nothing.walks.empty());
}

TEST(TeamMilp, NeedsNoStart) {
  const TourDefinition d = random_tour(22, {.views = 8, .additive = true, .budget_share = 0.3});
  const TeamWorld world = world_of("no start", {d, d});
  const TeamResult result =
      solve_team("milp", team_of(world), {}, {{"neighbours", 0}, {"start", false}});
  EXPECT_EQ(result.report.score, world.best) << result.report.message;
}

TEST(TeamMilp, AProgramThatIsTooLargeIsRefused) {
  TourDefinition d = random_tour(3, {.views = 260, .legs = true, .additive = true});
  std::vector<TeamTour> tours;
  for (int t = 0; t < 5; ++t) {
    d.budget += 1;  // each of its own columns
    tours.push_back({std::to_string(t), TourProblem(d)});
  }
  const TeamResult result =
      solve_team("milp", TeamProblem(std::move(tours)), {}, {{"neighbours", 0}});
  EXPECT_EQ(result.report.status, TourStatus::unsupported);
  EXPECT_THAT(result.report.message, HasSubstr("5 tours and 228 views has"));
  EXPECT_THAT(result.report.message, HasSubstr("lower the parameters candidates or neighbours"));
}

// The instance of Chao's plain format, its cost limit dealt to a team.
TEST(TeamMilp, ProvesAnOrienteeringFile) {
  for (const int team : {2, 3}) {
    TourDefinition d = meadow();
    d.budget = (team == 2 ? 24.0 : 33.0) / team;
    expect_best(world_of("team of " + std::to_string(team), std::vector<TourDefinition>(team, d)));
  }
}

}  // namespace
}  // namespace lapwing
