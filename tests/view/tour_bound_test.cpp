// SPDX-License-Identifier: Apache-2.0
// Bounds and guarantees against enumeration.
#include "framework/view/tour_bound.h"

#include <cmath>

#include "framework/conformance/tour_worlds.h"
#include "framework/core/random.h"
#include "framework/view/greedy_growth.h"

namespace lapwing {
namespace {

TEST(TourBounds, HoldForEverySetOfViews) {
  int tight = 0, problems = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    TourWorldOptions options;
    options.views = 4 + static_cast<int>(seed % 9);  // up to 12
    options.legs = seed % 2 == 0;
    options.loop = seed % 3 != 0;
    options.additive = seed % 5 == 0;
    options.budget_share = 0.15 * static_cast<double>(1 + seed % 8);
    if (seed % 7 == 0) options.image_limit = 3;
    const TourDefinition definition = random_tour(seed, options);
    const double best = best_score_by_enumeration(definition);
    const TourProblem problem(definition);
    if (best < 0) {
      EXPECT_NE(problem.why_infeasible(), "") << seed;
      continue;
    }
    ++problems;
    Random random(seed);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<int> set;
      for (int v = 0; v < problem.views(); ++v) {
        if (random.uniform() < 0.05 * trial) set.push_back(v);
      }
      EXPECT_GE(tour_bound_with(problem, set), best - 1e-5) << seed << ", trial " << trial;
    }
    const std::vector<int> way{problem.start(), problem.end()};
    const double bound = tour_upper_bound(problem, way);
    EXPECT_GE(bound, best - 1e-5) << seed;
    tight += bound < 1.5 * best;
  }
  EXPECT_GT(problems, 80);
  EXPECT_GT(tight, problems / 2);  // not merely the sum of everything
}

// Stated legs need not be the quickest way (rounded distances): a view too far away by its own legs
// may be near enough past another one.
TEST(TourBounds, HoldForLegsThatBreakTheTriangleInequality) {
  int nearer = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    TourDefinition d = random_tour(seed, {.views = 7, .legs = true, .additive = true});
    Random random(seed);
    for (int a = 0; a < 7; ++a) {
      for (int b = 0; b < a; ++b) {
        const double longer = random.uniform() < 0.5 ? 1 : 5;
        d.legs[a * 7 + b] = d.legs[b * 7 + a] = longer * d.legs[a * 7 + b];
      }
    }
    const TourProblem problem(d);
    const double best = best_score_by_enumeration(d);
    EXPECT_GE(tour_upper_bound(problem, {}), best - 1e-6) << seed;
    EXPECT_GE(problem.score_of(problem.reachable()), best - 1e-6) << seed;
    for (const int view : problem.reachable())
      nearer += problem.fixed_seconds() + 2 * problem.leg(0, view) > d.budget;
  }
  EXPECT_GT(nearer, 3);
  // View 2 is 9 s from both ends of the tour, and 0.5 s from view 3 beside them.
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>{0, 5, 7, 1}));
  d.view_seconds = {0};
  d.legs = {0,  5,  9,  .5,  //
            5,  0,  9,  .5,  //
            9,  9,  0,  .5,  //
            .5, .5, .5, 0};
  d.end = 1;
  d.budget = 10.5;
  const TourProblem problem(d);
  EXPECT_EQ(best_score_by_enumeration(d), 13);
  EXPECT_EQ(problem.reachable(), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_GE(tour_upper_bound(problem, {}), 13);
}

TEST(TourBounds, HoldForWholeNumbersWithoutSlack) {
  // A star: three views at 1 s each from the start, budget for two of them there and back.
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>{0, 5, 4, 3}));
  d.view_seconds = {0};
  for (int v = 1; v < 4; ++v) d.motions.push_back({0, v, 1});
  d.budget = 4;
  EXPECT_DOUBLE_EQ(best_score_by_enumeration(d), 9);
  const TourProblem problem(d);
  EXPECT_GE(tour_bound_with(problem, std::vector<int>{1, 2}), 9);
}

// Reading 2.5: under a limit of images alone greedy reaches 1 - 1/e of the best.
TEST(Greedy, KeepsItsPromiseUnderALimitOfImages) {
  double worst = 1;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const int limit = 2 + static_cast<int>(seed % 5);
    TourDefinition d = random_tour(seed, {.views = 12, .voxels = 60, .legs = true});
    std::fill(d.legs.begin(), d.legs.end(), 0.0);
    d.view_seconds = {0};
    d.image_limit = limit;
    const TourProblem problem(d);
    WorkingTour tour(problem);
    std::vector<double> known = gains_alone(problem);
    const TourRequest request;
    TourWork work(request);
    grow(tour, known, {}, work);
    // The start is given to both; the promise is about what is added to it.
    const double given = problem.score_of(std::vector<int>{problem.start()});
    const double best = best_score_by_enumeration(d);
    EXPECT_EQ(tour.images(), limit);
    EXPECT_GE(tour.score() - given, (1 - std::exp(-1)) * (best - given) - 1e-6) << seed;
    worst = std::min(worst, tour.score() / best);
  }
  EXPECT_LT(worst, 1);  // greedy is not simply optimal here: the test can fail
}

TEST(Greedy, LazyAndPlainAgree) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const bool by_ratio : {false, true}) {
      const TourProblem problem(
          random_tour(seed, {.views = 60, .voxels = 300, .budget_share = 0.2}));
      const TourRequest request;
      std::vector<int> walks[2];
      std::int64_t evaluations[2];
      for (const bool lazy : {false, true}) {
        TourWork work(request);
        WorkingTour tour(problem);
        std::vector<double> known = gains_alone(problem);
        grow(tour, known, {.by_ratio = by_ratio, .lazy = lazy}, work);
        walks[lazy] = tour.walk();
        evaluations[lazy] = tour.state().evaluations();
      }
      EXPECT_EQ(walks[0], walks[1]) << seed;
      EXPECT_LT(evaluations[1], evaluations[0]);
    }
  }
}

}  // namespace
}  // namespace lapwing
