// SPDX-License-Identifier: Apache-2.0
// How: w = (x, s) stacks the variables and a slack s = A x of each inequality row. A finite bound
// on an entry of w has a distance t > 0 and a multiplier z > 0 (BoundSide). One iteration of
// `iterate`
//   1. measures the residuals in the problem as given, and ends where they are small, or where x or
//      the multipliers prove that the problem is unbounded or infeasible;
//   2. factorises: t, z and s are eliminated, which leaves the system of interior_point.h in dx and
//      dy, with z / t on the diagonals D_x and D_s;
//   3. solves twice with these factors. The predictor aims at t z = 0. It would reduce the mean mu
//      of t z to mu_a. The second solve aims at (mu_a / mu)^3 mu, and its right side has the
//      second-order term dt dz of the predictor (Mehrotra 1992);
//   4. moves 0.995 of the way to the nearest t = 0 or z = 0, in all numbers alike.
// Fixed variables do not move, and rows without bounds take no part. If a solve ends undecided,
// `contradicts` minimises the sum of violations: if it is not 0, its multipliers prove
// infeasibility. Else the problem is solved once more from a cold start, with all iterations.
#include "framework/solve/interior_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/SparseCholesky>

#include "framework/core/error.h"
#include "framework/solve/elastic.h"
#include "framework/solve/equilibration.h"
#include "framework/solve/infeasibility.h"
#include "framework/solve/kkt_system.h"

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kToBoundary = 0.995;    // share of the step to the boundary that is taken
constexpr double kLeastTarget = 1e-14;   // complementarity is not driven below
constexpr double kSmallestStep = 1e-10;  // shorter steps are a stall
constexpr double kProgress = 0.9;        // factor on the residual that counts as progress
constexpr int kPatience = 15;            // iterations without progress before a proof is sought
constexpr int kStalls = 3;               // stalls in a row that end a solve
constexpr double kNear = 1e-3;           // primal residual of a point that is worth drawing
// The second-order correction can go round in circles (Cartis, Optim. Methods Softw. 24(1), 2009).
// A careful solve leaves it out after so many iterations without progress, and its target then
// stays this share of mu.
constexpr int kCircles = 5;
constexpr double kCentred = 0.3;
constexpr double kWarmFloor = 1e-3;   // least slack and multiplier of a warm start (scaled)
constexpr double kWarmCentre = 1e-2;  // least product of the two

// One side of all bounds: slack t and multiplier z where the bound is finite.
struct BoundSide {
  std::vector<int> index;  // into w = (x, s)
  VectorXd bound, t, z, dt, dz, residual, complement;

  void resize() {
    const auto n = static_cast<Eigen::Index>(index.size());
    for (VectorXd* v : {&bound, &t, &z, &dt, &dz, &residual, &complement}) v->setZero(n);
  }
};

// `first` gives up early, for a proof of infeasibility may be nearer.
enum class Effort { first, patient, careful };

double step_to_boundary(const VectorXd& v, const VectorXd& d) {
  double step = 1.0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (d(i) < 0) step = std::min(step, -v(i) / d(i));
  return step;
}

}  // namespace

// All members below are in scaled numbers. w stacks x and the slacks s of inequality rows; an
// equation's s is its bound, a free row's s plays no part.
struct InteriorPoint::Impl {
  Equilibration scaling;
  KktSystem kkt;
  QuadraticProgram p;  // scaled
  std::vector<RowKind> rows;
  std::vector<char> fixed;  // per variable
  BoundSide lower, upper;
  VectorXd w, y;                      // point
  VectorXd dw, dy;                    // direction
  VectorXd dual, slack_dual, primal;  // residuals: of x, of s, of rows
  VectorXd diagonal;                  // D_x and D_s

  int n() const { return p.variables(); }
  int m() const { return p.rows(); }
  void set_up(const QuadraticProgram& problem);
  void start_cold();
  void start_warm(const QuadraticProgram& problem, const QuadraticWarmStart& warm);
  void place_slacks(double floor);
  void compute_residuals();
  double complementarity() const;
  bool factorise();
  void direction(double target, bool corrected);
  double step_length() const;
  void move(double step);
  QuadraticResult unscaled(const QuadraticProgram& problem, QuadraticResiduals& r) const;
  void solve(const QuadraticProgram& problem, const InteriorPointOptions& options,
             const std::optional<QuadraticWarmStart>& warm_start, Effort effort,
             QuadraticResult& result);
  static bool contradicts(const QuadraticProgram& problem, const InteriorPointOptions& options,
                          QuadraticResult& proof);
  QuadraticStatus iterate(const QuadraticProgram& problem, const InteriorPointOptions& options,
                          Effort effort, QuadraticResult& best);
};

