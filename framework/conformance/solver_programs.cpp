// SPDX-License-Identifier: Apache-2.0
// Quadratic programs on the shelf: small and dense, some with scales that make solvers call them
// infeasible. Their optima come from the conditions of Karush, Kuhn and Tucker, by trying every set
// of active limits.
#include <Eigen/LU>
#include <cmath>

#include "framework/conformance/solver_shelf.h"
#include "framework/conformance/standard_setting.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// minimise sum_i p_i (x_i - m_i)^2 / 2  where  low <= A x <= high,  lower <= x <= upper.
struct SmallProgram {
  std::string name;
  Eigen::VectorXd p, m;
  Eigen::MatrixXd a;
  Eigen::VectorXd low, high, lower, upper;
  bool trap = false;

  double cost(const Eigen::VectorXd& x) const { return 0.5 * p.dot((x - m).cwiseAbs2()); }
};

// A model that does nothing: every problem has one.
class Still final : public DifferentiableModel<Still, 1, 1> {
 public:
  void bind(const Vehicle&) override {}
  std::vector<BlockSpec> blocks() const override {
    return {{.name = "place", .unit = "m"},
            {.name = "push", .unit = "m/s", .role = BlockRole::input}};
  }
  bool affine() const override { return true; }
  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    next[0] = state[0] + step * input[0];
  }
  void to_sample(const double* numbers, Sample& sample) const override {
    sample.position.x() = numbers[0];
    sample.velocity.x() = numbers[1];
  }
  void from_sample(const Sample& sample, double* numbers) const override {
    numbers[0] = sample.position.x();
    numbers[1] = sample.velocity.x();
  }
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 2, -1.0);
    std::fill_n(upper, 2, 1.0);
  }
  void describe(Trajectory&) const override {}
};

// y = B x - v of block "x" at every stage, by hand: rows are few and dense.
template <class Base>
class Dense final : public Base {
 public:
  Dense(Eigen::MatrixXd b, Eigen::VectorXd v, Eigen::VectorXd low, Eigen::VectorXd high)
      : b_(std::move(b)), v_(std::move(v)), low_(std::move(low)), high_(std::move(high)) {}
  FunctionShape bind(const ProblemSetting& setting) override {
    return {.blocks = setting.layout.indices({"x"}),
            .rows = static_cast<int>(b_.rows()),
            .affine = true};
  }
  void evaluate(InstanceRange range, const double* inputs, double* values, double* jacobian,
                Workspace&) const override {
    const Eigen::Index n = b_.cols(), rows = b_.rows();
    for (int k = 0; k < range.count; ++k)
      for (Eigen::Index r = 0; r < rows; ++r) {
        double sum = -v_(r);
        for (Eigen::Index c = 0; c < n; ++c) sum += b_(r, c) * inputs[k * n + c];
        values[k * rows + r] = sum;
        for (Eigen::Index c = 0; jacobian && c < n; ++c)
          jacobian[(k * rows + r) * n + c] = b_(r, c);
      }
  }
  void curvature(InstanceRange, const double*, const double*, double*, Workspace&) const override {}
  void bounds(InstanceRange range, double* lower, double* upper) const {
    for (int k = 0; k < range.count; ++k) {
      std::copy(low_.begin(), low_.end(), lower + k * low_.size());
      std::copy(high_.begin(), high_.end(), upper + k * high_.size());
    }
  }

 private:
  Eigen::MatrixXd b_;
  Eigen::VectorXd v_, low_, high_;
};

// Every limit is inactive, at its lower or at its upper side (an equation: both); of all such sets
// the one whose solution is feasible and whose multipliers have the right signs is the optimum.
double optimum_of(const SmallProgram& q) {
  const Eigen::Index n = q.p.size(), rows = q.a.rows(), all = n + rows;
  // Of y = sqrt(p) x, and each limit over its own length: scales of nine orders would drown what is
  // decided below.
  const Eigen::VectorXd roots = q.p.cwiseSqrt(), wanted = roots.cwiseProduct(q.m);
  Eigen::MatrixXd limits(all, n);
  limits << Eigen::MatrixXd::Identity(n, n), q.a;
  limits = limits * roots.cwiseInverse().asDiagonal();
  const Eigen::VectorXd lengths = limits.rowwise().norm();
  limits = lengths.cwiseInverse().asDiagonal() * limits;
  Eigen::VectorXd low(all), high(all);
  low << q.lower, q.low;
  high << q.upper, q.high;
  low = low.cwiseQuotient(lengths);
  high = high.cwiseQuotient(lengths);
  double best = kNone;
  std::vector<int> side(static_cast<std::size_t>(all), 0);  // 0 inactive, 1 lower, 2 upper
  const auto try_sides = [&] {
    std::vector<Eigen::Index> active;
    for (Eigen::Index i = 0; i < all; ++i)
      if (side[static_cast<std::size_t>(i)] > 0) active.push_back(i);
    const auto count = static_cast<Eigen::Index>(active.size());
    if (count > n) return;
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + count, n + count);
    Eigen::VectorXd right(n + count);
    kkt.topLeftCorner(n, n).setIdentity();
    right.head(n) = wanted;
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index i = active[static_cast<std::size_t>(k)];
      kkt.row(n + k).head(n) = limits.row(i);
      kkt.col(n + k).head(n) = limits.row(i).transpose();
      right(n + k) = side[static_cast<std::size_t>(i)] == 1 ? low(i) : high(i);
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> factors(kkt);
    if (!factors.isInvertible()) return;
    const Eigen::VectorXd found = factors.solve(right), y = found.head(n), at = limits * y;
    for (Eigen::Index i = 0; i < all; ++i) {
      const double slack = 1e-9 * (1 + std::abs(at(i)));
      if (at(i) < low(i) - slack || at(i) > high(i) + slack) return;
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(active[static_cast<std::size_t>(k)]);
      const double pull = found(n + k);  // y - wanted + limit' pull = 0
      const bool equation = low(static_cast<Eigen::Index>(i)) == high(static_cast<Eigen::Index>(i));
      if (!equation && (side[i] == 1 ? pull > 1e-9 : pull < -1e-9)) return;
    }
    best = std::min(best, q.cost(y.cwiseQuotient(roots)));
  };
  const std::function<void(Eigen::Index)> choose = [&](Eigen::Index i) {
    if (i == all) return try_sides();
    int& one = side[static_cast<std::size_t>(i)];
    const bool equation = low(i) == high(i);
    for (int s = equation ? 1 : 0; s <= (equation ? 1 : 2); ++s) {
      if ((s == 1 && std::isinf(low(i))) || (s == 2 && std::isinf(high(i)))) continue;
      one = s;
      choose(i + 1);
    }
    one = 0;
  };
  choose(0);
  if (std::isinf(best)) throw Error("the program '" + q.name + "' has no optimum");
  return best;
}

