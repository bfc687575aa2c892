// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/nonlinear_interior_point.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "framework/core/log.h"
#include "framework/solve/elastic_rows.h"
#include "framework/solve/equilibration.h"
#include "framework/solve/kkt_system.h"
#include "framework/solve/step_filter.h"

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kPush = 1e-2;             // of the start from its bounds, and share of their gap
constexpr double kShareToBoundary = 0.99;  // least share of the step to the boundary
constexpr double kBarrierFactor = 0.2;     // of the barrier parameter, or its power
constexpr double kBarrierPower = 1.5;
constexpr double kSolved = 10.0;    // times the parameter: a barrier problem is solved
constexpr double kKeptNear = 1e10;  // of multipliers to barrier parameter / slack
constexpr double kFirstShift = 1e-4, kLeastShift = 1e-20, kMostShift = 1e20;
constexpr double kRefined = 1e-7;                // relative residual of a direction
constexpr double kShorter = 0.5, kLonger = 1.0;  // change of a free time in a step, as a share
constexpr double kShortestStep = 1e-7;
constexpr int kCorrections = 2;
constexpr double kWorseScale = 100.0;  // mean multiplier from which errors are relative
constexpr double kLeastPenalty = 10.0, kMostPenalty = 1e6;
constexpr double kPenaltyFactor = 10.0;  // over the largest multiplier
constexpr int kMostFailures = 3;         // failures of the line search until it ends

// One side of all bounds, in scaled numbers.
struct Side {
  std::vector<int> index;  // into (x, s)
  VectorXd bound, t, z, dt, dz;
  double sign = 1;  // of the distance: (x - bound) sign = t
};

class NonlinearSolve {
 public:
  NonlinearSolve(const TrajectoryProblem& problem, const SolveRequest& request,
                 const NonlinearOptions& options, SolveRecord& record)
      : problem_(problem),
        request_(request),
        options_(options),
        record_(record),
        at_(record.start()) {
    lower_.sign = 1;
    upper_.sign = -1;
  }

  NonlinearOutcome run();

 private:
  struct Trial {
    Stages at;
    VectorXd values;  // scaled rows
    std::vector<TermCost> terms;
    double cost = 0, violation = 0, barrier_cost = 0;
  };

  bool set_up();
  void place_inside();
  void linearise();
  void scaled_program();
  void set_slacks();
  SolveStatus iterate();
  void say(int iteration, double alpha) const;
  std::optional<SolveStatus> converged();
  double error(double barrier) const;
  bool direction();
  bool factorise();
  void solve_for(const VectorXd& primal, bool corrected);
  double longest(bool of_multipliers) const;
  double within_times(double alpha) const;
  Trial trial(double alpha) const;
  bool line_search(double& alpha);
  void take(const Trial& trial, double alpha, double of_multipliers);
  void make_elastic();
  void residuals();
  double violation_of(const VectorXd& values, double alpha) const;
  int count() const { return static_cast<int>(lower_.t.size() + upper_.t.size()); }
  int n() const { return p_.variables(); }
  int m() const { return p_.rows(); }
  double unscaled_violation() const { return worst_row_violation(model_, model_.values); }

  const TrajectoryProblem& problem_;
  const SolveRequest& request_;
  const NonlinearOptions& options_;
  SolveRecord& record_;
  Stages at_, best_;
  std::vector<TermCost> terms_;  // of the point
  double best_cost_ = std::numeric_limits<double>::infinity();
  LocalModel model_;
  QuadraticProgram program_, p_;
  Equilibration scaling_;
  KktSystem kkt_;
  std::vector<RowKind> rows_, solved_rows_;
  std::vector<char> fixed_;
  Side lower_, upper_;
  VectorXd values_, s_, y_;              // scaled
  VectorXd dx_, ds_, dy_;                // direction
  VectorXd dual_, slack_dual_, primal_;  // residuals
  VectorXd diagonal_;
  ElasticRows elastic_;
  double barrier_ = 0, shift_ = 0, last_shift_ = 0;
  StepFilter filter_;
  NonlinearOutcome outcome_;
};

