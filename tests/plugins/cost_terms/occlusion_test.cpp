// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

// position[3] target[3]
Eigen::VectorXd line(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  Eigen::VectorXd x(6);
  x << position, target;
  return x;
}

const Environment& obstacles() {
  static const Environment environment = [] {
    Environment around;
    around.obstacles = {sphere_at("ball", {0, 0, 0}, 1.5),
                        box_at("wall", {-0.5, 20, -2}, {0.5, 30, 2})};
    return with_shapes(around);
  }();
  return environment;
}

const BoundCost& occlusion() {
  static const BoundCost term("occlusion", map_of({{"margin", 0.5}}), obstacles());
  return term;
}

double least_clearance(const Eigen::Vector3d& from, const Eigen::Vector3d& to, bool wall) {
  const auto form = judged_form(obstacles().obstacles[wall]);
  double least = 1e9;
  for (int k = 0; k <= 400; ++k) {
    const Eigen::Vector3d p = from + (to - from) * (k / 400.0);
    least = std::min(least, form->distance(p, std::numeric_limits<double>::infinity()));
  }
  return least;
}

// The README's integral of the density of a shape that is neither ball nor block, by the
// verifier's distances and a rule as fine as one likes. `unit` in m.
double density_along(const Obstacle& obstacle, const Eigen::Vector3d& from,
                     const Eigen::Vector3d& to, double margin, double unit) {
  constexpr int kParts = 20000;
  const auto form = judged_form(obstacle);
  double sum = 0;
  for (int k = 0; k < kParts; ++k) {
    const Eigen::Vector3d p = from + (to - from) * ((k + 0.5) / kParts);
    const double distance = form->distance(p, std::numeric_limits<double>::infinity());
    const double x = std::max(0.0, (margin - distance) / unit);
    sum += x <= 1 ? x * x * x : 1 + 3 * (x - 1) + 3 * (x - 1) * (x - 1);
  }
  return sum * (to - from).norm() / kParts / unit;
}

TEST(Occlusion, IsTheHazeOnTheLineOfSight) {
  // Through the middle of the ball: the integral of (1 - x^2)^2 over -1 to 1; the wall likewise,
  // across its thinnest side.
  const Eigen::VectorXd through = occlusion().values(line({-5, 0, 0}, {5, 0, 0}));
  EXPECT_NEAR(through(0), 16.0 / 15, 1e-12);
  EXPECT_EQ(through(1), 0);
  EXPECT_NEAR(occlusion().values(line({-5, 25, 0}, {8, 25, 0}))(1), 16.0 / 15, 1e-12);
  // A chord at 1 m of the middle of a ball of 2 m: (1 - 1/4 - x^2)^2 over |x| < sqrt(3)/2, with
  // more haze below than above.
  const double chord = 16.0 / 15 * std::pow(std::sqrt(0.75), 5);
  EXPECT_NEAR(occlusion().values(line({-5, 0, 1}, {5, 0, 1}))(0), chord * (1 - 0.17 / 2), 1e-12);
  EXPECT_NEAR(occlusion().values(line({-5, 0, -1}, {5, 0, -1}))(0), chord * (1 + 0.17 / 2), 1e-12);
}

TEST(Occlusion, IsZeroExactlyWhereTheLineKeepsTheMargin) {
  Random random(11);
  const auto draw = [&] {
    return Eigen::Vector3d(random.uniform(-6, 6), random.uniform(-6, 34), random.uniform(-5, 5));
  };
  int clear = 0, hidden = 0;
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Vector3d from = draw(), to = draw();
    const Eigen::VectorXd haze = occlusion().values(line(from, to));
    if (least_clearance(from, to, false) > 0.51) {
      EXPECT_EQ(haze(0), 0) << from.transpose() << " to " << to.transpose();
      ++clear;
    }
    const Eigen::Vector3d near(0.51, 0.51, 0.51);
    if (least_clearance(from, to, true) > near.norm()) {
      EXPECT_EQ(haze(1), 0);
    }
    for (const bool wall : {false, true})
      if (least_clearance(from, to, wall) < 0 &&
          (wall ? signed_distance(obstacles().obstacles[1], to)
                : signed_distance(obstacles().obstacles[0], to)) > 0.5) {
        EXPECT_GT(haze(wall), 0) << from.transpose() << " to " << to.transpose();
        ++hidden;
      }
  }
  EXPECT_GT(clear, 500);
  EXPECT_GT(hidden, 200);
}

TEST(Occlusion, WhatTheTargetStandsInHidesNothing) {
  EXPECT_EQ(occlusion().values(line({-5, 0, 0}, {0.3, 0, 0})).norm(), 0);
  EXPECT_EQ(occlusion().values(line({-5, 25, 0}, {0.2, 25, 1})).norm(), 0);
  const double touching = occlusion().values(line({-5, 0, 0}, {1.6, 0, 0}))(0);
  const double beyond = occlusion().values(line({-5, 0, 0}, {2.0, 0, 0}))(0);
  EXPECT_GT(touching, 0);
  EXPECT_LT(touching, 0.1 * beyond);
}

