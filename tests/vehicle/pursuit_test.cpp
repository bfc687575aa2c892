// SPDX-License-Identifier: Apache-2.0
// Pure pursuit: speeds, corners, views, and the whole quadrotor behind it.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/pursuit.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// Out, round two corners, up, and back over the way out; views at points 1, 3 and 5.
const Points kPath = {{0, 0, 3},   {20, 0, 3},  {20, 15, 3}, {20, 15, 8},
                      {10, 15, 8}, {10, -9, 8}, {0, -9, 8}};
const std::vector<PursuitView> kViews = {{1, 0.5}, {3, -2.5}, {5, 3}};

double speed_at(const Sample& s) {
  return s.velocity.norm();
}

TEST(Pursuit, GoesFromRestToRestWithinItsLimits) {
  const Vehicle vehicle = reference_vehicle();
  const PursuitSettings settings;
  const Pursuit flown = pursue(kPath, kViews, vehicle);
  const auto& samples = flown.trajectory.samples;
  EXPECT_EQ(samples.front().position, kPath.front());
  EXPECT_LT((samples.back().position - kPath.back()).norm(), 0.03);
  EXPECT_LT(speed_at(samples.back()), 0.05);
  double fastest = 0;
  for (const Sample& s : samples) {
    fastest = std::max(fastest, speed_at(s));
    EXPECT_LE(speed_at(s), settings.speed) << s.time;
    EXPECT_LE(s.acceleration.norm(), settings.acceleration + 1e-9) << s.time;
    EXPECT_LE(s.velocity.z(), vehicle.climb_speed_max) << s.time;
    EXPECT_LT(distance_to({kPath}, s.position), settings.lookahead) << s.time;
  }
  EXPECT_GT(fastest, 0.9 * settings.speed) << "and it is not slow without need";
}

TEST(Pursuit, SlowsDownBeforeAViewAndRestsInIt) {
  const PursuitSettings settings{.pause = 1};
  const Pursuit flown = pursue(kPath, kViews, reference_vehicle(), settings);
  ASSERT_EQ(flown.views.size(), kViews.size());
  for (std::size_t i = 0; i < kViews.size(); ++i) {
    const ViewPassed& view = flown.views[i];
    EXPECT_NEAR(view.departure - view.arrival, 1, 1e-9);
    EXPECT_LT(view.miss, 0.03);
    if (i > 0) {
      EXPECT_GT(view.arrival, flown.views[i - 1].departure);
    }
    for (const Sample& s : flown.trajectory.samples) {
      if (s.time >= view.arrival && s.time < view.departure) {
        EXPECT_LT(speed_at(s), 0.05) << s.time;
        EXPECT_LT((s.position - kPath[kViews[i].point]).norm(), 0.03) << s.time;
        EXPECT_NEAR(std::remainder(s.yaw - kViews[i].yaw, 2 * M_PI), 0, 0.03) << s.time;
      }
      const bool next = s.time < view.arrival && (i == 0 || s.time > flown.views[i - 1].departure);
      const double left = (s.position - kPath[kViews[i].point]).norm();
      if (next && left < settings.slow_within) {
        EXPECT_LT(speed_at(s), settings.view_speed + 0.1) << s.time << " s, " << left << " m";
      }
    }
  }
}

TEST(Pursuit, TurnsOnTheSpotFromViewToView) {
  const Vehicle vehicle = reference_vehicle();
  const std::vector<PursuitView> views = {{0, 0.5}, {1, 2.5}};
  const Pursuit flown = pursue({{1, 2, 3}, {1, 2, 3}}, views, vehicle, {.pause = 0.5});
  const auto& samples = flown.trajectory.samples;
  EXPECT_EQ(samples.front().yaw, 0.5);
  EXPECT_NEAR(samples.back().yaw, 2.5, 0.02);
  for (const Sample& s : samples) EXPECT_LT((s.position - Vector3d(1, 2, 3)).norm(), 1e-9);
  // No sooner than at the largest rate, and the pauses come on top.
  const double turning = flown.views[1].arrival - flown.views[0].departure;
  EXPECT_GT(turning, 2 / vehicle.yaw_rate_max);
  EXPECT_LT(turning, 10);
  EXPECT_NEAR(flown.trajectory.duration(), turning + 1, 0.11);
}

