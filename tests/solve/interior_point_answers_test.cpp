// SPDX-License-Identifier: Apache-2.0
// The quadratic program solver against other ways to the same answers: closed forms, sorting,
// enumeration; and what must not change them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
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

VectorXd normal_vector(int n, Random& random) {
  VectorXd v(n);
  for (double& x : v) x = random.normal();
  return v;
}

MatrixXd normal_matrix(int rows, int columns, Random& random) {
  MatrixXd matrix(rows, columns);
  for (double& x : matrix.reshaped()) x = random.normal();
  return matrix;
}

// All bounds and rows as one-sided conditions g x >= h, and equations.
struct Conditions {
  std::vector<VectorXd> g;
  std::vector<double> h;
  int equations = 0;  // the first ones
};

Conditions conditions_of(const QuadraticProgram& program) {
  Conditions all;
  const int n = program.variables();
  const MatrixXd a = program.jacobian;
  const auto each = [&](const auto& visit) {
    for (int r = 0; r < program.rows(); ++r)
      visit(VectorXd(a.row(r)), program.row_lower(r), program.row_upper(r));
    for (int i = 0; i < n; ++i)
      visit(VectorXd(VectorXd::Unit(n, i)), program.x_lower(i), program.x_upper(i));
  };
  const auto add = [&](const VectorXd& g, double h) {
    all.g.push_back(g);
    all.h.push_back(h);
  };
  each([&](const VectorXd& g, double low, double high) {
    if (low == high) add(g, low), ++all.equations;
  });
  each([&](const VectorXd& g, double low, double high) {
    if (low == high) return;
    if (std::isfinite(low)) add(g, low);
    if (std::isfinite(high)) add(-g, -high);
  });
  return all;
}

// The optimum of a strictly convex program: every set of active conditions is tried. Nothing where
// no point meets them.
std::optional<VectorXd> by_enumeration(const QuadraticProgram& program) {
  const Conditions all = conditions_of(program);
  const int n = program.variables(), count = static_cast<int>(all.g.size());
  const MatrixXd p = program.hessian.selfadjointView<Eigen::Lower>() * MatrixXd::Identity(n, n);
  std::optional<VectorXd> best;
  for (int set = 0; set < 1 << (count - all.equations); ++set) {
    std::vector<int> active(all.equations);
    std::iota(active.begin(), active.end(), 0);
    for (int k = all.equations; k < count; ++k)
      if (set >> (k - all.equations) & 1) active.push_back(k);
    const int m = static_cast<int>(active.size());
    if (m > n) continue;
    MatrixXd kkt = MatrixXd::Zero(n + m, n + m);
    VectorXd right(n + m);
    kkt.topLeftCorner(n, n) = p;
    right.head(n) = -program.gradient;
    for (int k = 0; k < m; ++k) {
      kkt.block(0, n + k, n, 1) = all.g[active[k]];
      kkt.block(n + k, 0, 1, n) = all.g[active[k]].transpose();
      right(n + k) = all.h[active[k]];
    }
    const Eigen::FullPivLU<MatrixXd> lu(kkt);
    if (!lu.isInvertible()) continue;
    const VectorXd x = lu.solve(right).head(n);
    bool meets = true;
    for (int k = 0; k < count; ++k)
      meets &= all.g[k].dot(x) >= all.h[k] - 1e-9 * (1 + std::abs(all.h[k]));
    if (meets && (!best || program.objective(x) < program.objective(*best))) best = x;
  }
  return best;
}

TEST(InteriorPointAnswers, EqualEnumerationOfActiveSets) {
  Random random(21);
  int solved = 0, refused = 0;
  for (int k = 0; k < 300; ++k) {
    const int n = static_cast<int>(random.integer(1, 3)),
              m = static_cast<int>(random.integer(0, 3));
    const MatrixXd root = normal_matrix(n, n, random);
    const auto bound = [&](double shift) {
      return random.uniform() < 0.3 ? kOpen : shift + random.uniform(0, 1.5);
    };
    VectorXd row_lower(m), row_upper(m), x_lower(n), x_upper(n);
    for (int r = 0; r < m; ++r) {
      const double middle = random.normal();
      row_lower(r) = middle - bound(0.01);
      row_upper(r) = random.uniform() < 0.2 ? row_lower(r) : middle + bound(0.01);
      if (!std::isfinite(row_lower(r)) && row_lower(r) == row_upper(r)) row_upper(r) = kOpen;
    }
    for (int i = 0; i < n; ++i) {
      const double middle = random.normal();
      x_lower(i) = middle - bound(0.01);
      x_upper(i) = middle + bound(0.01);
    }
    const QuadraticProgram program = dense_program(
        root.transpose() * root + 0.1 * MatrixXd::Identity(n, n), normal_vector(n, random),
        normal_matrix(m, n, random), row_lower, row_upper, x_lower, x_upper);
    const std::optional<VectorXd> expected = by_enumeration(program);
    const QuadraticResult result = InteriorPoint().solve(program);
    if (expected) {
      ++solved;
      ASSERT_EQ(result.status, QuadraticStatus::optimal) << "program " << k;
      EXPECT_LT((result.x - *expected).norm(), 1e-5 * (1 + expected->norm())) << "program " << k;
    } else {
      ++refused;
      EXPECT_EQ(result.status, QuadraticStatus::infeasible) << "program " << k;
    }
  }
  EXPECT_GT(solved, 100);
  EXPECT_GT(refused, 30);
}

