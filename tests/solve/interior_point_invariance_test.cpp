// SPDX-License-Identifier: Apache-2.0
// The quadratic program solver: what must not change its answers, and how it stops and refuses.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/solve/interior_point.h"
#include "tests/solve/programs.h"

namespace lapwing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Drawn {
  QuadraticProgram program;
  VectorXd optimum;
};

Drawn drawn(std::uint64_t seed) {
  Random random(seed);
  const int n = 12, m = 6;
  const MatrixXd root = normal_matrix(n, n, random), a = normal_matrix(m, n, random);
  const VectorXd ax = a * normal_vector(n, random);
  Drawn result{
      dense_program(root.transpose() * root + MatrixXd::Identity(n, n),
                    4 * normal_vector(n, random), a, ax, ax + numbers({0, 0, 1, 1, kOpen, kOpen}),
                    VectorXd::Constant(n, -5), VectorXd::Constant(n, 5)),
      {}};
  result.optimum = InteriorPoint().solve(result.program).x;
  return result;
}

// Rows in other units, in another order or twice: the same point.
TEST(InteriorPointInvariance, RowsMayBeScaledMovedRepeatedAndNegated) {
  for (std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Drawn given = drawn(seed);
    const MatrixXd a = given.program.jacobian;
    const int m = given.program.rows();
    const auto expect_same = [&](const MatrixXd& rows, const VectorXd& low, const VectorXd& high,
                                 const char* what) {
      QuadraticProgram changed = given.program;
      changed.jacobian = rows.sparseView();
      changed.row_lower = low;
      changed.row_upper = high;
      const QuadraticResult result = InteriorPoint().solve(changed);
      ASSERT_EQ(result.status, QuadraticStatus::optimal) << what;
      EXPECT_LT((result.x - given.optimum).norm(), 1e-5) << what << ", seed " << seed;
    };
    const VectorXd &low = given.program.row_lower, &high = given.program.row_upper;
    const VectorXd units = numbers({1e-3, 1e4, 1, 17, 1e-2, 1e5});
    expect_same(units.asDiagonal() * a, units.cwiseProduct(low), units.cwiseProduct(high), "units");
    expect_same(a.colwise().reverse(), low.reverse(), high.reverse(), "reversed");
    expect_same(-a, -high, -low, "negated");
    MatrixXd twice(2 * m, a.cols());
    twice << a, a;
    VectorXd low_twice(2 * m), high_twice(2 * m);
    low_twice << low, low;
    high_twice << high, high;
    expect_same(twice, low_twice, high_twice, "repeated");
    MatrixXd more(m + 2, a.cols());
    more << a, a.row(0) + a.row(1), MatrixXd::Zero(1, a.cols());
    VectorXd low_more(m + 2), high_more(m + 2);
    low_more << low, -kOpen, -1;
    high_more << high, kOpen, 0;
    expect_same(more, low_more, high_more, "rows that say nothing");
  }
}

// Numbers of x in other units, and a cost in another currency.
TEST(InteriorPointInvariance, ColumnsAndCostMayBeScaled) {
  Random random(27);
  for (std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Drawn given = drawn(seed);
    const int n = given.program.variables();
    VectorXd units(n);
    for (double& u : units) u = std::pow(10.0, random.uniform(-3, 3));
    const double currency = std::pow(10.0, random.uniform(-4, 4));
    const MatrixXd whole = given.program.hessian.toDense().selfadjointView<Eigen::Lower>();
    const QuadraticResult result = InteriorPoint().solve(dense_program(
        currency * units.asDiagonal() * whole * units.asDiagonal(),
        currency * units.cwiseProduct(given.program.gradient),
        given.program.jacobian.toDense() * units.asDiagonal(), given.program.row_lower,
        given.program.row_upper, given.program.x_lower.cwiseQuotient(units),
        given.program.x_upper.cwiseQuotient(units)));
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << seed;
    EXPECT_LT((units.cwiseProduct(result.x) - given.optimum).norm(), 1e-4) << seed;
  }
}

// Predictor and corrector go round in circles on some programs whose start is far from the middle:
// of these, one in a hundred. All have a solution.
TEST(InteriorPointInvariance, RowsOfLargeUnitsEndInAnAnswer) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const int n = 12, m = 6;
    const MatrixXd root = normal_matrix(n, n, random), a = normal_matrix(m, n, random);
    const VectorXd ax = a * normal_vector(n, random);
    const VectorXd width = numbers({0, 0, 1, 1, kOpen, kOpen});
    VectorXd units = VectorXd::Ones(m);
    units(seed % 2 ? 1 : 5) = seed % 2 ? 1e4 : 1e5;
    const QuadraticResult result = InteriorPoint().solve(dense_program(
        root.transpose() * root + MatrixXd::Identity(n, n), 4 * normal_vector(n, random),
        units.asDiagonal() * a, units.cwiseProduct(ax), units.cwiseProduct(ax + width),
        VectorXd::Constant(n, -5), VectorXd::Constant(n, 5)));
    EXPECT_EQ(result.status, QuadraticStatus::optimal) << seed;
  }
}

