// SPDX-License-Identifier: Apache-2.0
// Algorithms of the NLopt library on the flown problem: its variables are the inputs and free
// blocks, the states follow by simulation and derivatives by one adjoint sweep. Limits other than
// plain bounds of variables go into an augmented Lagrangian, so that NLopt sees a smooth function
// of bounded variables, in coordinates in which it is nearly round.
//
//   solver: {type: nlopt, algorithm: LD_LBFGS}
#include <algorithm>
#include <cmath>
#include <map>

#include <nlopt.h>

#include "framework/plugin/plugin.h"
#include "framework/solve/solve_record.h"
#include "plugins/trajectory_solvers/nlopt/augmented_cost.h"
#include "plugins/trajectory_solvers/nlopt/penalties.h"
#include "plugins/trajectory_solvers/nlopt/reduced_problem.h"
#include "plugins/trajectory_solvers/nlopt/scaling.h"

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kFirstTolerance = 1e-3;  // of the first inner problems
constexpr double kDiagonal = 1e-6;        // stricter where coordinates are less round
constexpr double kRoundOff = 1e-15;       // promised decrease that means nothing
constexpr double kGain = 1e-3;            // of the first promised decrease that may be left
constexpr double kMet = 1e-6;             // in its own unit, what is called feasible
constexpr int kPatience = 4;              // updates without progress that prove infeasibility
constexpr double kProgress = 0.8;
constexpr double kOutweighed = 1e3;

struct Settings {
  int iterations = 0, cycle = 0, storage = 0;
  double tolerance = 0, feasibility = 0;
  nlopt_algorithm algorithm = NLOPT_LD_LBFGS;
  bool whole = true;
};

const std::map<std::string, nlopt_algorithm>& algorithms() {
  static const std::map<std::string, nlopt_algorithm> kAlgorithms{
      {"LD_LBFGS", NLOPT_LD_LBFGS},
      {"LD_VAR1", NLOPT_LD_VAR1},
      {"LD_VAR2", NLOPT_LD_VAR2},
      {"LD_TNEWTON", NLOPT_LD_TNEWTON},
      {"LD_TNEWTON_RESTART", NLOPT_LD_TNEWTON_RESTART},
      {"LD_TNEWTON_PRECOND", NLOPT_LD_TNEWTON_PRECOND},
      {"LD_TNEWTON_PRECOND_RESTART", NLOPT_LD_TNEWTON_PRECOND_RESTART},
      {"LD_MMA", NLOPT_LD_MMA},
      {"LD_CCSAQ", NLOPT_LD_CCSAQ}};
  return kAlgorithms;
}

class Nlopt final : public TrajectorySolver {
 public:
  static constexpr PluginText kText{
      "nlopt", "1.0.0", "gradient methods by single shooting, with an augmented Lagrangian",
      "Johnson, The NLopt nonlinear-optimization package"};
  static ParameterTable parameters() {
    std::vector<std::string> names{"LD_LBFGS"};
    for (const auto& [name, algorithm] : algorithms())
      if (name != names.front()) names.push_back(name);
    return ParameterTable{}
        .choice("algorithm", names.front(), names, "NLopt's name of the algorithm")
        .integer("iterations", 20000, "largest number of evaluations", between(1, 10000000))
        .number("tolerance", 1e-9, "",
                "predicted relative decrease of the cost that ends the solve", between(1e-14, 1e-2))
        .number("feasibility", 1e-7, "", "largest violation of a constraint, in its unit",
                between(1e-10, 1e-5))
        .choice("scaling", "whole", {"whole", "diagonal"},
                "change of variables by the full Gauss-Newton Hessian, or by its diagonal")
        .integer("cycle", 40, "evaluations after which the scaling is renewed", between(2, 100000))
        .integer("storage", 30, "number of stored steps of the method", between(1, 1000));
  }

  explicit Nlopt(const Parameters& parameters) {
    settings_.algorithm = algorithms().at(parameters.text("algorithm"));
    settings_.iterations = static_cast<int>(parameters.integer("iterations"));
    settings_.tolerance = parameters.number("tolerance");
    settings_.feasibility = parameters.number("feasibility");
    settings_.whole = parameters.text("scaling") == "whole";
    settings_.cycle = static_cast<int>(parameters.integer("cycle"));
    settings_.storage = static_cast<int>(parameters.integer("storage"));
  }