NonlinearOutcome NonlinearSolve::run() {
  if (set_up()) {
    record_.add(at_, 0.0);
    outcome_.status = iterate();
  } else {
    outcome_.status = SolveStatus::infeasible;
  }
  WarmStart& point = outcome_.point;
  point.stages = at_;
  const bool met = unscaled_violation() <= options_.feasibility;
  const bool ended = outcome_.status == SolveStatus::optimal;
  if (!ended && best_.size() > 0 && (!met || best_cost_ < problem_.cost(at_))) point.stages = best_;
  if (outcome_.status == SolveStatus::numerical_error && best_.size() > 0)
    outcome_.status = SolveStatus::feasible;
  if (outcome_.status == SolveStatus::infeasible && outcome_.message.empty())
    outcome_.message = say_missed(problem_.violations(point.stages));
  if (y_.size() == problem_.rows()) {
    point.row_multipliers = scaling_.unscaled_row_multipliers(y_);
    VectorXd z = VectorXd::Zero(problem_.columns());
    for (const Side* side : {&lower_, &upper_})
      for (std::size_t k = 0; k < side->index.size(); ++k)
        if (side->index[k] < n()) z(side->index[k]) += side->sign * side->z(k);
    point.bound_multipliers = scaling_.unscaled_bound_multipliers(z);
  }
  return outcome_;
}

// False where bounds contradict each other.
bool NonlinearSolve::set_up() {
  problem_.linearise(at_, model_);
  outcome_.message = say_crossed(problem_, model_);
  if (!outcome_.message.empty()) return false;
  const double infinity = std::numeric_limits<double>::infinity();
  const int columns = problem_.columns(), rows = problem_.rows();
  fixed_.assign(columns, 0);
  for (int c = 0; c < columns; ++c) fixed_[c] = model_.step_lower(c) == model_.step_upper(c);
  rows_.assign(rows, RowKind::inequality);
  for (int r = 0; r < rows; ++r) {
    if (model_.row_lower(r) == model_.row_upper(r))
      rows_[r] = RowKind::equation;
    else if (model_.row_lower(r) == -infinity && model_.row_upper(r) == infinity)
      rows_[r] = RowKind::unbounded;
  }
  scaled_program();
  scaling_.compute(program_, fixed_, rows_);
  scaling_.apply(program_, p_);
  place_inside();
  y_.setZero(rows);
  if (record_.warm_multipliers())
    y_ = scaling_.scaled_row_multipliers(request_.warm_start->row_multipliers);
  linearise();
  const auto add = [&](int i, double low, double high) {
    if (std::isfinite(low)) lower_.index.push_back(i);
    if (std::isfinite(high)) upper_.index.push_back(i);
  };
  for (int i = 0; i < n(); ++i)
    if (!fixed_[i]) add(i, p_.x_lower(i), p_.x_upper(i));
  for (int r = 0; r < m(); ++r)
    if (rows_[r] == RowKind::inequality) add(n() + r, p_.row_lower(r), p_.row_upper(r));
  s_ = values_;
  for (int r = 0; r < m(); ++r) {
    if (rows_[r] != RowKind::inequality) continue;
    const double low = p_.row_lower(r), up = p_.row_upper(r);
    const double push = kPush * std::min({1.0, up - low});
    s_(r) = std::max(s_(r), low + push);
    s_(r) = std::min(s_(r), up - push);
  }
  barrier_ = options_.first_barrier;
  for (Side* side : {&lower_, &upper_}) {
    const auto size = static_cast<Eigen::Index>(side->index.size());
    for (VectorXd* v : {&side->bound, &side->t, &side->z, &side->dt, &side->dz}) v->setZero(size);
  }
  set_slacks();
  for (Side* side : {&lower_, &upper_}) side->z = barrier_ * side->t.cwiseInverse();
  residuals();
  filter_.reset(violation_of(values_, 0));
  return true;
}

void NonlinearSolve::scaled_program() {
  program_.hessian = model_.hessian;
  program_.gradient = model_.gradient;
  program_.jacobian = model_.jacobian;
  program_.row_lower = model_.row_lower;
  program_.row_upper = model_.row_upper;
  program_.x_lower = model_.step_lower;
  program_.x_upper = model_.step_upper;
}