void expect_same_result(const QuadraticResult& a, const QuadraticResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.x, b.x) << "byte for byte";
  EXPECT_EQ(a.row_multipliers, b.row_multipliers);
  EXPECT_EQ(a.bound_multipliers, b.bound_multipliers);
}

// What a solver kept of other programs changes no number of the next answer.
TEST(InteriorPointInvariance, MemoryOfEarlierSolvesChangesNothing) {
  const QuadraticProgram first = drawn(1).program, second = drawn(2).program;
  QuadraticProgram smaller = first, fixed = first, thinner = first;
  smaller.jacobian = first.jacobian.topRows(2);
  smaller.row_lower = first.row_lower.head(2);
  smaller.row_upper = first.row_upper.head(2);
  fixed.x_lower(3) = fixed.x_upper(3) = 0.25;
  thinner.jacobian.coeffRef(0, 0) = 0;
  thinner.jacobian.prune(0.0);
  const QuadraticProgram hopeless =
      dense_program(MatrixXd::Identity(1, 1), numbers({0}), MatrixXd::Ones(2, 1),
                    numbers({1, -kOpen}), numbers({kOpen, 0}), numbers({-kOpen}), numbers({kOpen}));
  InteriorPoint reused;
  const std::vector<const QuadraticProgram*> one_after_the_other = {
      &first, &second, &hopeless, &first, &fixed, &first, &thinner, &smaller, &first};
  for (const QuadraticProgram* program : one_after_the_other)
    expect_same_result(reused.solve(*program), InteriorPoint().solve(*program));
}

TEST(InteriorPointInvariance, ThreadsDoNotChangeAnswers) {
  const QuadraticProgram program = drawn(3).program;
  const QuadraticResult alone = InteriorPoint().solve(program);
  std::vector<QuadraticResult> results(6);
  std::vector<std::thread> threads;
  for (QuadraticResult& result : results)
    threads.emplace_back([&] { result = InteriorPoint().solve(program); });
  for (std::thread& thread : threads) thread.join();
  for (const QuadraticResult& result : results) expect_same_result(result, alone);
}

// A warm start is advice. Bad advice costs iterations, not the answer.
TEST(InteriorPointInvariance, BadWarmStartsDoNotChangeTheAnswer) {
  const Drawn given = drawn(4);
  const int n = given.program.variables(), m = given.program.rows();
  const VectorXd nan = VectorXd::Constant(n, std::nan(""));
  const std::vector<std::pair<const char*, QuadraticWarmStart>> advice = {
      {"of another size", {VectorXd::Zero(n - 1), VectorXd::Zero(m), VectorXd::Zero(n)}},
      {"without multipliers", {given.optimum, VectorXd(0), VectorXd(0)}},
      {"multipliers of other sizes", {given.optimum, VectorXd::Ones(m + 1), VectorXd::Ones(1)}},
      {"far outside", {VectorXd::Constant(n, 1e6), VectorXd::Zero(m), VectorXd::Zero(n)}},
      {"huge multipliers",
       {given.optimum, VectorXd::Constant(m, 1e8), VectorXd::Constant(n, -1e8)}},
      {"no numbers", {nan, VectorXd::Zero(m), VectorXd::Zero(n)}},
      {"infinite", {VectorXd::Constant(n, kOpen), VectorXd::Zero(m), VectorXd::Zero(n)}},
      {"multipliers no numbers", {given.optimum, VectorXd::Constant(m, std::nan("")), nan}}};
  for (const auto& [what, warm] : advice) {
    const QuadraticResult result = InteriorPoint().solve(given.program, {}, warm);
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << what;
    EXPECT_LT((result.x - given.optimum).norm(), 1e-5) << what;
  }
  // The same without rows, where no second attempt is made for the sake of a proof.
  const QuadraticProgram box =
      box_program(MatrixXd::Identity(1, 1), numbers({-3}), numbers({0}), numbers({2}));
  for (const double odd : {std::nan(""), kOpen, -kOpen, 1e300}) {
    const QuadraticResult result =
        InteriorPoint().solve(box, {}, QuadraticWarmStart{numbers({odd}), {}, {}});
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << odd;
    EXPECT_NEAR(result.x(0), 2, 1e-6) << odd;
  }
}

