// SPDX-License-Identifier: Apache-2.0
#include "framework/view/pattern_tour.h"
#include "framework/core/error.h"

#include <cmath>
#include <numbers>
#include <set>

#include "framework/core/error.h"

namespace lapwing {
namespace {

const Eigen::AlignedBox3d kRegion{Eigen::Vector3d(-20, -10, 0), Eigen::Vector3d(20, 10, 8)};

TEST(Patterns, AreWhatTheirNamesSay) {
  for (const char* name : {"circle_50", "hemisphere_75", "ellipse_60x40", "meander_85x100",
                           "circle_25:views=240", "meander_50x50:views=256"}) {
    EXPECT_EQ(name_of(pattern_named(name, 30)), name);
  }
  EXPECT_EQ(pattern_named("circle_50", 30).views, 120);
  EXPECT_EQ(pattern_named("meander_100x115", 30).views, 144);
  EXPECT_EQ(pattern_named("circle_25:views=240", 30).views, 240);
  EXPECT_EQ(name_of(pattern_named("circle_25:views=120", 30)), "circle_25") << "as it is anyway";
  for (const char* name : {"circle", "circle_", "circle_0", "circle_5x5", "meander_85", "spiral_5",
                           "circle_-4", "circle_5m", "meander_x4", "circle_5:", "circle_5:views=",
                           "circle_5:views=0", "circle_5:views=2.5", "circle_5:views=20000",
                           "circle_5:count=3", "circle:views=5", "circle_5:views=5x5"}) {
    EXPECT_THROW(pattern_named(name, 30), InputError) << name;
  }
}

TEST(Patterns, CirclesLookAtTheMiddle) {
  for (const char* name : {"circle_50", "ellipse_60x40"}) {
    const Pattern pattern = pattern_named(name, 30);
    const std::vector<Viewpoint> views = pattern_viewpoints(pattern, kRegion);
    ASSERT_EQ(static_cast<int>(views.size()), pattern.views);
    for (const Viewpoint& v : views) {
      EXPECT_NEAR(v.position.z(), 30, 1e-12);
      EXPECT_NEAR(std::pow(v.position.x() / pattern.along_x, 2) +
                      std::pow(v.position.y() / pattern.along_y, 2),
                  1, 1e-12);
      const Eigen::Vector3d towards = (kRegion.center() - v.position).normalized();
      EXPECT_NEAR(v.direction().dot(towards), 1, 1e-12);
    }
  }
}

TEST(Patterns, MeandersGoThereAndBackAndLookDown) {
  const Pattern pattern = pattern_named("meander_60x60", 25);
  const std::vector<Viewpoint> views = pattern_viewpoints(pattern, kRegion);
  ASSERT_EQ(views.size(), 144u);  // 12 lines of 12
  double length = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_NEAR(views[i].pitch, -std::numbers::pi / 2, 1e-12);
    EXPECT_LE(std::abs(views[i].position.x()), 30 + 1e-9);
    EXPECT_LE(std::abs(views[i].position.y()), 30 + 1e-9);
    if (i) length += (views[i].position - views[i - 1].position).norm();
  }
  EXPECT_NEAR(length, 12 * 60 + 60, 1e-9);  // no jump
}

TEST(Patterns, HemispheresKeepTheirRadiusAndTheirNumber) {
  const std::vector<Viewpoint> views =
      pattern_viewpoints(pattern_named("hemisphere_60", 30), kRegion);
  EXPECT_EQ(views.size(), 160u);
  std::set<long> heights;
  for (const Viewpoint& v : views) {
    EXPECT_NEAR(v.position.norm(), 60, 1e-9);
    EXPECT_GT(v.position.z(), 10);
    heights.insert(std::lround(v.position.z() * 1000));
  }
  EXPECT_GE(heights.size(), 4u);
}

TEST(Patterns, WithoutSenseAreRefused) {
  Pattern none{.views = 0};
  EXPECT_THROW(pattern_viewpoints(none, kRegion), InputError);
  EXPECT_THROW(pattern_viewpoints({.along_x = 0}, kRegion), InputError);
  EXPECT_THROW(pattern_viewpoints({}, Eigen::AlignedBox3d()), InputError);
}

// Candidates on a grid of 10 m in one height that all look at the middle, 1 s from each other.
struct Grid {
  std::vector<Viewpoint> viewpoints;
  TourDefinition definition;