  SolveResult solve(const TrajectoryProblem& problem, const SolveRequest& request) const override;

 private:
  Settings settings_;
};

// Columns whose bounds the augmented cost looks after: with whole scaling all, as they are no
// bounds of variables there; else those that follow by simulation.
std::vector<int> limited_columns(const ReducedProblem& reduced, bool whole) {
  std::vector<int> result;
  if (whole) result = reduced.columns();
  for (int c = 0; c < reduced.problem().columns(); ++c)
    if (reduced.dependent(c)) result.push_back(c);
  std::sort(result.begin(), result.end());
  return result;
}

class Run {
 public:
  Run(const TrajectoryProblem& problem, const SolveRequest& request, const Settings& settings)
      : problem_(problem),
        request_(request),
        settings_(settings),
        record_(problem, request),
        reduced_(problem),
        whole_(settings.whole),
        augmented_(problem, limited_columns(reduced_, whole_)),
        scaling_(reduced_),
        limit_(request.iteration_limit.value_or(settings.iterations)) {}

  SolveResult solve();

 private:
  enum class Inner { converged, worn_out, stopped };

  void begin();
  void take_multipliers();
  void round();  // coordinates, at model_
  void first_step();
  SolveStatus iterate();
  bool hopeless(const std::vector<double>& violations) const;
  Inner minimise(double tolerance);
  void linearise(const Stages& at);
  double evaluate(const double* w, double* gradient);
  Stages inside_bounds(const Stages& at) const;
  WarmStart answer();
  std::string message(SolveStatus status, const Stages& at) const;

  const TrajectoryProblem& problem_;
  const SolveRequest& request_;
  const Settings& settings_;
  SolveRecord record_;
  ReducedProblem reduced_;
  bool whole_;
  AugmentedCost augmented_;
  Scaling scaling_;
  int limit_;
  Stages center_;  // of the coordinates: w = 0
  LocalModel model_;
  VectorXd gradient_;  // of the augmented cost in all columns
  double value_ = 0;
  int evaluations_ = 0;
  std::optional<SolveStatus> stop_;
  std::string crossed_;
  // of the inner problem
  nlopt_opt method_ = nullptr;
  VectorXd lower_, upper_;  // of w
  double inner_tolerance_ = 0, best_value_ = 0;
  double first_promised_ = 0, best_promised_ = 0;  // decrease, relative to the cost
  int inner_start_ = 0;
  Stages best_;
  bool inner_converged_ = false;
};

SolveResult Run::solve() {
  begin();
  SolveStatus status = SolveStatus::infeasible;
  if (crossed_.empty()) status = iterate();
  WarmStart point = answer();
  std::string text = message(status, point.stages);
  return record_.finish(status, std::move(text), evaluations_, std::move(point));
}

void Run::begin() {
  center_ = inside_bounds(record_.start());
  problem_.linearise(center_, model_);
  crossed_ = say_crossed(problem_, model_);
  stop_ = record_.stopped();
  if (!stop_ && limit_ <= 0) stop_ = SolveStatus::iteration_limit;
  if (stop_ || !crossed_.empty()) {
    center_ = problem_.simulate(center_);
    problem_.linearise(center_, model_);
    return;
  }
  take_multipliers();
  set_first_penalties(reduced_, model_, augmented_, scaling_);
  if (request_.warm_start)
    center_ = problem_.simulate(center_);
  else
    first_step();
}

void Run::take_multipliers() {
  if (!record_.warm_multipliers()) return;
  for (Limited& item : augmented_.limited())
    item.multiplier = item.is_row ? request_.warm_start->row_multipliers(item.index)
                                  : request_.warm_start->bound_multipliers(item.index);
}

void Run::round() {
  augmented_.prepare_hessian(model_);
  if (whole_)
    scaling_.set_whole(model_, augmented_);
  else
    scaling_.set_diagonal(model_, augmented_);
}

