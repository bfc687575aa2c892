// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/step_filter.h"

#include <limits>

#include <gtest/gtest.h>

namespace lapwing {
namespace {

StepFilter fresh() {
  StepFilter filter;
  filter.reset(1.0);
  return filter;
}

// From violation 1 and cost 10, a whole step.
bool accepts(StepFilter& filter, double violation, double cost) {
  return filter.accept(1.0, 0.0, 1.0, 10.0, violation, cost);
}

TEST(StepFilter, WantsLessViolationOrLessCost) {
  StepFilter a = fresh(), b = fresh(), c = fresh();
  EXPECT_TRUE(accepts(a, 0.5, 20.0));
  EXPECT_TRUE(accepts(b, 2.0, 5.0));
  EXPECT_FALSE(accepts(c, 1.0, 10.0));
  EXPECT_FALSE(accepts(c, 1.1, 10.1));
}

TEST(StepFilter, RemembersWhereItCameFrom) {
  StepFilter filter = fresh();
  EXPECT_TRUE(accepts(filter, 2.0, 5.0));
  // From there, less violation than there but no better than the first point: a circle.
  EXPECT_FALSE(filter.accept(1.0, 0.0, 2.0, 5.0, 1.0, 10.0));
  EXPECT_TRUE(filter.accept(1.0, 0.0, 2.0, 5.0, 0.9, 10.0));
  filter.reset(2.0);
  EXPECT_TRUE(filter.accept(1.0, 0.0, 2.0, 5.0, 1.0, 10.0));
}

// Where rows are met a step has to lower the cost by its share of the slope.
TEST(StepFilter, AsksForDescentWhereRowsAreMet) {
  StepFilter filter = fresh();
  EXPECT_FALSE(filter.accept(1.0, -2.0, 1e-9, 10.0, 0.0, 10.0 - 1e-5));
  EXPECT_TRUE(filter.accept(1.0, -2.0, 1e-9, 10.0, 0.0, 9.0));
}

TEST(StepFilter, RefusesWhatIsNoNumber) {
  StepFilter filter = fresh();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(accepts(filter, nan, 1.0));
  EXPECT_FALSE(accepts(filter, 0.0, nan));
  EXPECT_FALSE(accepts(filter, 1e9, -1e9)) << "far beyond the first violation";
}

}  // namespace
}  // namespace lapwing
