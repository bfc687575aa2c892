// SPDX-License-Identifier: Apache-2.0
// A tour under change against what the problem says of its walk; orders and fixed rewards.
#include "framework/view/working_tour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/conformance/tour_worlds.h"
#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/view/fixed_rewards.h"
#include "framework/view/tour_solver.h"
#include "framework/view/walk_order.h"

namespace lapwing {
namespace {

void expect_consistent(const WorkingTour& tour, const TourProblem& problem) {
  const std::vector<int>& walk = tour.walk();
  ASSERT_GE(walk.size(), 2u);
  EXPECT_EQ(walk.front(), problem.start());
  EXPECT_EQ(walk.back(), problem.end());
  std::map<int, int> visits;
  double seconds = problem.fixed_seconds();
  for (std::size_t i = 0; i < walk.size(); ++i) {
    ++visits[walk[i]];
    if (i) seconds += problem.leg(walk[i - 1], walk[i]);
  }
  for (int v = 0; v < problem.views(); ++v) EXPECT_EQ(tour.visits(v), visits[v]) << v;
  EXPECT_NEAR(tour.seconds(), seconds, 1e-9 * (1 + seconds));
  EXPECT_EQ(tour.images(), TourProblem::images_of(walk));
  EXPECT_DOUBLE_EQ(tour.score(), problem.score_of(walk));
  const std::vector<int> done = tour.finished();
  EXPECT_NEAR(problem.seconds_of(done), seconds, 1e-9 * (1 + seconds)) << "every leg is a motion";
}

// extra[v], tried at every place.
double extra_by_trying(const WorkingTour& tour, int view) {
  const TourProblem& problem = tour.problem();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i + 1 < tour.size(); ++i)
    least =
        std::min(least, problem.leg(tour.walk()[i], view) + problem.leg(view, tour.walk()[i + 1]) -
                            problem.leg(tour.walk()[i], tour.walk()[i + 1]));
  return least;
}

void expect_places(const WorkingTour& tour, const std::vector<double>& extra,
                   const std::vector<int>& after) {
  const TourProblem& problem = tour.problem();
  for (int v = 0; v < problem.views(); ++v) {
    const double least = extra_by_trying(tour, v);
    if (!std::isfinite(least)) {
      EXPECT_FALSE(std::isfinite(extra[v]));
      continue;
    }
    EXPECT_NEAR(extra[v], least, 1e-9 * (1 + std::abs(least))) << v;
    const int a = tour.walk()[after[v]], b = tour.walk()[after[v] + 1];
    EXPECT_NEAR(problem.leg(a, v) + problem.leg(v, b) - problem.leg(a, b), extra[v], 1e-9) << v;
  }
}

TourWorldOptions world_of(std::uint64_t seed) {
  TourWorldOptions options;
  options.views = 12 + static_cast<int>(seed % 20);
  options.voxels = 60;
  options.legs = seed % 3 == 0;
  options.loop = seed % 2 == 0;
  options.budget_share = 3;
  return options;
}

TEST(WorkingTours, StayWhatTheProblemSaysOfTheirWalk) {
  int inserted = 0, removed = 0, shortened = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const TourProblem problem(random_tour(seed, world_of(seed)));
    if (!problem.why_infeasible().empty()) continue;
    WorkingTour tour(problem);
    expect_consistent(tour, problem);
    std::vector<double> extra;
    std::vector<int> after;
    tour.cheapest_places(extra, after);
    Random random(seed);
    for (int step = 0; step < 25; ++step) {
      const int view = static_cast<int>(random.integer(0, problem.views() - 1));
      if (random.uniform() < 0.6) {
        if (!std::isfinite(extra[view]) || (problem.each_once() && tour.visits(view))) continue;
        const double seconds = tour.seconds(), more = extra[view];
        const int at = after[view], size = tour.size();
        tour.insert(view, at);
        ++inserted;
        EXPECT_NEAR(tour.seconds(), seconds + more, 1e-9 * (1 + seconds));
        EXPECT_GT(tour.visits(view), 0);
        tour.update_places(at, tour.size() - size, extra, after);
        expect_places(tour, extra, after);
      } else if (tour.size() > 3) {
        const int first = static_cast<int>(random.integer(1, tour.size() - 2));
        const int last = std::min(tour.size() - 2, first + static_cast<int>(random.integer(0, 2)));
        EXPECT_TRUE(tour.take_out(first, last)) << "no limit forbids it";
        ++removed;
        tour.cheapest_places(extra, after);
      } else {
        const double before = tour.seconds();
        const bool shorter = tour.shorten();
        shortened += shorter;
        EXPECT_EQ(tour.seconds() < before, shorter);
        tour.cheapest_places(extra, after);
      }
      expect_consistent(tour, problem);
    }
    const double before = tour.seconds();
    shortened += tour.shorten();
    EXPECT_LE(tour.seconds(), before);
    expect_consistent(tour, problem);
    EXPECT_FALSE(tour.shorten()) << "at its end";
    const WorkingTour copy = tour;
    WorkingTour again(problem);
    again.become(tour.walk());
    EXPECT_EQ(again.walk(), copy.walk());
    EXPECT_EQ(again.score(), copy.score());
    // Back to nothing: the sums are exact, so that the score is that of a new tour.
    if (tour.size() > 2) tour.take_out(1, tour.size() - 2);
    EXPECT_EQ(tour.walk(), WorkingTour(problem).walk());
    expect_consistent(tour, problem);
  }
  EXPECT_GT(inserted, 100);
  EXPECT_GT(removed, 30);
  EXPECT_GT(shortened, 5);
}