// Separable: every number is clamped to its bounds. The multiplier is the slope that is left.
TEST(InteriorPointAnswers, ABoxClampsEveryNumber) {
  Random random(22);
  const int n = 200;
  VectorXd weight(n), wish(n), low(n), high(n);
  for (int i = 0; i < n; ++i) {
    weight(i) = std::pow(10.0, random.uniform(-1, 2));
    wish(i) = 3 * random.normal();
    low(i) = i % 5 == 0 ? -kOpen : random.uniform(-2, 0);
    high(i) = i % 7 == 0 ? kOpen : i % 11 == 0 ? std::max(low(i), -2.0) : random.uniform(0, 2);
    if (!std::isfinite(low(i)) && i % 11 == 0) high(i) = 1;
  }
  const QuadraticProgram program =
      box_program(weight.asDiagonal(), -weight.cwiseProduct(wish), low, high);
  const QuadraticResult result = InteriorPoint().solve(program);
  ASSERT_EQ(result.status, QuadraticStatus::optimal);
  // A cost within 1e-9 of the least leaves each number this far from its place.
  const double cost = 1e-9 * (1 + std::abs(program.objective(result.x)));
  for (int i = 0; i < n; ++i) {
    const double expected = std::min(std::max(wish(i), low(i)), high(i));
    const double off = 2 * std::sqrt(2 * cost / weight(i));
    EXPECT_NEAR(result.x(i), expected, off) << i;
    EXPECT_NEAR(result.bound_multipliers(i), weight(i) * (expected - wish(i)), weight(i) * off)
        << i;
  }
}

// The nearest point of { x >= 0, sum x = 1 }, found by sorting (Held, Wolfe, Crowder 1974).
TEST(InteriorPointAnswers, NearestPointOfTheSimplex) {
  Random random(23);
  for (const int n : {1, 2, 7, 60}) {
    const VectorXd wish = normal_vector(n, random);
    VectorXd sorted = wish;
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    double sum = 0, shift = 0;
    for (int k = 0; k < n; ++k) {
      sum += sorted(k);
      if (sorted(k) - (sum - 1) / (k + 1) > 0) shift = (sum - 1) / (k + 1);
    }
    const VectorXd expected = (wish.array() - shift).cwiseMax(0);
    const QuadraticResult result = InteriorPoint().solve(
        dense_program(MatrixXd::Identity(n, n), -wish, MatrixXd::Ones(1, n), numbers({1}),
                      numbers({1}), VectorXd::Zero(n), VectorXd::Constant(n, kOpen)));
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << n;
    EXPECT_LT((result.x - expected).cwiseAbs().maxCoeff(), 1e-6) << n;
    EXPECT_NEAR(result.row_multipliers(0), -shift, 1e-6) << n;
  }
}