Eigen::VectorXd numbers(std::initializer_list<double> list) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), v.begin());
  return v;
}

std::vector<SmallProgram> small_programs() {
  std::vector<SmallProgram> all;
  Eigen::MatrixXd a(1, 2);
  a << 10, -1;
  all.push_back({"a slanted half plane", numbers({0.02, 2}), numbers({0, 0}), a, numbers({10}),
                 numbers({kNone}), numbers({2, -50}), numbers({50, 50})});
  // The same line twice, and a number that is given: limits that depend on one another.
  Eigen::MatrixXd twice(2, 3);
  twice << 1, 1, 2, 2, 2, 4;
  all.push_back({"a limit said twice", numbers({4, 4, 2}), numbers({2, 1.5, 2}), twice,
                 numbers({-kNone, -kNone}), numbers({3, 6}), numbers({0, 0, 0.25}),
                 numbers({kNone, kNone, 0.25})});
  Eigen::MatrixXd dense(3, 5);
  dense << 1, 1, 1, 1, 1, 1, -1, 2, -2, 0, 0, 3, 0, -1, 4;
  all.push_back({"five numbers, three rows", numbers({1, 2, 3, 4, 5}), numbers({3, -2, 1, 5, -4}),
                 dense, numbers({1, -2, -kNone}), numbers({1, 2, 0}),
                 Eigen::VectorXd::Constant(5, -2.5), Eigen::VectorXd::Constant(5, 2.5)});
  // Feasible, yet called infeasible by solvers that are misled by scales of nine orders.
  Eigen::MatrixXd level(2, 6);
  level << 1, 0, 1, 0, 1, 0, 2.4, 0, -2.4, 0, 0, 1;
  const Eigen::VectorXd wide = numbers({2e4, 0.3491, 2e4, 0.3491, kNone, kNone});
  all.push_back({"stiff angles, zero wanted", numbers({61, 2e9, 61, 2e9, 1000, 100}),
                 Eigen::VectorXd::Zero(6), level, numbers({0, 0}), numbers({0, 0}), -wide, wide,
                 true});
  Eigen::MatrixXd steep(2, 6);
  steep << 0.9973, -156.3, 0.9973, 154.2, 1, 0, -1.619, -1.084e4, 1.612, -1.084e4, 0, 1;
  const double pulled = -876.8 / 11;
  all.push_back({"stiff angles, one-sided thrust", numbers({11, 1e7, 11, 1e7, 700, 1000}),
                 numbers({pulled, 0, pulled, 0, 0, 0}), steep, numbers({757.8, 1.255}),
                 numbers({757.8, 1.255}), numbers({-2000, -0.3491, -2000, -0.3491, -kNone, -kNone}),
                 numbers({-0.0001, 0.3491, -0.0001, 0.3491, kNone, kNone}), true});
  return all;
}

}  // namespace

void add_small_programs(std::vector<ShelfProblem>& shelf) {
  constexpr int kStagesHere = 2;  // the same program at each
  for (const SmallProgram& q : small_programs()) {
    const Eigen::Index n = q.p.size();
    TrajectoryProblem problem(standard_vehicle(), {.stages = kStagesHere, .step = 0.1});
    problem.add_model("still", std::make_unique<Still>());
    problem.add_block({.name = "x", .size = static_cast<int>(n), .role = BlockRole::free});
    const Eigen::VectorXd roots = (q.p / 2).cwiseSqrt();
    const Eigen::VectorXd none;
    problem.add_cost("distance", 1.0,
                     std::make_unique<Dense<CostTerm>>(Eigen::MatrixXd(roots.asDiagonal()),
                                                       roots.cwiseProduct(q.m), none, none));
    problem.add_constraint("rows", std::make_unique<Dense<Constraint>>(
                                       q.a, Eigen::VectorXd::Zero(q.a.rows()), q.low, q.high));
    problem.add_constraint(
        "limits", std::make_unique<Dense<Constraint>>(Eigen::MatrixXd::Identity(n, n),
                                                      Eigen::VectorXd::Zero(n), q.lower, q.upper));
    shelf.push_back({q.name, std::move(problem), kStagesHere * optimum_of(q), false, q.trap});
  }
}

}  // namespace lapwing