InteriorPoint::InteriorPoint() : impl_(std::make_unique<Impl>()) {}
InteriorPoint::~InteriorPoint() = default;
InteriorPoint::InteriorPoint(InteriorPoint&&) noexcept = default;

void InteriorPoint::Impl::set_up(const QuadraticProgram& problem) {
  const double infinity = std::numeric_limits<double>::infinity();
  fixed.assign(problem.variables(), 0);
  for (int i = 0; i < problem.variables(); ++i) fixed[i] = problem.x_lower(i) == problem.x_upper(i);
  rows.assign(problem.rows(), RowKind::inequality);
  for (int r = 0; r < problem.rows(); ++r) {
    if (problem.row_lower(r) == problem.row_upper(r))
      rows[r] = RowKind::equation;
    else if (problem.row_lower(r) == -infinity && problem.row_upper(r) == infinity)
      rows[r] = RowKind::unbounded;
  }
  scaling.compute(problem, fixed, rows);
  scaling.apply(problem, p);
  kkt.set_up(p, fixed, rows);
  lower.index.clear();
  upper.index.clear();
  const auto add = [&](int i, double low, double high) {
    if (std::isfinite(low)) lower.index.push_back(i);
    if (std::isfinite(high)) upper.index.push_back(i);
  };
  for (int i = 0; i < n(); ++i)
    if (!fixed[i]) add(i, p.x_lower(i), p.x_upper(i));
  for (int r = 0; r < m(); ++r)
    if (rows[r] == RowKind::inequality) add(n() + r, p.row_lower(r), p.row_upper(r));
  lower.resize();
  upper.resize();
  const auto bound_of = [&](int i, const VectorXd& x, const VectorXd& row) {
    return i < n() ? x(i) : row(i - n());
  };
  for (std::size_t k = 0; k < lower.index.size(); ++k)
    lower.bound(k) = bound_of(lower.index[k], p.x_lower, p.row_lower);
  for (std::size_t k = 0; k < upper.index.size(); ++k)
    upper.bound(k) = bound_of(upper.index[k], p.x_upper, p.row_upper);
  w.setZero(n() + m());
  y.setZero(m());
}

// Mehrotra's start: the least-squares point with unit weights on the slacks, moved inside.
void InteriorPoint::Impl::start_cold() {
  lower.t.setOnes();
  lower.z.setOnes();
  upper.t.setOnes();
  upper.z.setOnes();
  for (int i = 0; i < n(); ++i)
    if (fixed[i]) w(i) = p.x_lower(i);
  for (const BoundSide* side : {&lower, &upper})
    for (std::size_t k = 0; k < side->index.size(); ++k)
      if (const double b = side->bound(k);
          side == &lower ? w(side->index[k]) < b : w(side->index[k]) > b)
        w(side->index[k]) = b;
  if (!factorise()) return;
  compute_residuals();
  direction(0.0, false);
  w += dw;
  y += dy;
  place_slacks(1.0);
}

// Slacks from the point, at least `floor`; multipliers alike.
void InteriorPoint::Impl::place_slacks(double floor) {
  for (Eigen::Index k = 0; k < lower.t.size(); ++k)
    lower.t(k) = std::max(w(lower.index[k]) - lower.bound(k), floor);
  for (Eigen::Index k = 0; k < upper.t.size(); ++k)
    upper.t(k) = std::max(upper.bound(k) - w(upper.index[k]), floor);
  for (BoundSide* side : {&lower, &upper}) side->z = side->z.cwiseMax(floor);
}