void NonlinearSolve::place_inside() {
  VectorXd d = VectorXd::Zero(n());
  for (int i = 0; i < n(); ++i) {
    const double low = p_.x_lower(i), up = p_.x_upper(i);
    if (fixed_[i]) {
      d(i) = low;
      continue;
    }
    const double push = kPush * std::min(1.0, up - low);
    d(i) = std::min(std::max(0.0, low + push), up - push);
  }
  at_ = problem_.retract(at_, scaling_.unscaled_x(d));
}

void NonlinearSolve::linearise() {
  const VectorXd multipliers = -scaling_.unscaled_row_multipliers(y_);
  problem_.linearise(at_, model_, Curvature::exact, &multipliers);
  scaled_program();
  scaling_.apply(program_, p_);
  values_ = model_.values.cwiseProduct(scaling_.row_factors());
}

// Distances from the bounds at the point.
void NonlinearSolve::set_slacks() {
  for (Side* side : {&lower_, &upper_}) {
    const bool low = side == &lower_;
    for (std::size_t k = 0; k < side->index.size(); ++k) {
      const int i = side->index[k];
      const double bound = i < n() ? (low ? p_.x_lower(i) : p_.x_upper(i))
                                   : (low ? p_.row_lower(i - n()) : p_.row_upper(i - n()));
      const double x = i < n() ? 0.0 : s_(i - n());
      side->t(k) = std::max(side->sign * (x - bound), 1e-14);
    }
  }
}

void NonlinearSolve::residuals() {
  dual_ = p_.jacobian.transpose() * y_ - p_.gradient;
  slack_dual_ = -y_;
  primal_.resize(m());
  for (int r = 0; r < m(); ++r) {
    if (rows_[r] == RowKind::equation)
      primal_(r) = p_.row_lower(r) - values_(r);
    else if (rows_[r] == RowKind::inequality)
      primal_(r) = s_(r) - values_(r);
    else
      primal_(r) = 0.0;
    if (rows_[r] != RowKind::inequality) slack_dual_(r) = 0.0;
    if (elastic_.active() && rows_[r] != RowKind::unbounded) primal_(r) -= elastic_.miss(r);
  }
  for (const Side* side : {&lower_, &upper_})
    for (std::size_t k = 0; k < side->index.size(); ++k) {
      const int i = side->index[k];
      (i < n() ? dual_(i) : slack_dual_(i - n())) += side->sign * side->z(k);
    }
  for (int i = 0; i < n(); ++i)
    if (fixed_[i]) dual_(i) = 0.0;
}

// Scaled optimality error of the barrier problem.
double NonlinearSolve::error(double barrier) const {
  double sum = y_.lpNorm<1>(), of_bounds = 0, worst = 0;
  for (const Side* side : {&lower_, &upper_}) {
    of_bounds += side->z.sum();
    if (side->t.size())
      worst = std::max(worst, (side->t.cwiseProduct(side->z).array() - barrier).abs().maxCoeff());
  }
  if (elastic_.active()) worst = std::max(worst, elastic_.deviation(barrier));
  const double scale = std::max(kWorseScale, (sum + of_bounds) / (m() + count() + 1)) / kWorseScale;
  const double dual =
      std::max(dual_.lpNorm<Eigen::Infinity>(), m() ? slack_dual_.lpNorm<Eigen::Infinity>() : 0.0);
  return std::max({dual / scale, m() ? primal_.lpNorm<Eigen::Infinity>() : 0.0, worst / scale});
}

// Reduces the barrier parameter while its problem is solved; a status at the end of all.
std::optional<SolveStatus> NonlinearSolve::converged() {
  const double violation = unscaled_violation();
  if (violation <= options_.feasibility && model_.cost < best_cost_) {
    best_ = at_;
    best_cost_ = model_.cost;
  }
  const double allowed = scaling_.cost_factor() * options_.tolerance * (1 + std::abs(model_.cost));
  const double least = std::max(0.1 * allowed / std::max(1, count()), 1e-13);
  const double total = lower_.t.dot(lower_.z) + upper_.t.dot(upper_.z);
  if (error(0.0) <= 10 * options_.tolerance && total <= allowed) {
    if (violation <= options_.feasibility) return SolveStatus::optimal;
    if (elastic_.active() && barrier_ <= least) {
      if (elastic_.penalty() >= kMostPenalty) return SolveStatus::infeasible;
      make_elastic();  // rows may be missed because it costs too little
      return {};
    }
  }
  bool reduced = false;
  while (barrier_ > least && error(barrier_) <= kSolved * barrier_) {
    barrier_ =
        std::max(least, std::min(kBarrierFactor * barrier_, std::pow(barrier_, kBarrierPower)));
    reduced = true;
  }
  if (reduced) filter_.reset(violation_of(values_, 0));
  return {};
}

