// SPDX-License-Identifier: Apache-2.0
// Passes with images, and which of them are flown within a budget.
#include "framework/view/pass_tour.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
constexpr double kHalfTurn = std::numbers::pi;

// Passes to the east, 20 m long, `apart` m beside each other, of three views each.
struct Field {
  std::vector<Viewpoint> views;
  std::vector<std::vector<int>> passes;
  std::vector<double> courses;
  ViewScore score;
  PassSettings settings{.speed = 10,
                        .radius = 15,
                        .lead = 10,
                        .climb = 2,
                        .gimbal = {-kHalfTurn, kHalfTurn, -kHalfTurn / 2, 0, 2, 2},
                        .allowed = {Eigen::Vector3d(-200, -200, 0), Eigen::Vector3d(200, 200, 50)}};

  // What each pass shows: `worth` of its own, a view's third of it each.
  explicit Field(std::vector<double> worth, double apart = 12, double camera_yaw = 0) {
    std::vector<double> each;
    for (std::size_t p = 0; p < worth.size(); ++p) {
      passes.emplace_back();
      courses.push_back(0);
      for (int k = 0; k < 3; ++k) {
        passes.back().push_back(static_cast<int>(views.size()));
        views.push_back({{10.0 * k, apart * static_cast<double>(p), 20}, camera_yaw, -0.8});
        each.push_back(worth[p] / 3);
      }
    }
    score = additive_score(each);
  }
  PassProblem problem() const { return {views, passes, courses, score, settings}; }
};

TEST(Passes, ALegIsATurnBetweenTwoLeads) {
  const Field field({1, 1}, 30);
  const PassProblem problem = field.problem();
  EXPECT_DOUBLE_EQ(problem.seconds(0), 2);
  // East along the first, back along the second: half a circle of 15 m between the leads.
  EXPECT_NEAR(problem.leg(0, 3), (15 * kHalfTurn + 20) / 10, 1e-9);
  EXPECT_NEAR(problem.seconds_of(std::vector<DirectedPass>{0, 3}),
              2 + 2 + (15 * kHalfTurn + 20) / 10 + 2, 1e-9);
  EXPECT_EQ(problem.seconds_of({}), 0);
}

TEST(Passes, TheGimbalLooksTheSameWayBothWays) {
  Field field({1, 1}, 30, kHalfTurn / 2);
  const std::vector<DirectedPass> order{0, 3};
  const PassFlight flight = field.problem().flight_of(order);
  ASSERT_EQ(flight.holds.size(), 2u);
  EXPECT_NEAR(flight.holds[0].yaw, kHalfTurn / 2, 1e-12);
  EXPECT_NEAR(flight.holds[1].yaw, -kHalfTurn / 2, 1e-12);
  EXPECT_DOUBLE_EQ(flight.holds[1].pitch, -0.8);
  // A gimbal that does not turn to the right flies no pass back.
  field.settings.gimbal.yaw_min = 0;
  const PassProblem one_way = field.problem();
  EXPECT_TRUE(one_way.possible(0));
  EXPECT_FALSE(one_way.possible(1));
  EXPECT_TRUE(std::isinf(one_way.leg(0, 3)));
  EXPECT_TRUE(std::isfinite(one_way.leg(0, 2)));
  // Half a turn takes longer than the way between two passes.
  field.settings.gimbal.yaw_min = -kHalfTurn;
  field.settings.gimbal.yaw_rate = 0.1;
  EXPECT_TRUE(std::isinf(field.problem().leg(0, 3)));
  // Nor does one that does not look down so far.
  field.settings.gimbal.pitch_min = -0.5;
  EXPECT_FALSE(field.problem().possible(0));
}

TEST(Passes, TurnsStayWithinTheAir) {
  Field field({1, 1}, 30);
  field.settings.allowed = {Eigen::Vector3d(-30, -30, 0), Eigen::Vector3d(44, 60, 50)};
  EXPECT_TRUE(field.problem().possible(0)) << "the lead is within";
  EXPECT_TRUE(std::isinf(field.problem().leg(0, 3))) << "the turn reaches 45 m";
  field.settings.allowed.max().x() = 46;
  EXPECT_TRUE(std::isfinite(field.problem().leg(0, 3)));
  field.settings.allowed.max().z() = 10;
  EXPECT_FALSE(field.problem().possible(0));
}