// Without curvature: the cheapest assignment of 5 to 5, against all 120 of them.
TEST(InteriorPointAnswers, CheapestAssignmentWithoutCurvature) {
  Random random(24);
  constexpr int kSize = 5;
  for (int trial = 0; trial < 10; ++trial) {
    VectorXd cost(kSize * kSize);
    for (double& c : cost) c = random.uniform(0, 10);
    MatrixXd a = MatrixXd::Zero(2 * kSize, kSize * kSize);  // of which one row says nothing new
    for (int i = 0; i < kSize; ++i)
      for (int j = 0; j < kSize; ++j) a(i, kSize * i + j) = a(kSize + j, kSize * i + j) = 1;
    const VectorXd ones = VectorXd::Ones(2 * kSize);
    const QuadraticResult result = InteriorPoint().solve(
        dense_program(MatrixXd::Zero(kSize * kSize, kSize * kSize), cost, a, ones, ones,
                      VectorXd::Zero(kSize * kSize), VectorXd::Constant(kSize * kSize, kOpen)));
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << trial;
    std::vector<int> order(kSize);
    std::iota(order.begin(), order.end(), 0);
    double best = kOpen;
    do {
      double sum = 0;
      for (int i = 0; i < kSize; ++i) sum += cost(kSize * i + order[i]);
      best = std::min(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(cost.dot(result.x), best, 1e-6) << trial;
  }
}

// Only equations: one linear system.
TEST(InteriorPointAnswers, EquationsAloneAreALinearSystem) {
  Random random(25);
  for (const auto& [n, m] : {std::pair{1, 1}, {6, 2}, {20, 19}, {20, 20}}) {
    const MatrixXd root = normal_matrix(n, n, random), a = normal_matrix(m, n, random);
    const MatrixXd p = root.transpose() * root + MatrixXd::Identity(n, n);
    const VectorXd c = normal_vector(n, random), b = normal_vector(m, random);
    const VectorXd open = VectorXd::Constant(n, kOpen);
    const QuadraticResult result = InteriorPoint().solve(dense_program(p, c, a, b, b, -open, open));
    MatrixXd kkt(n + m, n + m);
    kkt << p, a.transpose(), a, MatrixXd::Zero(m, m);
    VectorXd right(n + m);
    right << -c, b;
    const VectorXd expected = kkt.fullPivLu().solve(right);
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << n << ", " << m;
    EXPECT_LT((result.x - expected.head(n)).norm(), 1e-6 * (1 + expected.head(n).norm()));
    EXPECT_LT((result.row_multipliers + expected.tail(m)).norm(),
              1e-6 * (1 + expected.tail(m).norm()));
  }
}

// A multiplier is the slope of the least cost by the bound that it belongs to.
TEST(InteriorPointAnswers, MultipliersAreSlopesOfTheLeastCost) {
  Random random(26);
  const int n = 4, m = 3;
  const MatrixXd root = normal_matrix(n, n, random), a = normal_matrix(m, n, random);
  QuadraticProgram program = dense_program(root.transpose() * root + MatrixXd::Identity(n, n),
                                           5 * normal_vector(n, random), a,
                                           numbers({0.2, -0.1, -kOpen}), numbers({0.2, kOpen, 0.1}),
                                           VectorXd::Constant(n, -0.5), VectorXd::Constant(n, 0.6));
  InteriorPointOptions exact;
  exact.tolerance = 1e-11;
  const QuadraticResult at = InteriorPoint().solve(program, exact);
  ASSERT_EQ(at.status, QuadraticStatus::optimal);
  const auto slope = [&](std::vector<double*> moved) {
    double cost[2];
    for (const int side : {0, 1}) {
      for (double* bound : moved) *bound += side ? 2e-4 : -1e-4;
      cost[side] = program.objective(InteriorPoint().solve(program, exact).x);
    }
    for (double* bound : moved) *bound -= 1e-4;
    return (cost[1] - cost[0]) / 2e-4;
  };
  int pushing = 0;
  const auto expect = [&](double multiplier, double& low, double& high) {
    pushing += std::abs(multiplier) > 1e-3;
    if (low == high) {
      EXPECT_NEAR(slope({&low, &high}), multiplier, 1e-4);
      return;
    }
    EXPECT_NEAR(slope({&low}), std::max(multiplier, 0.0), 1e-4);
    EXPECT_NEAR(slope({&high}), std::min(multiplier, 0.0), 1e-4);
  };
  for (int r = 0; r < m; ++r)
    expect(at.row_multipliers(r), program.row_lower(r), program.row_upper(r));
  for (int i = 0; i < n; ++i)
    expect(at.bound_multipliers(i), program.x_lower(i), program.x_upper(i));
  EXPECT_GE(pushing, 3) << "or this shows nothing";
}

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
TEST(InteriorPointAnswers, RowsMayBeScaledMovedRepeatedAndNegated) {
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
TEST(InteriorPointAnswers, ColumnsAndCostMayBeScaled) {
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
TEST(InteriorPointAnswers, RowsOfLargeUnitsEndInAnAnswer) {
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

TEST(InteriorPointAnswers, DegenerateSizes) {
  const QuadraticResult none =
      InteriorPoint().solve(box_program(MatrixXd(0, 0), VectorXd(0), VectorXd(0), VectorXd(0)));
  EXPECT_EQ(none.status, QuadraticStatus::optimal);
  EXPECT_EQ(none.x.size(), 0);
  // Every variable fixed: nothing is left to choose, and rows either hold or not.
  const auto fixed = [](double limit) {
    return InteriorPoint().solve(dense_program(MatrixXd::Identity(2, 2), numbers({1, 1}),
                                               MatrixXd::Ones(1, 2), numbers({-kOpen}),
                                               numbers({limit}), numbers({3, 4}), numbers({3, 4})));
  };
  const QuadraticResult held = fixed(8);
  EXPECT_EQ(held.status, QuadraticStatus::optimal);
  EXPECT_EQ(held.x, numbers({3, 4})) << "exactly, not to a tolerance";
  EXPECT_NEAR(held.bound_multipliers(0), 4, 1e-6) << "x + c";
  EXPECT_EQ(fixed(6.5).status, QuadraticStatus::infeasible);
  // A row without entries is a statement about nothing.
  const auto empty_row = [](double low) {
    return InteriorPoint().solve(dense_program(MatrixXd::Identity(1, 1), numbers({-1}),
                                               MatrixXd::Zero(1, 1), numbers({low}),
                                               numbers({kOpen}), numbers({-9}), numbers({9})));
  };
  EXPECT_NEAR(empty_row(-1).x(0), 1, 1e-6);
  EXPECT_EQ(empty_row(1).status, QuadraticStatus::infeasible) << "0 >= 1";
}

// The room between two rows shrinks to a point and then to nothing.
TEST(InteriorPointAnswers, TellsTouchingFromContradicting) {
  const auto status = [](double gap, double size) {
    MatrixXd a(2, 2);
    a << size, size, size, size;
    return InteriorPoint()
        .solve(dense_program(MatrixXd::Identity(2, 2), numbers({0, 1}), a,
                             numbers({-kOpen, size * gap}), numbers({0, kOpen}), numbers({-9, -9}),
                             numbers({9, 9})))
        .status;
  };
  for (const double size : {1e-3, 1.0, 1e3}) {
    EXPECT_EQ(status(-1e-4, size), QuadraticStatus::optimal) << size;
    EXPECT_EQ(status(0, size), QuadraticStatus::optimal) << size;
    EXPECT_EQ(status(1e-4, size), QuadraticStatus::infeasible) << size;
    EXPECT_EQ(status(1, size), QuadraticStatus::infeasible) << size;
  }
}

// An infeasible answer carries its proof: the rows' multipliers add up to a contradiction.
TEST(InteriorPointAnswers, InfeasibleAnswersCarryAProof) {
  // x + y >= 3, x - y >= 2, x <= 2.2: adding the first two gives x >= 2.5.
  MatrixXd a(2, 2);
  a << 1, 1, 1, -1;
  const QuadraticProgram program =
      dense_program(MatrixXd::Identity(2, 2), numbers({0, 0}), a, numbers({3, 2}),
                    numbers({kOpen, kOpen}), numbers({-kOpen, -kOpen}), numbers({2.2, kOpen}));
  const QuadraticResult result = InteriorPoint().solve(program);
  ASSERT_EQ(result.status, QuadraticStatus::infeasible);
  const VectorXd y = result.row_multipliers / result.row_multipliers.cwiseAbs().maxCoeff();
  EXPECT_NEAR(y(0), 1, 1e-4);
  EXPECT_NEAR(y(1), 1, 1e-4);
  const VectorXd aty = a.transpose() * y;
  EXPECT_GT(3 * y(0) + 2 * y(1) - 2.2 * aty(0), 0.5) << "y'b exceeds what the bounds can reach";
}

TEST(InteriorPointAnswers, UnboundedAnswersCarryTheirRay) {
  // Cost -x - y in the cone y <= 2x, y >= x/2, x >= 0, which is open.
  MatrixXd a(2, 2);
  a << 2, -1, -0.5, 1;
  const QuadraticProgram program =
      dense_program(MatrixXd::Zero(2, 2), numbers({-1, -1}), a, numbers({0, 0}),
                    numbers({kOpen, kOpen}), numbers({0, 0}), numbers({kOpen, kOpen}));
  const QuadraticResult result = InteriorPoint().solve(program);
  ASSERT_EQ(result.status, QuadraticStatus::unbounded);
  const VectorXd ray = result.x / result.x.norm();
  EXPECT_LT(program.gradient.dot(ray), -0.5);
  EXPECT_GT((a * ray).minCoeff(), -1e-6);
  EXPECT_GT(ray.minCoeff(), -1e-6);
}

void expect_same_result(const QuadraticResult& a, const QuadraticResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.x, b.x) << "byte for byte";
  EXPECT_EQ(a.row_multipliers, b.row_multipliers);
  EXPECT_EQ(a.bound_multipliers, b.bound_multipliers);
}

// What a solver kept of other programs changes no number of the next answer.
TEST(InteriorPointAnswers, MemoryOfEarlierSolvesChangesNothing) {
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

TEST(InteriorPointAnswers, ThreadsDoNotChangeAnswers) {
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
TEST(InteriorPointAnswers, BadWarmStartsDoNotChangeTheAnswer) {
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

TEST(InteriorPointAnswers, StopsWhenToldTo) {
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

TEST(InteriorPointAnswers, ASmallerToleranceIsMet) {
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

TEST(InteriorPointAnswers, EveryWrongDimensionAndNumberIsRefused) {
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
TEST(InteriorPointAnswers, BoundsAtInfinityAreNeverOptimal) {
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