SolveStatus NonlinearSolve::iterate() {
  int failures = 0;
  for (int k = 1;; ++k) {
    if (const auto end = converged()) return *end;
    if (const auto stop = record_.stopped()) return *stop;
    if (k > options_.iteration_limit) return SolveStatus::iteration_limit;
    if (request_.progress)
      request_.progress->report(-1.0, "interior-point iteration " + std::to_string(k));
    double alpha = 0;
    const bool found = direction() && line_search(alpha);
    if (!found) {
      if (++failures > kMostFailures) {
        // That is no proof that there is no trajectory; `converged` has one where rows are elastic.
        outcome_.message = "no step improves the trajectory further";
        return SolveStatus::numerical_error;
      }
      make_elastic();
      continue;
    }
    outcome_.iterations = k;
    linearise();
    record_.add(at_, terms_, unscaled_violation(), alpha);
    set_slacks();
    residuals();
    say(k, alpha);
  }
}

// A line of the log.
void NonlinearSolve::say(int iteration, double alpha) const {
  char line[160];
  std::snprintf(
      line, sizeof line,
      "iqp: %4d%c cost %.9g  missed %.1e  error %.1e  barrier %.1e  shift %.1e  step %.2g",
      iteration, elastic_.active() ? 'e' : ' ', model_.cost, unscaled_violation(), error(0.0),
      barrier_, shift_, alpha);
  logging::debug(line);
}

bool NonlinearSolve::factorise() {
  diagonal_.setZero(n() + m());
  for (const Side* side : {&lower_, &upper_})
    for (std::size_t k = 0; k < side->index.size(); ++k)
      diagonal_(side->index[k]) += side->z(k) / side->t(k);
  solved_rows_ = rows_;
  VectorXd whole = diagonal_;
  if (elastic_.active()) {
    for (int r = 0; r < m(); ++r) {
      if (rows_[r] == RowKind::unbounded) continue;
      const double soft = rows_[r] == RowKind::inequality ? 1.0 / diagonal_(n() + r) : 0.0;
      whole(n() + r) = 1.0 / (soft + elastic_.relief(r));
      solved_rows_[r] = RowKind::inequality;
    }
  }
  kkt_.set_up(p_, fixed_, solved_rows_);
  shift_ = 0;
  for (;;) {
    VectorXd shifted = whole;
    shifted.head(n()).array() += shift_;
    if (kkt_.factorise(shifted) && kkt_.negative_pivots() == m()) break;
    if (shift_ == 0)
      shift_ = last_shift_ == 0 ? kFirstShift : std::max(kLeastShift, last_shift_ / 3);
    else
      shift_ *= last_shift_ == 0 ? 100 : 8;
    if (shift_ > kMostShift) return false;
  }
  if (shift_ > 0) last_shift_ = shift_;
  return true;
}

bool NonlinearSolve::direction() {
  if (!factorise()) return false;
  solve_for(primal_, false);
  return dx_.allFinite() && dy_.allFinite();
}

// The step towards rows that are `primal` away, and of multipliers unless `corrected`.
void NonlinearSolve::solve_for(const VectorXd& primal, bool corrected) {
  VectorXd right(n() + m());
  right.head(n()) = dual_;
  VectorXd slack = slack_dual_;
  for (const Side* side : {&lower_, &upper_})
    for (std::size_t k = 0; k < side->index.size(); ++k) {
      const int i = side->index[k];
      const double push = side->sign * (barrier_ / side->t(k) - side->z(k));
      (i < n() ? right(i) : slack(i - n())) += push;
    }
  for (int r = 0; r < m(); ++r) {
    double value = rows_[r] == RowKind::unbounded ? 0.0 : primal(r);
    if (rows_[r] == RowKind::inequality) value += slack(r) / diagonal_(n() + r);
    if (elastic_.active() && rows_[r] != RowKind::unbounded)
      value += elastic_.aim(r, y_(r), barrier_);
    right(n() + r) = value;
  }
  for (int i = 0; i < n(); ++i)
    if (fixed_[i]) right(i) = 0.0;
  const VectorXd solution = kkt_.solve(right, kRefined);
  dx_ = solution.head(n());
  dy_ = -solution.tail(m());
  ds_.setZero(m());
  for (int r = 0; r < m(); ++r)
    if (rows_[r] == RowKind::inequality) ds_(r) = (slack(r) - dy_(r)) / diagonal_(n() + r);
  if (elastic_.active()) elastic_.follow(y_, dy_);
  for (Side* side : {&lower_, &upper_})
    for (std::size_t k = 0; k < side->index.size(); ++k) {
      const int i = side->index[k];
      side->dt(k) = side->sign * (i < n() ? dx_(i) : ds_(i - n()));
      if (!corrected) side->dz(k) = (barrier_ - side->z(k) * side->dt(k)) / side->t(k) - side->z(k);
    }
}

