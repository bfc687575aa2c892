// SPDX-License-Identifier: Apache-2.0
// The quadratic program solver against other ways to the same answers: closed forms, sorting,
// enumeration; proofs where there is none.
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

}  // namespace
}  // namespace lapwing
