// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

Environment walker() {
  Environment environment;
  environment.subjects = {{"walker", {1.05, 2.05}, {{10, 0, 1}, {10, 2, 2}}, 1.8, 0.5}};
  return environment;
}

// target[3], then time.
Eigen::VectorXd at(const Eigen::Vector3d& target, double time) {
  Eigen::VectorXd x(4);
  x << target, time;
  return x;
}

TEST(SubjectTarget, IsTheWayFromTheSubjectAtTheTimeOfTheStage) {
  const BoundCost term("subject_target", map_of({{"subject", "walker"}}), walker());
  EXPECT_TRUE(term.shape.integral);
  EXPECT_FALSE(term.shape.affine);
  EXPECT_EQ(term.values(at({10, 0, 1}, 0.3)).norm(), 0) << "at rest before its track";
  EXPECT_NEAR((term.values(at({11, 1, 1}, 1.55)) - Eigen::Vector3d(1, 0, -0.5)).norm(), 0, 1e-14);
  EXPECT_EQ(term.values(at({10, 2, 2}, 7)).norm(), 0) << "and after it";
}

TEST(SubjectTarget, DerivativesHoldByTimeToo) {
  const BoundCost term("subject_target", map_of({{"subject", "walker"}}), walker());
  term.expect_derivatives(at({8, 3, 1}, 1.4), "while it walks");
  term.expect_derivatives(at({8, 3, 1}, 0.4), "while it stands");
  EXPECT_NEAR(term.jacobian(at({8, 3, 1}, 1.4))(1, 3), -2, 1e-12) << "it walks at 2 m/s";
  term.expect_finite(at({8, 3, 1}, 1.05), "where it begins to walk");
}

TEST(SubjectTarget, IsAskedInItsSpansAndNotInCuts) {
  const BoundCost term("subject_target",
                       map_of({{"subject", "walker"},
                               {"spans", spans_of({{0.2, 0.5}, {0.7, 1.0}})},
                               {"except", spans_of({{0.3, 0.4}})}}),
                       walker());
  EXPECT_EQ(term.shape.stages, (std::vector{2, 5, 7, 8, 9, 10}));
}

TEST(SubjectTarget, RefusesWhatDoesNotFit) {
  expect_message(
      [] {
        BoundCost("subject_target", map_of({{"subject", "wlaker"}}), walker());
      },
      {"no subject 'wlaker'", "did you mean 'walker'"});
  expect_message([] { BoundCost("subject_target", map_of({}), walker()); }, {"subject"});
}

}  // namespace
}  // namespace lapwing