// The Gauss-Newton step at the guess itself, its dynamics linearised there: a path that no inputs
// of the guess fly still says where to begin.
void Run::first_step() {
  VectorXd product, all, reduced, gradient;
  augmented_.evaluate(model_, gradient);
  round();
  const VectorXd still = VectorXd::Zero(reduced_.size());
  reduced_.forward(model_, still, &model_.values, all);
  augmented_.hessian_times(model_, all, product);
  gradient += product;
  reduced_.backward(model_, gradient, reduced, nullptr);
  const VectorXd step = -scaling_.to_variables(scaling_.to_gradient(reduced));
  const Stages flown = inside_bounds(reduced_.fly(center_, step));
  center_ = problem_.simulate(flown.allFinite() ? flown : center_);
}

void Run::linearise(const Stages& at) {
  problem_.linearise(at, model_);
  value_ = augmented_.evaluate(model_, gradient_);
}

double Run::evaluate(const double* w, double* gradient) {
  if (!stop_) stop_ = record_.stopped();
  if (!stop_ && evaluations_ >= limit_) stop_ = SolveStatus::iteration_limit;
  if (stop_) {
    nlopt_force_stop(method_);
    return HUGE_VAL;
  }
  ++evaluations_;
  if (request_.progress)
    request_.progress->report(-1.0, "evaluation " + std::to_string(evaluations_));
  const int n = reduced_.size();
  const Eigen::Map<const VectorXd> at_w(w, n);
  const Stages at = reduced_.fly(center_, scaling_.to_variables(at_w));
  linearise(at);
  VectorXd reduced;
  reduced_.backward(model_, gradient_, reduced, nullptr);
  VectorXd slope = scaling_.to_gradient(reduced);
  if (gradient) Eigen::Map<VectorXd>(gradient, n) = slope;
  if (!std::isfinite(value_) || !slope.allFinite()) return HUGE_VAL;
  if (value_ > best_value_) return value_;
  best_value_ = value_;
  best_ = at;
  for (int k = 0; k < n; ++k)  // what a bound holds back is no slope
    if ((slope(k) > 0 && w[k] <= lower_(k)) || (slope(k) < 0 && w[k] >= upper_(k))) slope(k) = 0;
  const double promised = 0.5 * slope.squaredNorm() / (1.0 + std::abs(model_.cost));
  if (evaluations_ == inner_start_) first_promised_ = promised;
  best_promised_ = promised;
  // Multipliers learn nothing from a point that has not moved.
  inner_converged_ =
      promised <= inner_tolerance_ && promised <= std::max(kRoundOff, kGain * first_promised_);
  if (inner_converged_) nlopt_force_stop(method_);
  return value_;
}

Run::Inner Run::minimise(double tolerance) {
  linearise(center_);
  round();
  const int n = reduced_.size();
  lower_.setConstant(n, -HUGE_VAL);
  upper_.setConstant(n, HUGE_VAL);
  for (int k = 0; k < n && !whole_; ++k) {
    lower_(k) = std::min(0.0, model_.step_lower(reduced_.columns()[k]) * scaling_.roots()(k));
    upper_(k) = std::max(0.0, model_.step_upper(reduced_.columns()[k]) * scaling_.roots()(k));
  }
  inner_tolerance_ = whole_ ? tolerance : kDiagonal * tolerance;
  best_value_ = HUGE_VAL;
  inner_converged_ = false;
  inner_start_ = evaluations_ + 1;
  if (n == 0) return Inner::converged;
  method_ = nlopt_create(settings_.algorithm, n);
  nlopt_set_min_objective(
      method_,
      [](unsigned, const double* w, double* gradient, void* run) {
        return static_cast<Run*>(run)->evaluate(w, gradient);
      },
      this);
  nlopt_set_lower_bounds(method_, lower_.data());
  nlopt_set_upper_bounds(method_, upper_.data());
  nlopt_set_vector_storage(method_, settings_.storage);
  nlopt_set_maxeval(method_, settings_.cycle);
  VectorXd w = VectorXd::Zero(n);
  double value = 0;
  nlopt_optimize(method_, w.data(), &value);  // how it ends says little: the best point counts
  nlopt_destroy(method_);
  method_ = nullptr;
  if (std::isfinite(best_value_)) center_ = best_;
  if (stop_) return Inner::stopped;
  return inner_converged_ ? Inner::converged : Inner::worn_out;
}