TEST(WorkingTours, KeepTheLimitOfImages) {
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TourWorldOptions options = world_of(seed);
    options.image_limit = 7;
    const TourProblem problem(random_tour(seed, options));
    WorkingTour tour(problem);
    if (!problem.why_infeasible().empty() || tour.images() > 7) continue;
    Random random(seed);
    for (int step = 0; step < 60; ++step) {
      const int view = static_cast<int>(random.integer(0, problem.views() - 1));
      const int at = static_cast<int>(random.integer(0, tour.size() - 2));
      if (!std::isfinite(problem.leg(tour.walk()[at], view)) || tour.visits(view)) continue;
      WorkingTour tried = tour;
      tried.insert(view, at);
      const bool fits = tried.images() <= 7;
      EXPECT_EQ(tour.admits(view, at), fits) << seed;
      refused += !fits;
      if (fits) tour = tried;
      if (tour.size() < 4) continue;
      WorkingTour less = tour;
      const int first = static_cast<int>(random.integer(1, tour.size() - 2));
      const bool done = less.take_out(first, first);
      EXPECT_LE(less.images(), 7);
      if (!done) {
        EXPECT_EQ(less.walk(), tour.walk()) << "nothing was done";
      }
    }
  }
  EXPECT_GT(refused, 50);
}

// Eight views in legs: the best order is found by trying all; local search is never better, and it
// ends where no single exchange helps.
TEST(WalkOrders, AreNoBetterThanTheBestAndHaveNoCrossing) {
  int best_found = 0, trials = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const TourProblem problem(
        random_tour(seed, {.views = 8, .legs = true, .loop = seed % 2 == 0, .budget_share = 9}));
    std::vector<int> inner;
    for (int v = 0; v < problem.views(); ++v)
      if (v != problem.start() && v != problem.end()) inner.push_back(v);
    const auto walk_of = [&](const std::vector<int>& order) {
      std::vector<int> walk{problem.start()};
      walk.insert(walk.end(), order.begin(), order.end());
      walk.push_back(problem.end());
      return walk;
    };
    double best = std::numeric_limits<double>::infinity();
    std::vector<int> order = inner;
    std::sort(order.begin(), order.end());
    do best = std::min(best, problem.seconds_of(walk_of(order)));
    while (std::next_permutation(order.begin(), order.end()));
    Random random(seed);
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1],
                order[static_cast<std::size_t>(random.integer(0, static_cast<int>(k) - 1))]);
    const std::vector<int> given = walk_of(order), found = shorter_order(problem, given);
    const std::vector<int>& walk = found.empty() ? given : found;
    EXPECT_LE(problem.seconds_of(walk), problem.seconds_of(given));
    EXPECT_GE(problem.seconds_of(walk), best - 1e-9);
    ++trials;
    best_found += problem.seconds_of(walk) < best + 1e-6;
    std::vector<int> a(given), b(walk);
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    EXPECT_EQ(a, b) << "the same views";
    for (std::size_t i = 0; i + 1 < walk.size(); ++i)
      for (std::size_t j = i + 2; j + 1 < walk.size(); ++j)
        EXPECT_GE(problem.leg(walk[i], walk[j]) + problem.leg(walk[i + 1], walk[j + 1]),
                  problem.leg(walk[i], walk[i + 1]) + problem.leg(walk[j], walk[j + 1]) - 1e-8);
    EXPECT_TRUE(shorter_order(problem, walk).empty()) << "nothing is left to do";
    EXPECT_TRUE(shorter_order(problem, walk, walk).empty());
  }
  EXPECT_GT(best_found, trials / 2);
}