TEST(Pursuit, FliesByWhereItDoesNotStop) {
  const Pursuit stops = pursue(kPath, kViews, reference_vehicle(), {.stop = true});
  const Pursuit flies = pursue(kPath, kViews, reference_vehicle(), {.stop = false});
  EXPECT_LT(flies.trajectory.duration(), stops.trajectory.duration());
  for (const ViewPassed& view : flies.views) {
    EXPECT_EQ(view.arrival, view.departure);
    EXPECT_LT(view.miss, 0.15);
  }
}

TEST(Pursuit, CutsCornersByLessWithAShorterLookahead) {
  const Points corner = {{0, 0, 3}, {20, 0, 3}, {20, 20, 3}};
  const auto cut = [&](double lookahead) {
    double nearest = 1e9;
    const Pursuit flown = pursue(corner, {}, reference_vehicle(), {.lookahead = lookahead});
    for (const Sample& s : flown.trajectory.samples)
      nearest = std::min(nearest, (s.position - corner[1]).norm());
    return nearest;
  };
  EXPECT_GT(cut(2), 0.1) << "pure pursuit does cut";
  EXPECT_LT(cut(2), 1.5);
  EXPECT_LT(cut(1), cut(2));
}

TEST(Pursuit, CrossingsAndReturnsConfuseNobody) {
  // Over its own way and straight back along it.
  const Points eight = {{0, 0, 3}, {10, 0, 3}, {10, 5, 3}, {5, 5, 3}, {5, -5, 3}, {5, 5, 3}};
  const Pursuit flown = pursue(eight, {}, reference_vehicle());
  EXPECT_LT((flown.trajectory.samples.back().position - eight.back()).norm(), 0.03);
  bool turned = false;
  for (const Sample& s : flown.trajectory.samples) turned |= (s.position - eight[4]).norm() < 1;
  EXPECT_TRUE(turned);
  EXPECT_LT(flown.trajectory.duration(), length_of(eight) / 1.2);
}

TEST(Pursuit, IsAPlanThatTheVerifierAccepts) {
  Plan plan;
  plan.mission = "tour";
  plan.kind = "scan";
  plan.vehicle = to_value(reference_vehicle());
  plan.trajectory = pursue(kPath, kViews, reference_vehicle()).trajectory;
  const Certificate certificate = verify(plan);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
}

TEST(Pursuit, TheWholeQuadrotorFollows) {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.2;
  vehicle.rotors.lag = 0.04;
  const Pursuit flown = pursue(kPath, kViews, vehicle, {.pause = 1});
  const FlownPath calm = fly(flown.trajectory, vehicle);
  EXPECT_LT(calm.position_error_worst, 0.15);
  EXPECT_LT(calm.yaw_error_worst, 0.05);
  EXPECT_LT(calm.saturated_share, 0.005);
  for (std::size_t i = 0; i < kViews.size(); ++i)
    for (const FlownSample& s : calm.samples)
      if (s.time > flown.views[i].arrival + 0.5 && s.time < flown.views[i].departure) {
        EXPECT_LT((s.state.position - kPath[kViews[i].point]).norm(), 0.08) << s.time;
      }
  const FlownPath windy =
      fly(flown.trajectory, vehicle, {.wind_mean = 4, .wind_gust = 1, .seed = 3});
  EXPECT_FALSE(windy.lost);
  EXPECT_LT(windy.position_error_worst, 1);
}

TEST(Pursuit, RefusesWhatMakesNoSense) {
  const Vehicle vehicle = reference_vehicle();
  EXPECT_THROW(pursue({{0, 0, 1}}, {}, vehicle), InputError);
  EXPECT_THROW(pursue({{0, 0, 1}, {0, 0, 1}}, {}, vehicle), InputError);
  EXPECT_THROW(pursue({{0, 0, 1}, {0, 0, 1}}, std::vector<PursuitView>{{1, 0}}, vehicle),
               InputError);
  EXPECT_THROW(pursue({{0, 0, 1}, {NAN, 0, 1}}, {}, vehicle), InputError);
  const std::vector<PursuitView> twice = {{1, 0}, {1, 0}}, beyond = {{9, 0}};
  EXPECT_THROW(pursue(kPath, twice, vehicle), InputError);
  EXPECT_THROW(pursue(kPath, beyond, vehicle), InputError);
  EXPECT_THROW(pursue(kPath, kViews, vehicle, {.speed = 30}), InputError);
  EXPECT_THROW(pursue(kPath, kViews, vehicle, {.view_speed = 0}), InputError);
  EXPECT_THROW(pursue(kPath, kViews, vehicle, {.lookahead = 0.1}), InputError);
  EXPECT_THROW(pursue(kPath, kViews, vehicle, {.acceleration = 50}), InputError);
}

}  // namespace
}  // namespace lapwing