double NonlinearSolve::longest(bool of_multipliers) const {
  const double share = std::max(kShareToBoundary, 1 - barrier_);
  double alpha = 1;
  const auto limit = [&](const VectorXd& v, const VectorXd& d) {
    for (Eigen::Index k = 0; k < v.size(); ++k)
      if (d(k) < 0) alpha = std::min(alpha, -share * v(k) / d(k));
  };
  for (const Side* side : {&lower_, &upper_})
    of_multipliers ? limit(side->z, side->dz) : limit(side->t, side->dt);
  if (elastic_.active()) elastic_.limit(of_multipliers, share, alpha);
  return of_multipliers ? alpha : within_times(alpha);
}

// The same length, or less where a free time would change by more than a model of it is worth:
// from a poor guess the whole step may shrink all times to nothing.
double NonlinearSolve::within_times(double alpha) const {
  if (!problem_.horizon().step_free) return alpha;
  const StageLayout& layout = problem_.layout();
  const int block = layout.index("step"), stages = problem_.horizon().stages;
  const VectorXd dx = scaling_.unscaled_x(dx_);
  for (int i = 0; i < stages; ++i) {  // with free times every number has a column
    const double time = at_(layout.offset(block), i);
    const double change = dx(i * (n() / stages) + layout.tangent_offset(block)) / time;
    if (change < 0) alpha = std::min(alpha, -kShorter / change);
    if (change > 0) alpha = std::min(alpha, kLonger / change);
  }
  return alpha;
}

// Sum of what rows are away from their slacks, these a share of the step further.
double NonlinearSolve::violation_of(const VectorXd& values, double alpha) const {
  double sum = 0;
  for (int r = 0; r < m(); ++r) {
    if (rows_[r] == RowKind::unbounded) continue;
    double away =
        values(r) - (rows_[r] == RowKind::equation ? p_.row_lower(r)
                                                   : s_(r) + (alpha != 0 ? alpha * ds_(r) : 0.0));
    if (elastic_.active()) {
      away += elastic_.miss(r);
      if (alpha != 0) away += alpha * elastic_.change_of_miss(r);
    }
    sum += std::abs(away);
  }
  return sum;
}

NonlinearSolve::Trial NonlinearSolve::trial(double alpha) const {
  Trial result;
  result.at = alpha == 0 ? at_ : problem_.retract(at_, scaling_.unscaled_x(alpha * dx_));
  result.values =
      alpha == 0 ? values_
                 : VectorXd(problem_.row_values(result.at).cwiseProduct(scaling_.row_factors()));
  if (alpha == 0) {
    result.cost = model_.cost;
  } else {
    result.terms = problem_.term_costs(result.at);
    for (const TermCost& term : result.terms) result.cost += term.cost;
  }
  result.violation = violation_of(result.values, alpha);
  double logs = 0, sum = 0;
  const auto add = [&](const VectorXd& v, const VectorXd& d) {
    if (v.size() == 0) return;
    logs += alpha == 0 ? v.array().log().sum() : (v + alpha * d).array().log().sum();
  };
  add(lower_.t, lower_.dt);
  add(upper_.t, upper_.dt);
  if (elastic_.active()) elastic_.add_cost(alpha, logs, sum);
  result.barrier_cost =
      scaling_.cost_factor() * result.cost + elastic_.penalty() * sum - barrier_ * logs;
  return result;
}