// Sets of views by definition: min(capacity, sum), voxel by voxel.
TEST(ViewScoresByDefinition, AreMonotoneSubmodularAndIndependentOfOrder) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const int views = 10, voxels = 15;
    std::vector<double> weights(voxels);
    for (double& w : weights) w = random.integer(0, 8) / 4.0;
    std::vector<std::vector<double>> amounts(views, std::vector<double>(voxels, 0));
    ViewScoreBuilder builder(voxels, weights);
    for (auto& row : amounts) {
      std::vector<ViewScore::Contribution> given;
      for (int x = 0; x < voxels; ++x)
        if (random.uniform() < 0.4) {
          row[x] = random.integer(0, 16) / 8.0;  // multiples of the unit: nothing is rounded
          given.push_back({static_cast<std::uint32_t>(x), static_cast<float>(row[x])});
        }
      std::reverse(given.begin(), given.end());
      builder.add_view(given);
    }
    const ViewScore score = std::move(builder).take();
    const auto by_definition = [&](const std::set<int>& set) {
      double sum = 0;
      for (int x = 0; x < voxels; ++x) {
        double seen = 0;
        for (const int v : set) seen += std::min(amounts[v][x], weights[x]);
        sum += std::min(seen, weights[x]);
      }
      return sum;
    };
    std::set<int> small, large;
    ScoreState state(score), more(score);
    for (int step = 0; step < 40; ++step) {
      const int v = static_cast<int>(random.integer(0, views - 1));
      EXPECT_EQ(state.contains(v), small.count(v) > 0);
      if (small.count(v)) {
        std::set<int> without = small;
        without.erase(v);
        EXPECT_NEAR(state.loss(v), by_definition(small) - by_definition(without), 1e-12);
        EXPECT_EQ(state.gain(v), 0);
        state.remove(v);
        small = without;
      } else {
        std::set<int> with = small;
        with.insert(v);
        EXPECT_NEAR(state.gain(v), by_definition(with) - by_definition(small), 1e-12);
        EXPECT_EQ(state.loss(v), 0);
        // What a larger set has a smaller one has too: the larger gains no more.
        large = small;
        more = state;
        for (int k = 0; k < 3; ++k) {
          const int w = static_cast<int>(random.integer(0, views - 1));
          if (w != v) more.add(w), large.insert(w);
        }
        EXPECT_LE(more.gain(v), state.gain(v));
        EXPECT_NEAR(more.score(), by_definition(large), 1e-12);
        state.add(v);
        small = with;
      }
      EXPECT_NEAR(state.score(), by_definition(small), 1e-12);
      EXPECT_EQ(state.size(), static_cast<int>(small.size()));
    }
    for (int v = 0; v < views; ++v) EXPECT_NEAR(score.alone(v), by_definition({v}), 1e-12);
    std::set<int> all;
    for (int v = 0; v < views; ++v) all.insert(v);
    EXPECT_NEAR(score.total(), by_definition(all), 1e-12);
  }
}

TEST(FixedRewardsOfPlaces, NeverExceedTheScoreOfTheSameViews) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const TourProblem problem(random_tour(seed, world_of(seed)));
    const TourRequest request;
    TourWork work(request);
    const FixedRewards fixed = fix_rewards(problem, work);
    ASSERT_EQ(static_cast<int>(fixed.of_view.size()), problem.views());
    Random random(seed);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<int> set;
      double sum = 0;
      for (int v = 0; v < problem.views(); ++v)
        if (random.uniform() < 0.1 + 0.04 * trial) {
          set.push_back(v);
          sum += fixed.of_view[v];
        }
      EXPECT_LE(sum, problem.score_of(set) + 1e-9) << seed;
    }
    double all = std::accumulate(fixed.of_view.begin(), fixed.of_view.end(), 0.0);
    EXPECT_LE(all, problem.score().total() + 1e-9);
    EXPECT_GE(all, *std::max_element(fixed.of_view.begin(), fixed.of_view.end()));
  }
}

// Three places of two views each, one of which shows twice as much: that one is kept, but for the
// start, which is on every tour.
TEST(FixedRewardsOfPlaces, KeepTheBetterViewOfEveryPlace) {
  TourDefinition d;
  d.score =
      std::make_shared<const ViewScore>(additive_score(std::vector<double>{1, 2, 4, 2, 3, 6}));
  d.view_seconds = {1};
  for (int place = 0; place < 3; ++place) d.motions.push_back({2 * place, 2 * place + 1, 0});
  for (int place = 0; place < 2; ++place) d.motions.push_back({2 * place, 2 * place + 2, 5});
  d.budget = 100;
  const TourProblem problem(d);
  const TourRequest request;
  TourWork work(request);
  const FixedRewards fixed = fix_rewards(problem, work);
  EXPECT_EQ(fixed.places, 3);
  EXPECT_EQ(fixed.of_view, (std::vector<double>{1, 0, 4, 0, 0, 6}));
}

TEST(TourWorks, EndOnceAndStayEnded) {
  TourRequest request;
  request.evaluation_limit = 100;
  request.iteration_limit = 10;
  TourWork work(request);
  EXPECT_FALSE(work.ended(99, 9));
  EXPECT_NEAR(work.share_used(50, 2), 0.5, 1e-12);
  EXPECT_NEAR(work.share_used(20, 9), 0.9, 1e-12);
  EXPECT_EQ(work.share_used(1000, 1), 1);
  EXPECT_TRUE(work.ended(100, 9));
  EXPECT_EQ(work.ending(), TourStatus::iteration_limit);
  EXPECT_TRUE(work.ended(0, 0)) << "for ever";
  CancellationToken token;
  TourRequest free;
  free.cancellation = &token;
  TourWork open(free);
  EXPECT_FALSE(open.ended(1'000'000'000, 1'000'000));
  EXPECT_EQ(open.share_used(1'000'000'000, 1), 0) << "no limit is no share";
  token.cancel();
  bool ended = false;
  for (int k = 0; k < 10'000 && !ended; ++k) ended = open.ended(k);
  EXPECT_TRUE(ended) << "asked now and then";
  EXPECT_EQ(open.ending(), TourStatus::cancelled);
}

}  // namespace
}  // namespace lapwing