TEST(Occlusion, DerivativesHoldAndLeadOut) {
  const BoundCost& term = occlusion();
  term.expect_derivatives(line({-5, 0.4, 0.3}, {6, -0.5, 0.2}), "through the ball");
  term.expect_derivatives(line({-5, 0, 0}, {6, 0, 0}), "through its middle");
  term.expect_derivatives(line({-5, 1.7, 0}, {6, 1.7, 0.4}), "grazing", 0, 1e-6, 1e-5);
  term.expect_derivatives(line({0.5, 0.2, 0.1}, {6, 1, 0}), "camera in the ball");
  term.expect_derivatives(line({-5, 0.2, 0}, {1.8, 0.1, 0}), "target beside the ball");
  term.expect_derivatives(line({-5, 24, 0.3}, {6, 26, -1}), "through the wall");
  term.expect_derivatives(line({-5, 24, 0}, {6, 24, 0}), "straight across it");
  term.expect_derivatives(line({0.1, 15, 0.3}, {0.2, 33, 0.4}), "lengthways");
  term.expect_derivatives(line({0.2, 24, 0.3}, {6, 26, -1}), "camera in the wall");
  term.expect_derivatives(line({-5, 24, 0.3}, {0.7, 25, 1}), "target beside the wall", 0, 1e-6,
                          1e-6);
  term.expect_finite(line({3, 3, 3}, {3, 3, 3}), "at the target");
  term.expect_finite(line({0, 0, 0}, {0, 0, 0}), "at the target in the ball");
  term.expect_finite(line({-5, 2, 0}, {5, 2, 0}), "touching the grown ball");
  const Eigen::VectorXd middle = line({-5, 0, 0}, {6, 0, 0});
  const Eigen::VectorXd slope = term.jacobian(middle).row(0);
  EXPECT_LT(slope(2), -0.01) << "even from the very middle, upwards is out";
}

// Shapes that are neither ball nor block: a pole, a house without a roof, a cone.
TEST(Occlusion, EveryShapeHides) {
  Environment around;
  around.obstacles = {
      obstacle_at(
          "pole", "capsule",
          {{"from", place_value({0, 0, -3})}, {"to", place_value({0, 0, 3})}, {"radius", 0.5}}),
      zone_at("house", {{-2, 10}, {2, 10}, {2, 14}, {0, 12}, {-2, 14}}, 0, 4),
      obstacle_at("tent", "cone",
                  {{"base", place_value({0, 25, 0})}, {"radius", 2.0}, {"height", 3.0}})};
  around.obstacles.push_back(zone_at("airspace", {{-50, -50}, {50, -50}, {50, 50}, {-50, 50}}));
  around.obstacles.back().opaque = false;
  around = with_shapes(around);
  const BoundCost term("occlusion", map_of({{"margin", 0.5}}), around);
  ASSERT_EQ(term.shape.row_names, (std::vector<std::string>{"pole", "house", "tent"}));
  // Units: the least half size and the margin. The term sums points that are margin / 2 apart or
  // more, which is off by 2 % on the thin pole.
  const auto expect_density = [&](int k, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                  double unit) {
    const double density = density_along(around.obstacles[k], from, to, 0.5, unit);
    EXPECT_GT(density, 0.2);
    EXPECT_NEAR(term.values(line(from, to))(k), density, 0.03 * density) << term.shape.row_names[k];
  };
  expect_density(0, {-6, 0.1, 0}, {6, 0, 0.2}, 1.0);
  expect_density(1, {-6, 11, 2}, {6, 11, 2}, 2.5);
  expect_density(2, {-6, 25, 1}, {6, 25, 1}, 2.0);
  EXPECT_EQ(term.values(line({-6, 0.1, 0}, {6, 0, 0.2}))(1), 0) << "the house is elsewhere";
  EXPECT_EQ(term.values(line({-6, 1.1, 0}, {6, 1.1, 0}))(0), 0) << "keeps the margin";
  EXPECT_EQ(term.values(line({-6, 0, 0}, {0.1, 0, 0}))(0), 0) << "the target stands in it";
  term.expect_derivatives(line({-6, 0.3, 0.2}, {6, -0.2, 0.1}), "past the pole", 0, 1e-5, 1e-4);
  term.expect_derivatives(line({-6, 10.6, 2.2}, {6.3, 11.2, 1.7}), "through the house", 0, 1e-5,
                          1e-4);
  term.expect_derivatives(line({-6, 24.6, 1.2}, {6.3, 25.2, 0.7}), "through the tent", 0, 1e-5,
                          1e-4);
  term.expect_finite(line({0, 0, 0}, {0, 0, 0}), "at the target");
}

TEST(Occlusion, HasNothingToSayWithoutObstacles) {
  const BoundCost none("occlusion", map_of({}));
  EXPECT_EQ(none.shape.rows, 0);
  TrajectoryProblem problem = flight(5, 0.1, gimbal_drone());
  problem.add_block({.name = "target", .size = 3});
  problem.add_cost("occlusion", 1.0, plugins().create<CostTerm>("occlusion"));
  problem.finish();
  EXPECT_EQ(problem.cost(problem.initial_guess()), 0);
  EXPECT_TRUE(problem.quadratic());
}

TEST(Occlusion, LooksAtASubjectToo) {
  Environment environment = obstacles();
  environment.subjects = {{"walker", {0, 1}, {{5, -8, 0}, {5, 8, 0}}, 1.8, 0.5}};
  const BoundCost term("occlusion", map_of({{"subject", "walker"}}), environment);
  Eigen::VectorXd x(4);
  x << -5, 0, 0, 0.5;  // position, time: the walker is behind the ball
  EXPECT_NEAR(term.values(x)(0), 16.0 / 15, 1e-12);
  x(3) = 0.9;
  EXPECT_EQ(term.values(x)(0), 0);
  x << -5, 0.2, 0.1, 0.52;
  term.expect_derivatives(x, "while it walks");
}

}  // namespace
}  // namespace lapwing