TEST(Passes, AFlightIsAtItsImagesInTime) {
  const Field field({1, 1, 1}, 30);
  const PassProblem problem = field.problem();
  const std::vector<DirectedPass> order{0, 3, 4};
  const PassFlight flight = problem.flight_of(order);
  EXPECT_NEAR(flight.duration(), problem.seconds_of(order), 1e-9);
  std::vector<int> taken;
  for (const PassFlight::Shot& shot : flight.shots) {
    taken.push_back(shot.view);
    const auto after = std::lower_bound(flight.times.begin(), flight.times.end(), shot.time);
    ASSERT_NE(after, flight.times.begin());
    const auto k = static_cast<std::size_t>(after - flight.times.begin());
    const double share =
        (shot.time - flight.times[k - 1]) / (flight.times[k] - flight.times[k - 1]);
    const Eigen::Vector3d there =
        flight.positions[k - 1] + share * (flight.positions[k] - flight.positions[k - 1]);
    EXPECT_LT((there - field.views[static_cast<std::size_t>(shot.view)].position).norm(), 1e-9);
  }
  EXPECT_EQ(taken, (std::vector<int>{0, 1, 2, 5, 4, 3, 6, 7, 8}));
  for (std::size_t k = 1; k < flight.times.size(); ++k) {
    EXPECT_GT(flight.times[k], flight.times[k - 1]);
    EXPECT_LE(flight.times[k] - flight.times[k - 1], 0.5 + 1e-9);
    EXPECT_LE((flight.positions[k] - flight.positions[k - 1]).norm(),
              10 * (flight.times[k] - flight.times[k - 1]) + 1e-9);
    EXPECT_LE(std::abs(flight.courses[k] - flight.courses[k - 1]),
              10.0 / 15 * (flight.times[k] - flight.times[k - 1]) + 1e-9);
  }
}

// The best of all orders of all subsets, by trying them.
double best_score(const PassProblem& problem, double budget) {
  std::vector<int> all(static_cast<std::size_t>(problem.passes()));
  for (std::size_t p = 0; p < all.size(); ++p) all[p] = static_cast<int>(p);
  double best = 0;
  do {
    for (unsigned ways = 0; ways < 1u << all.size(); ++ways) {
      std::vector<DirectedPass> order;
      ScoreState state(problem.score());
      for (std::size_t i = 0; i < all.size(); ++i) {
        order.push_back(2 * all[i] + static_cast<int>(ways >> i & 1));
        if (problem.seconds_of(order) > budget) break;
        state.add(all[i]);
        best = std::max(best, state.score());
      }
    }
  } while (std::next_permutation(all.begin(), all.end()));
  return best;
}

TEST(PassTour, FindsTheBestOfAllOrders) {
  const Field field({3, 1, 4, 1, 5});
  const PassProblem problem = field.problem();
  for (const double budget : {3.0, 5.0, 16.0, 25.0, 40.0, 80.0}) {
    const PassTour tour = find_pass_tour(problem, {.budget = budget});
    EXPECT_NEAR(tour.report.score, best_score(problem, budget), 1e-4) << budget;
    EXPECT_LE(problem.seconds_of(tour.order), budget);
    EXPECT_DOUBLE_EQ(tour.report.seconds_used, problem.seconds_of(tour.order));
    EXPECT_EQ(tour.report.images, static_cast<int>(3 * tour.order.size()));
    EXPECT_LE(tour.report.score, tour.report.upper_bound);
  }
}

TEST(PassTour, KeepsItsLimits) {
  const Field field({3, 1, 4, 1, 5});
  const PassProblem problem = field.problem();
  const PassTour few = find_pass_tour(problem, {.budget = 80, .image_limit = 7});
  EXPECT_EQ(few.report.images, 6);
  EXPECT_NEAR(few.report.score, 9, 1e-4);
  const PassTour none = find_pass_tour(problem, {.budget = 1});
  EXPECT_EQ(none.report.status, TourStatus::infeasible);
  EXPECT_TRUE(none.order.empty());
  EXPECT_THAT(none.report.message, HasSubstr("none of 5 passes fits into 1 s"));
  CancellationToken cancelled;
  cancelled.cancel();
  EXPECT_EQ(find_pass_tour(problem, {.budget = 80, .cancellation = &cancelled}).report.status,
            TourStatus::cancelled);
  // The same request, the same tour.
  EXPECT_EQ(find_pass_tour(problem, {.budget = 25, .seed = 7}).order,
            find_pass_tour(problem, {.budget = 25, .seed = 7}).order);
}

// Views of a pass that show the same voxel count as one where that is seen fully.
TEST(Passes, AVoxelCountsOnceHoweverOftenItIsSeen) {
  Field field({1, 1}, 30);
  ViewScoreBuilder builder(2);
  for (int view = 0; view < 6; ++view)
    builder.add_view(
        std::vector<ViewScore::Contribution>{{view < 3 ? 0u : 1u, view < 3 ? 0.75f : 0.25f}});
  field.score = std::move(builder).take();
  const PassProblem problem = field.problem();
  EXPECT_NEAR(problem.score().alone(0), 1, 1e-6);
  EXPECT_NEAR(problem.score().alone(1), 0.75, 1e-6);
}

TEST(Passes, WhatMakesNoSenseIsRefused) {
  Field field({1, 1});
  field.settings.radius = 0;
  EXPECT_THROW(field.problem(), InputError);
  field.settings.radius = 15;
  std::swap(field.passes[0][0], field.passes[0][1]);
  EXPECT_THROW(field.problem(), InputError) << "not in order";
  std::swap(field.passes[0][0], field.passes[0][1]);
  field.views[1].position.z() += 1;
  EXPECT_THROW(field.problem(), InputError) << "not level";
  field.views[1].position.z() -= 1;
  field.views[1].yaw = 1;
  EXPECT_THROW(field.problem(), InputError) << "looks elsewhere";
}

}  // namespace
}  // namespace lapwing