void InteriorPoint::Impl::start_warm(const QuadraticProgram& problem,
                                     const QuadraticWarmStart& warm) {
  w.head(n()) = scaling.scaled_x(warm.x);
  for (int i = 0; i < n(); ++i)
    if (fixed[i]) w(i) = p.x_lower(i);
  w.tail(m()) = p.jacobian * w.head(n());
  y = warm.row_multipliers.size() == m() ? scaling.scaled_row_multipliers(warm.row_multipliers)
                                         : VectorXd(VectorXd::Zero(m()));
  const VectorXd bounds = warm.bound_multipliers.size() == problem.variables()
                              ? scaling.scaled_bound_multipliers(warm.bound_multipliers)
                              : VectorXd(VectorXd::Zero(n()));
  for (BoundSide* side : {&lower, &upper})
    for (Eigen::Index k = 0; k < side->z.size(); ++k) {
      const int i = side->index[k];
      const double multiplier = i < n() ? bounds(i) : y(i - n());
      side->z(k) = std::max(0.0, side == &lower ? multiplier : -multiplier);
    }
  place_slacks(kWarmFloor);
  // Centred: of slack and multiplier the smaller gives way until their product is kWarmCentre, or a
  // bound that changes sides would hold up every step.
  for (BoundSide* side : {&lower, &upper})
    for (Eigen::Index k = 0; k < side->z.size(); ++k) {
      double &t = side->t(k), &z = side->z(k);
      if (t * z >= kWarmCentre) continue;
      (t > z ? z : t) = kWarmCentre / std::max(t, z);
    }
}

void InteriorPoint::Impl::compute_residuals() {
  const auto x = w.head(n());
  dual = -(p.hessian.selfadjointView<Eigen::Lower>() * x) - p.gradient;
  dual += p.jacobian.transpose() * y;
  slack_dual = -y;
  primal = -(p.jacobian * x);
  for (int r = 0; r < m(); ++r) {
    if (rows[r] == RowKind::equation)
      primal(r) += p.row_lower(r);
    else if (rows[r] == RowKind::inequality)
      primal(r) += w(n() + r);
    else
      primal(r) = 0.0;
    if (rows[r] != RowKind::inequality) slack_dual(r) = 0.0;
  }
  const auto push = [&](int i, double z) { (i < n() ? dual(i) : slack_dual(i - n())) += z; };
  for (Eigen::Index k = 0; k < lower.t.size(); ++k) {
    push(lower.index[k], lower.z(k));
    lower.residual(k) = lower.bound(k) + lower.t(k) - w(lower.index[k]);
  }
  for (Eigen::Index k = 0; k < upper.t.size(); ++k) {
    push(upper.index[k], -upper.z(k));
    upper.residual(k) = upper.bound(k) - upper.t(k) - w(upper.index[k]);
  }
  for (int i = 0; i < n(); ++i)
    if (fixed[i]) dual(i) = 0.0;
}

double InteriorPoint::Impl::complementarity() const {
  const Eigen::Index count = lower.t.size() + upper.t.size();
  return count ? (lower.t.dot(lower.z) + upper.t.dot(upper.z)) / static_cast<double>(count) : 0.0;
}

bool InteriorPoint::Impl::factorise() {
  diagonal.setZero(n() + m());
  for (const BoundSide* side : {&lower, &upper})
    for (Eigen::Index k = 0; k < side->t.size(); ++k)
      diagonal(side->index[k]) += side->z(k) / side->t(k);
  return kkt.factorise(diagonal);
}

// Newton direction towards t z = target, with Mehrotra's second-order correction from the direction
// before if `corrected`.
void InteriorPoint::Impl::direction(double target, bool corrected) {
  VectorXd right(n() + m());
  right.head(n()) = dual;
  VectorXd slack = slack_dual;
  const auto add = [&](int i, double v) { (i < n() ? right(i) : slack(i - n())) += v; };
  for (BoundSide* side : {&lower, &upper}) {
    side->complement = -side->t.cwiseProduct(side->z).array() + target;
    if (corrected) side->complement -= side->dt.cwiseProduct(side->dz);
  }
  for (Eigen::Index k = 0; k < lower.t.size(); ++k)
    add(lower.index[k], (lower.complement(k) + lower.z(k) * lower.residual(k)) / lower.t(k));
  for (Eigen::Index k = 0; k < upper.t.size(); ++k)
    add(upper.index[k], -(upper.complement(k) - upper.z(k) * upper.residual(k)) / upper.t(k));
  for (int r = 0; r < m(); ++r)
    right(n() + r) = rows[r] == RowKind::inequality ? primal(r) + slack(r) / diagonal(n() + r)
                     : rows[r] == RowKind::equation ? primal(r)
                                                    : 0.0;
  for (int i = 0; i < n(); ++i)
    if (fixed[i]) right(i) = 0.0;
  const VectorXd solution = kkt.solve(right);
  dw.resize(n() + m());
  dw.head(n()) = solution.head(n());
  dy = -solution.tail(m());
  for (int r = 0; r < m(); ++r)
    dw(n() + r) = rows[r] == RowKind::inequality ? (slack(r) - dy(r)) / diagonal(n() + r) : 0.0;
  for (Eigen::Index k = 0; k < lower.t.size(); ++k) {
    lower.dt(k) = dw(lower.index[k]) - lower.residual(k);
    lower.dz(k) = (lower.complement(k) - lower.z(k) * lower.dt(k)) / lower.t(k);
  }
  for (Eigen::Index k = 0; k < upper.t.size(); ++k) {
    upper.dt(k) = upper.residual(k) - dw(upper.index[k]);
    upper.dz(k) = (upper.complement(k) - upper.z(k) * upper.dt(k)) / upper.t(k);
  }
}