// The violation stays although all that is asked for weighs next to nothing beside it.
bool Run::hopeless(const std::vector<double>& violations) const {
  const std::size_t n = violations.size();
  return n > kPatience && violations.back() > 10 * kMet &&
         violations.back() > kProgress * violations[n - 1 - kPatience] &&
         augmented_.violation_energy() > kOutweighed * (1.0 + std::abs(model_.cost));
}

SolveStatus Run::iterate() {
  double tolerance = std::max(settings_.tolerance, kFirstTolerance);
  double value_before = HUGE_VAL;
  std::vector<double> violations;
  while (!stop_) {
    const Inner inner = minimise(tolerance);
    record_.add(center_, 1.0);
    if (inner == Inner::stopped) break;
    if (inner == Inner::worn_out &&
        best_value_ < value_before - settings_.tolerance * (1.0 + std::abs(best_value_))) {
      value_before = best_value_;
      continue;  // in fresh coordinates
    }
    value_before = HUGE_VAL;
    linearise(center_);
    const double miss = augmented_.update();
    const bool least = best_promised_ <= (whole_ ? 1.0 : kDiagonal) * settings_.tolerance;
    if (miss <= settings_.feasibility && (least || inner == Inner::worn_out))
      return least ? SolveStatus::optimal : SolveStatus::feasible;
    violations.push_back(augmented_.worst_violation());
    if (hopeless(violations)) return SolveStatus::infeasible;
    augmented_.raise(settings_.feasibility);
    tolerance = std::max(settings_.tolerance, 0.1 * tolerance);
  }
  return *stop_;
}

Stages Run::inside_bounds(const Stages& at) const {
  LocalModel model;
  problem_.linearise(at, model);
  const VectorXd zero = VectorXd::Zero(problem_.columns());
  return problem_.retract(at, zero.cwiseMax(model.step_lower).cwiseMin(model.step_upper));
}

// Inputs exactly within their bounds, flown, with the multipliers of the Lagrangian.
WarmStart Run::answer() {
  WarmStart result;
  // Only what is left after the states: these follow.
  VectorXd step(reduced_.size());
  problem_.linearise(center_, model_);
  for (int k = 0; k < reduced_.size(); ++k) {
    const int c = reduced_.columns()[k];
    step(k) =
        std::clamp(0.0, model_.step_lower(c), std::max(model_.step_lower(c), model_.step_upper(c)));
  }
  result.stages = reduced_.fly(center_, step);
  problem_.linearise(result.stages, model_);
  result.row_multipliers.setZero(problem_.rows());
  result.bound_multipliers.setZero(problem_.columns());
  for (const Limited& item : augmented_.limited())
    (item.is_row ? result.row_multipliers : result.bound_multipliers)(item.index) = item.multiplier;
  VectorXd gradient = model_.gradient - model_.jacobian.transpose() * result.row_multipliers -
                      result.bound_multipliers;
  VectorXd reduced, dynamics;
  reduced_.backward(model_, gradient, reduced, &dynamics);
  result.row_multipliers.head(problem_.dynamics_rows()) = -dynamics;
  for (int c = 0; c < problem_.columns(); ++c)
    if (problem_.bounds(c).first == problem_.bounds(c).second && !reduced_.dependent(c))
      result.bound_multipliers(c) = gradient(c);
  return result;
}

std::string Run::message(SolveStatus status, const Stages& at) const {
  if (!crossed_.empty()) return crossed_;
  if (status == SolveStatus::infeasible) return say_missed(problem_.violations(at));
  if (status == SolveStatus::feasible)
    return "NLopt ended without further progress; the cost may not be optimal";
  return "";
}

SolveResult Nlopt::solve(const TrajectoryProblem& problem, const SolveRequest& request) const {
  const std::string reason = ReducedProblem::unsupported(problem);
  if (!reason.empty()) {
    const SolveRecord record(problem, request);
    return record.finish(SolveStatus::unsupported, reason, 0, {record.start(), {}, {}});
  }
  return Run(problem, request, settings_).solve();
}

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Nlopt)