TEST(InteriorPointInvariance, StopsWhenToldTo) {
  const QuadraticProgram program = drawn(5).program;
  CancellationToken token;
  token.cancel();
  InteriorPointOptions options;
  options.cancellation = &token;
  const QuadraticResult cancelled = InteriorPoint().solve(program, options);
  EXPECT_EQ(cancelled.status, QuadraticStatus::cancelled);
  EXPECT_EQ(cancelled.iterations, 0);
  EXPECT_EQ(cancelled.x.size(), program.variables());
  EXPECT_TRUE(cancelled.x.allFinite());
  // With more iterations the best point so far does not get worse.
  double before = kOpen;
  const int whole = InteriorPoint().solve(program).iterations;
  for (int limit = 0; limit <= whole; ++limit) {
    InteriorPointOptions limited;
    limited.iteration_limit = limit;
    const QuadraticResult result = InteriorPoint().solve(program, limited);
    const double merit = std::max({result.primal_residual, result.dual_residual, result.gap});
    EXPECT_LE(merit, before) << limit;
    EXPECT_EQ(result.status == QuadraticStatus::optimal, limit >= whole) << limit;
    EXPECT_LE(result.iterations, 3 * limit + 100) << "attempts and one search for a proof";
    before = merit;
  }
}

TEST(InteriorPointInvariance, ASmallerToleranceIsMet) {
  const QuadraticProgram program = drawn(6).program;
  double distance = kOpen;
  const VectorXd exact = InteriorPoint().solve(program, {.tolerance = 1e-12}).x;
  for (const double tolerance : {1e-2, 1e-5, 1e-8, 1e-11}) {
    const QuadraticResult result = InteriorPoint().solve(program, {.tolerance = tolerance});
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << tolerance;
    EXPECT_LE(result.primal_residual, tolerance);
    EXPECT_LE(result.dual_residual, tolerance);
    EXPECT_LE(result.gap, tolerance);
    EXPECT_LE((result.x - exact).norm(), distance);
    distance = (result.x - exact).norm();
  }
  EXPECT_LT(distance, 1e-8);
}

TEST(InteriorPointInvariance, EveryWrongDimensionAndNumberIsRefused) {
  const QuadraticProgram good = drawn(7).program;
  const auto message = [&](const std::function<void(QuadraticProgram&)>& spoil) -> std::string {
    QuadraticProgram bad = good;
    spoil(bad);
    try {
      InteriorPoint().solve(bad);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  using Program = QuadraticProgram;
  const VectorXd other = VectorXd::Zero(5);
  const std::vector<std::function<void(Program&)>> sizes = {
      [&](Program& p) { p.row_lower = other; },     [&](Program& p) { p.row_upper = other; },
      [&](Program& p) { p.x_lower = other; },       [&](Program& p) { p.x_upper = other; },
      [&](Program& p) { p.gradient = other; },      [](Program& p) { p.hessian.resize(3, 3); },
      [](Program& p) { p.jacobian.resize(6, 11); }, [](Program& p) { p.jacobian.resize(5, 12); }};
  for (std::size_t k = 0; k < sizes.size(); ++k)
    EXPECT_NE(message(sizes[k]).find("dimensions disagree"), std::string::npos) << k;
  const double nan = std::nan("");
  const std::vector<std::function<void(Program&)>> values = {
      [&](Program& p) { p.row_lower(1) = nan; },
      [&](Program& p) { p.row_upper(1) = nan; },
      [&](Program& p) { p.x_lower(1) = nan; },
      [&](Program& p) { p.x_upper(1) = nan; },
      [&](Program& p) { p.gradient(1) = kOpen; },
      [&](Program& p) { p.hessian.coeffRef(1, 1) = kOpen; },
      [&](Program& p) { p.jacobian.coeffRef(1, 1) = nan; }};
  for (std::size_t k = 0; k < values.size(); ++k)
    EXPECT_NE(message(values[k]).find("not finite"), std::string::npos) << k;
}

// Bounds that no number meets: both ends at the same infinity.
TEST(InteriorPointInvariance, BoundsAtInfinityAreNeverOptimal) {
  for (const double end : {kOpen, -kOpen}) {
    QuadraticProgram program = drawn(8).program;
    program.x_lower(2) = program.x_upper(2) = end;
    EXPECT_NE(InteriorPoint().solve(program).status, QuadraticStatus::optimal) << end;
    program = drawn(8).program;
    program.row_lower(2) = program.row_upper(2) = end;
    EXPECT_NE(InteriorPoint().solve(program).status, QuadraticStatus::optimal) << end;
  }
}

}  // namespace
}  // namespace lapwing