double InteriorPoint::Impl::step_length() const {
  double step = 1.0;
  for (const BoundSide* side : {&lower, &upper})
    step =
        std::min({step, step_to_boundary(side->t, side->dt), step_to_boundary(side->z, side->dz)});
  return step;
}

void InteriorPoint::Impl::move(double step) {
  w += step * dw;
  y += step * dy;
  for (BoundSide* side : {&lower, &upper}) {
    side->t += step * side->dt;
    side->z += step * side->dz;
  }
}

QuadraticResult InteriorPoint::Impl::unscaled(const QuadraticProgram& problem,
                                              QuadraticResiduals& r) const {
  QuadraticResult result;
  result.x = scaling.unscaled_x(w.head(n()));
  for (int i = 0; i < n(); ++i)
    if (fixed[i]) result.x(i) = problem.x_lower(i);
  VectorXd z = VectorXd::Zero(n());
  for (const BoundSide* side : {&lower, &upper})
    for (Eigen::Index k = 0; k < side->z.size(); ++k)
      if (side->index[k] < n()) z(side->index[k]) += side == &lower ? side->z(k) : -side->z(k);
  result.row_multipliers = scaling.unscaled_row_multipliers(y);
  result.bound_multipliers = scaling.unscaled_bound_multipliers(z);
  // A fixed variable's bound takes up whatever is left of its dual row.
  const VectorXd left = problem.hessian.selfadjointView<Eigen::Lower>() * result.x +
                        problem.gradient - problem.jacobian.transpose() * result.row_multipliers;
  for (int i = 0; i < n(); ++i)
    if (fixed[i]) result.bound_multipliers(i) = left(i);
  r = residuals(problem, result.x, result.row_multipliers, result.bound_multipliers);
  result.primal_residual = r.primal;
  result.dual_residual = r.dual;
  result.gap = r.gap;
  return result;
}

QuadraticStatus InteriorPoint::Impl::iterate(const QuadraticProgram& problem,
                                             const InteriorPointOptions& options, Effort effort,
                                             QuadraticResult& best) {
  const int patience = effort == Effort::first ? kPatience : options.iteration_limit;
  int stalls = 0, progress_at = 0;
  double progress = std::numeric_limits<double>::infinity();
  double best_merit = std::numeric_limits<double>::infinity();
  bool drawn = false;
  for (int iteration = 0;; ++iteration) {
    QuadraticResiduals r;
    QuadraticResult now = unscaled(problem, r);
    now.iterations = iteration;
    const double merit = std::max({now.primal_residual, now.dual_residual, now.gap});
    if (iteration == 0 || merit < best_merit) {
      best_merit = merit;
      best = now;
    }
    best.iterations = iteration;
    if (merit < kProgress * progress) progress = merit, progress_at = iteration;
    if (!std::isfinite(merit)) return QuadraticStatus::numerical_error;
    if (r.within(options.tolerance)) {
      best = now;
      return QuadraticStatus::optimal;
    }
    if (is_infeasibility_certificate(problem, now)) {
      best = now;
      return QuadraticStatus::infeasible;
    }
    if (is_unbounded_ray(problem, now.x)) {
      best = now;
      return QuadraticStatus::unbounded;
    }
    if (options.early && !drawn && iteration > 0 && now.primal_residual <= kNear) {
      options.early(now.x);
      drawn = true;
    }
    if (options.cancellation && options.cancellation->cancelled())
      return QuadraticStatus::cancelled;
    if (iteration >= options.iteration_limit || iteration - progress_at > patience)
      return QuadraticStatus::iteration_limit;
    if (!factorise()) return QuadraticStatus::numerical_error;
    if (options.cancellation && options.cancellation->cancelled())
      return QuadraticStatus::cancelled;
    compute_residuals();
    const double mu = complementarity();
    direction(0.0, false);
    const double affine = step_length();
    double after = 0;
    for (const BoundSide* side : {&lower, &upper})
      after += (side->t + affine * side->dt).dot(side->z + affine * side->dz);
    const auto count = static_cast<double>(lower.t.size() + upper.t.size());
    if (count > 0) {
      const double ratio = after / (count * mu);
      const bool circles = effort == Effort::careful && iteration - progress_at >= kCircles;
      const double share = std::min(1.0, ratio * ratio * ratio);
      direction(std::max(kLeastTarget, mu * (circles ? std::max(share, kCentred) : share)),
                !circles);
    }
    const double step = count > 0 ? std::min(1.0, kToBoundary * step_length()) : 1.0;
    stalls = step < kSmallestStep ? stalls + 1 : 0;
    if (stalls >= kStalls) return QuadraticStatus::numerical_error;
    move(step);
  }
}