  explicit Grid(double budget) {
    for (int i = 0; i < 13; ++i) {
      for (int k = 0; k < 13; ++k) {
        Viewpoint v;
        v.position = {10.0 * i - 60, 10.0 * k - 60, 30};
        const Eigen::Vector3d d = kRegion.center() - v.position;
        v.yaw = std::atan2(d.y(), d.x());
        v.pitch = std::atan2(d.z(), d.head<2>().norm());
        viewpoints.push_back(v);
        if (i > 0) definition.motions.push_back({13 * i + k, 13 * (i - 1) + k, 1});
        if (k > 0) definition.motions.push_back({13 * i + k, 13 * i + k - 1, 1});
      }
    }
    definition.score =
        std::make_shared<const ViewScore>(additive_score(std::vector<double>(169, 1)));
    definition.view_seconds = {1};
    definition.budget = budget;
  }
};

// Along a line, a metre and a second from view to view.
TEST(FreePatterns, TakeAsManyViewpointsAsTheBudgetAllowsEvenly) {
  std::vector<Viewpoint> line(11);
  for (std::size_t i = 0; i < line.size(); ++i) line[i].position.x() = static_cast<double>(i);
  const LegSeconds leg = [](const Viewpoint& a, const Viewpoint& b) {
    return 1 + (b.position - a.position).norm();
  };
  const FreePattern whole = fly_freely(line, 20, leg);
  EXPECT_EQ(whole.views.size(), 11u);
  EXPECT_DOUBLE_EQ(whole.seconds, 20);
  EXPECT_NE(whole.message.find("the whole pattern, 11"), std::string::npos) << whole.message;
  const FreePattern fewer = fly_freely(line, 12.5, leg);
  EXPECT_LE(fewer.seconds, 12.5);
  ASSERT_EQ(fewer.views.size(), 5u);  // 0, 2, 4, 6, 8: 4 legs of 3 s; six views: 9 m and 5 s
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(fewer.views[i].position.x(), 2.0 * static_cast<double>(i)) << i;
  EXPECT_NE(fewer.message.find("5 of the 11"), std::string::npos) << fewer.message;
  EXPECT_NE(fewer.message.find("20 s of 12.5 s"), std::string::npos) << fewer.message;
  const FreePattern none = fly_freely(line, 1, leg);
  EXPECT_TRUE(none.views.empty());
  EXPECT_NE(none.message.find("fewer than two"), std::string::npos) << none.message;
  EXPECT_THROW(fly_freely({}, 10, leg), InputError);
}

TEST(PatternTours, TakeTheNearestCandidates) {
  const Grid grid(1000);
  const TourProblem problem(grid.definition);
  const auto pattern = pattern_viewpoints(pattern_named("circle_50", 30), kRegion);
  const PatternTour tour = fly_pattern(problem, grid.viewpoints, pattern);
  ASSERT_EQ(problem.problem_of(tour.walk), "");
  EXPECT_EQ(tour.flown, tour.wanted);
  EXPECT_DOUBLE_EQ(problem.seconds_of(tour.walk), tour.whole_seconds);
  EXPECT_NE(tour.message.find("whole"), std::string::npos);
  // By brute force: for each wanted viewpoint its nearest candidate is on the walk.
  const std::set<int> on(tour.walk.begin(), tour.walk.end());
  for (const Viewpoint& wanted : pattern) {
    double least = 1e9;
    int best = -1;
    for (int v = 0; v < 169; ++v) {
      const double apart = (grid.viewpoints[v].position - wanted.position).norm() +
                           10 * angle_between(grid.viewpoints[v], wanted);
      if (apart < least) {
        least = apart;
        best = v;
      }
    }
    EXPECT_TRUE(on.count(best)) << best;
  }
}

TEST(PatternTours, DirectionsCount) {
  Grid grid(1000);
  const std::vector<Viewpoint> wanted{grid.viewpoints[100]};
  grid.viewpoints[100].yaw += 3;  // the nearest looks away, 20 m aside is better than that
  const TourProblem problem(grid.definition);
  const PatternTour turned = fly_pattern(problem, grid.viewpoints, wanted, 1000);
  const PatternTour place = fly_pattern(problem, grid.viewpoints, wanted, 0);
  EXPECT_NE(turned.walk, place.walk);
  EXPECT_TRUE(std::count(place.walk.begin(), place.walk.end(), 100));
}

TEST(PatternTours, TakeFewerWhereTheBudgetIsSmall) {
  const Grid whole(1000);
  const auto pattern = pattern_viewpoints(pattern_named("meander_100x100", 30), kRegion);
  const double needed =
      fly_pattern(TourProblem(whole.definition), whole.viewpoints, pattern).whole_seconds;
  int last = 1000;
  for (const double share : {1.0, 0.7, 0.3}) {
    const Grid grid(share * needed);
    const TourProblem problem(grid.definition);
    const PatternTour tour = fly_pattern(problem, grid.viewpoints, pattern);
    ASSERT_EQ(problem.problem_of(tour.walk), "") << share;
    EXPECT_EQ(tour.flown == tour.wanted, share == 1.0);
    EXPECT_LT(tour.flown, last);
    last = tour.flown;
  }
  EXPECT_NE(fly_pattern(TourProblem(Grid(0.3 * needed).definition), whole.viewpoints, pattern)
                .message.find("all take"),
            std::string::npos);
}

TEST(PatternTours, SayWhereNothingFits) {
  const Grid grid(3);
  const PatternTour tour =
      fly_pattern(TourProblem(grid.definition), grid.viewpoints,
                  {pattern_viewpoints(pattern_named("circle_20", 30), kRegion)});
  // Only the start's neighbours are within reach; they stand for the pattern, and say so.
  EXPECT_LE(tour.flown, 2);
  Grid none(0.5);
  const PatternTour empty =
      fly_pattern(TourProblem(none.definition), none.viewpoints,
                  pattern_viewpoints(pattern_named("circle_20", 30), kRegion));
  EXPECT_TRUE(empty.walk.empty());
  EXPECT_NE(empty.message.find("too small"), std::string::npos);
  EXPECT_THROW(fly_pattern(TourProblem(grid.definition), {}, {}), InputError);
}

}  // namespace
}  // namespace lapwing