bool NonlinearSolve::line_search(double& alpha) {
  const Trial here = trial(0);
  double slope = p_.gradient.dot(dx_);
  for (const Side* side : {&lower_, &upper_})
    slope -= barrier_ * side->dt.cwiseQuotient(side->t).sum();
  if (elastic_.active()) elastic_.add_slope(barrier_, slope);
  const double longest_step = longest(false), of_multipliers = longest(true);
  const VectorXd dy = dy_;
  const auto accepted = [&](const Trial& next, double length) {
    return filter_.accept(length, slope, here.violation, here.barrier_cost, next.violation,
                          next.barrier_cost);
  };
  for (alpha = longest_step; alpha > kShortestStep; alpha *= 0.5) {
    Trial next = trial(alpha);
    if (accepted(next, alpha)) {
      take(next, alpha, of_multipliers);
      return true;
    }
    if (alpha != longest_step || !(next.violation >= here.violation)) continue;
    // Second-order correction: the rows as they are at the end of the step.
    const VectorXd dx = dx_, ds = ds_;
    const ElasticRows::Steps elastic = elastic_.steps();
    const VectorXd dt_low = lower_.dt, dt_up = upper_.dt;
    VectorXd primal = primal_;
    double before = here.violation, length = alpha;
    for (int c = 0; c < kCorrections && next.violation < 1e3 * (1 + before); ++c) {
      for (int r = 0; r < m(); ++r) {
        if (rows_[r] == RowKind::unbounded) continue;
        double away = (rows_[r] == RowKind::equation ? p_.row_lower(r) : s_(r) + length * ds_(r)) -
                      next.values(r);
        if (elastic_.active()) away -= elastic_.miss(r) + length * elastic_.change_of_miss(r);
        primal(r) = length * primal(r) + away;
      }
      solve_for(primal, true);
      length = longest(false);
      next = trial(length);
      if (accepted(next, alpha)) {
        dy_ = dy;
        alpha = length;
        take(next, length, of_multipliers);
        return true;
      }
      if (next.violation > 0.99 * before) break;
      before = next.violation;
    }
    dx_ = dx;
    ds_ = ds;
    dy_ = dy;
    elastic_.set_steps(elastic);
    lower_.dt = dt_low;
    upper_.dt = dt_up;
  }
  return false;
}

void NonlinearSolve::take(const Trial& next, double alpha, double of_multipliers) {
  at_ = next.at;
  terms_ = next.terms;
  s_ += alpha * ds_;
  y_ += alpha * dy_;
  const auto keep = [&](double& z, double t) {
    z = std::clamp(z, barrier_ / (kKeptNear * t), kKeptNear * barrier_ / t);
  };
  for (Side* side : {&lower_, &upper_}) {
    side->t += alpha * side->dt;
    side->z += of_multipliers * side->dz;
    for (Eigen::Index k = 0; k < side->t.size(); ++k) keep(side->z(k), side->t(k));
  }
  if (!elastic_.active()) return;
  elastic_.take(alpha, of_multipliers);
  elastic_.keep(keep);
}

// From here on rows may be missed, at a price; or, where they may already, with fresh numbers.
void NonlinearSolve::make_elastic() {
  const double largest = m() ? y_.lpNorm<Eigen::Infinity>() : 0.0;
  const double penalty = std::clamp(kPenaltyFactor * largest,
                                    std::max(kLeastPenalty, elastic_.penalty()), kMostPenalty);
  y_.setZero();
  elastic_.end();
  residuals();
  const double worst = m() ? primal_.lpNorm<Eigen::Infinity>() : 0.0;
  barrier_ = std::clamp(worst, 10 * barrier_, std::max(0.1, 10 * barrier_));
  elastic_.begin(rows_, primal_, penalty, barrier_);
  for (Side* side : {&lower_, &upper_}) side->z = barrier_ * side->t.cwiseInverse();
  linearise();
  residuals();
  filter_.reset(violation_of(values_, 0));
}

}  // namespace

NonlinearOutcome solve_nonlinear(const TrajectoryProblem& problem, const SolveRequest& request,
                                 const NonlinearOptions& options, SolveRecord& record) {
  return NonlinearSolve(problem, request, options, record).run();
}

}  // namespace lapwing
