// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

// position[3] target[3]
Eigen::VectorXd seen(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  Eigen::VectorXd x(6);
  x << position, target;
  return x;
}

BoundCost skewness(double height) {
  return BoundCost("skewness", map_of({{"height", height}}));
}

// (3.9) as printed, with reading 3.5.
double printed(const Eigen::Vector3d& position, const Eigen::Vector3d& target, double height) {
  const Eigen::Vector3d p_d = target - position;
  const Eigen::Vector3d h(0, 0, position.z() >= target.z() ? height : -height);
  return (p_d + h / 2).dot(p_d) / (p_d - h / 2).dot(p_d) - 1;
}

TEST(Skewness, IsTheRatioOfTheThesis) {
  // 3 m across and 4 m above, h = 5: b = 25 -+ 10, 15/35 - 1.
  EXPECT_NEAR(std::abs(skewness(5).values(seen({3, 0, 4}, {0, 0, 0}))(0)), 20.0 / 35, 1e-15);
  EXPECT_NEAR(std::abs(skewness(5).values(seen({3, 0, -4}, {0, 0, 0}))(0)), 20.0 / 35, 1e-15);
  EXPECT_EQ(skewness(5).values(seen({3, 0, 4}, {9, 1, 4}))(0), 0.0);
  Random random(5);
  const auto draw = [&] {
    return Eigen::Vector3d(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
  };
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d p = draw(), t = draw();
    const double height = random.uniform(0.1, 8);
    EXPECT_NEAR(std::abs(skewness(height).values(seen(p, t))(0)), std::abs(printed(p, t, height)),
                1e-12);
  }
}

TEST(Skewness, DerivativesHoldAboveBelowLevelAndNear) {
  const BoundCost term = skewness(4);
  const Eigen::Vector3d t(1, -2, 3);
  for (const auto& [from, where] : {std::pair{Eigen::Vector3d(5, 1, 9), "above"},
                                    {Eigen::Vector3d(5, 1, -9), "below"},
                                    {Eigen::Vector3d(1, -2, 15), "straight above"},
                                    {Eigen::Vector3d(9, -3, 3.1), "nearly level"}})
    term.expect_derivatives(seen(from, t), where);
  term.expect_derivatives(seen({9, -3, 3}, t), "level", 0, 1e-5, 1e-6);
  term.expect_derivatives(seen({1.04, -2.02, 3.03}, t), "too near", 0, 1e-7, 1e-5);
  for (const double distance : {0.0, 1e-9, 1e-4, 0.02, 0.1})
    term.expect_finite(seen(t + Eigen::Vector3d(distance, 0, distance), t), "at the target");
  EXPECT_EQ(term.values(seen(t, t))(0), 0);
}

TEST(Skewness, IsAskedInItsSpansAndNotInCuts) {
  const BoundCost term("skewness", map_of({{"height", 2.0},
                                           {"spans", spans_of({{0.2, 0.6}})},
                                           {"except", spans_of({{0.4, 0.4}})}}));
  EXPECT_EQ(term.shape.stages, (std::vector{2, 3, 5, 6}));
}

TEST(Skewness, NeedsAHeight) {
  expect_message([] { plugins().create<CostTerm>("skewness"); }, {"height"});
  expect_message(
      [] {
        plugins().create<CostTerm>("skewness", map_of({{"height", 0}}));
      },
      {"height", "above 0"});
}

}  // namespace
}  // namespace lapwing