QuadraticResult InteriorPoint::solve(const QuadraticProgram& problem,
                                     const InteriorPointOptions& options,
                                     const std::optional<QuadraticWarmStart>& warm_start) {
  const int n = problem.variables(), m = problem.rows();
  if (problem.hessian.rows() != n || problem.hessian.cols() != n || problem.jacobian.cols() != n ||
      problem.row_lower.size() != m || problem.row_upper.size() != m ||
      problem.x_lower.size() != n || problem.x_upper.size() != n)
    throw Error("quadratic program: dimensions disagree");
  if (!problem.gradient.allFinite() || !problem.hessian.coeffs().allFinite() ||
      !problem.jacobian.coeffs().allFinite() || problem.row_lower.hasNaN() ||
      problem.row_upper.hasNaN() || problem.x_lower.hasNaN() || problem.x_upper.hasNaN())
    throw Error("quadratic program: a number is not finite");
  QuadraticResult result;
  const bool crossed = (problem.x_lower.array() > problem.x_upper.array()).any() ||
                       (problem.row_lower.array() > problem.row_upper.array()).any();
  if (crossed) {
    result.status = QuadraticStatus::infeasible;
    result.x = VectorXd::Zero(n);
    result.row_multipliers = VectorXd::Zero(m);
    result.bound_multipliers = VectorXd::Zero(n);
    return result;
  }
  impl_->solve(problem, options, warm_start, Effort::first, result);
  const auto undecided = [&] {
    return result.status == QuadraticStatus::iteration_limit ||
           result.status == QuadraticStatus::numerical_error;
  };
  if (undecided() && m > 0) {
    QuadraticResult proof;
    if (Impl::contradicts(problem, options, proof)) {
      proof.iterations += result.iterations;
      return proof;
    }
  }
  for (const Effort effort : {Effort::patient, Effort::careful}) {
    if (!undecided()) break;
    const int spent = result.iterations;
    impl_->solve(problem, options, {}, effort, result);
    result.iterations += spent;
  }
  return result;
}

void InteriorPoint::Impl::solve(const QuadraticProgram& problem,
                                const InteriorPointOptions& options,
                                const std::optional<QuadraticWarmStart>& warm_start, Effort effort,
                                QuadraticResult& result) {
  set_up(problem);
  if (warm_start && warm_start->x.size() == n() && warm_start->x.allFinite() &&
      warm_start->row_multipliers.allFinite() && warm_start->bound_multipliers.allFinite())
    start_warm(problem, *warm_start);
  else
    start_cold();
  result.status = iterate(problem, options, effort, result);
}

// The least sum of violations of the rows within the bounds: where it is not zero, its multipliers
// are a certificate that nothing meets them.
bool InteriorPoint::Impl::contradicts(const QuadraticProgram& problem,
                                      const InteriorPointOptions& options, QuadraticResult& proof) {
  QuadraticProgram rows_only = problem;
  rows_only.hessian.setZero();
  rows_only.gradient.setZero();
  const ElasticProgram elastic = make_elastic(rows_only, 0, false, 1.0);
  InteriorPointOptions again = options;
  again.iteration_limit = std::max(options.iteration_limit, 100);
  Impl phase_one;
  QuadraticResult result;
  phase_one.solve(elastic.program, again, {}, Effort::first, result);
  proof = result;
  proof.status = QuadraticStatus::infeasible;
  proof.x = result.x.head(problem.variables());
  proof.bound_multipliers = result.bound_multipliers.head(problem.variables());
  return is_infeasibility_certificate(problem, proof);
}

}  // namespace lapwing
