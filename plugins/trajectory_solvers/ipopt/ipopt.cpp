// SPDX-License-Identifier: Apache-2.0
// Ipopt, an interior-point method with a filter line search (Waechter and Biegler 2006), on the
// trajectory problem as it stands: every stage's numbers are variables, dynamics and constraints
// are rows with exact sparse Jacobians, and the Hessian of the Lagrangian is exact by default.
//
//   solver: {type: ipopt, hessian: exact, mu_strategy: adaptive}
#include <algorithm>
#include <cmath>

#include "framework/plugin/plugin.h"
#include "plugins/trajectory_solvers/ipopt/pass.h"

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kMet = 1e-6;            // in a row's own unit, of a point that is called feasible
constexpr double kElasticWeight = 1e-6;  // of the cost beside a sum of violations

class Ipopt final : public TrajectorySolver {
 public:
  static constexpr PluginText kText{
      "ipopt", "1.0.0", "interior-point method with a filter line search",
      "Waechter and Biegler, On the implementation of a primal-dual interior point filter line "
      "search algorithm, 2006"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("iterations", 500, "largest number of iterations", between(1, 100000))
        .number("tolerance", 1e-8, "", "scaled optimality error that ends the solve",
                between(1e-12, 1e-2))
        .number("feasibility", 1e-7, "", "largest violation of a row, in its unit",
                between(1e-12, 1e-5))
        .number("acceptable_tolerance", 1e-6, "",
                "optimality error that ends the solve if there is no more progress",
                between(1e-12, 1e-2))
        .integer("acceptable_iterations", 15,
                 "iterations at the acceptable tolerance that end the solve; 0: never",
                 between(0, 10000))
        .choice("hessian", "exact", {"exact", "gauss_newton", "limited_memory"},
                "second derivatives: exact, Gauss-Newton, or estimated from gradients")
        .choice("mu_strategy", "adaptive", {"adaptive", "monotone"},
                "update of the barrier parameter")
        .number("first_barrier", 0.1, "",
                "first barrier parameter of `monotone`; reduced for a good guess",
                between(1e-9, 0.1));
  }

  explicit Ipopt(const Parameters& parameters) {
    settings_.iterations = static_cast<int>(parameters.integer("iterations"));
    settings_.tolerance = parameters.number("tolerance");
    settings_.feasibility = parameters.number("feasibility");
    settings_.acceptable_tolerance = parameters.number("acceptable_tolerance");
    settings_.acceptable_iterations = static_cast<int>(parameters.integer("acceptable_iterations"));
    settings_.hessian = parameters.text("hessian");
    settings_.mu_strategy = parameters.text("mu_strategy");
    settings_.first_barrier = parameters.number("first_barrier");
  }

  SolveResult solve(const TrajectoryProblem& problem, const SolveRequest& request) const override;

 private:
  IpoptSettings settings_;
};

// What an end means. `feasible`: the point that is returned meets every row.
SolveStatus meaning(const PassOutcome& outcome, bool feasible) {
  if (outcome.converged && feasible) return SolveStatus::optimal;
  if (outcome.stopped) return *outcome.stopped;
  switch (outcome.end) {
    case PassEnd::solved:
      return feasible ? SolveStatus::optimal : SolveStatus::numerical_error;
    case PassEnd::infeasible:
      return feasible ? SolveStatus::feasible : SolveStatus::infeasible;
    case PassEnd::iteration_limit:
      return SolveStatus::iteration_limit;
    case PassEnd::acceptable:
    case PassEnd::no_step:
    case PassEnd::stopped:
      return feasible ? SolveStatus::feasible : SolveStatus::numerical_error;
    default:
      return SolveStatus::numerical_error;
  }
}

// One solve, in passes: the program itself; where that finds no feasible point, the elastic
// program from there; and if this does find one, the program again.
class Run {
 public:
  Run(const TrajectoryProblem& problem, const SolveRequest& request, const IpoptSettings& settings)
      : problem_(problem), request_(request), settings_(settings), record_(problem, request) {
    begin_at(record_.start());
  }

  SolveResult solve() {
    at_ = inside_bounds(program_->reference());
    limit_ = request_.iteration_limit.value_or(settings_.iterations);
    if (const auto stop = record_.stopped()) return early(*stop, "");
    const std::string crossed = say_crossed(problem_, program_->at_reference());
    if (!crossed.empty()) return early(SolveStatus::infeasible, crossed);
    if (limit_ <= 0) return early(SolveStatus::iteration_limit, "");
    warm_ = record_.warm_multipliers();
    pass();
    warm_ = false;
    if (!stuck()) return finish(meaning(outcome_, feasible()));
    const PassOutcome first = outcome_;
    const Stages there = at_;
    begin_at(at_);
    program_->relax(kElasticWeight / (1.0 + std::abs(problem_.cost(at_))));
    pass();
    if (outcome_.stopped || out_of_iterations()) return finish(meaning(outcome_, feasible()));
    if (feasible()) {
      begin_at(at_);
      pass();
      return finish(meaning(outcome_, feasible()));
    }
    // The least sum of violations is not zero: nothing nearby meets the rows.
    if (solved()) return finish(SolveStatus::infeasible);
    at_ = there;
    outcome_.end = first.end;
    outcome_.name = first.name;
    return finish(meaning(outcome_, false));
  }

 private:
  void begin_at(Stages reference) {
    program_.emplace(problem_, std::move(reference), settings_.hessian == "exact");
  }

  SolveResult early(SolveStatus status, std::string message) {
    WarmStart point{at_, {}, {}};
    if (record_.warm_multipliers()) {
      point.row_multipliers = request_.warm_start->row_multipliers;
      point.bound_multipliers = request_.warm_start->bound_multipliers;
    }
    return record_.finish(status, std::move(message), 0, std::move(point));
  }

  // Ipopt on the program as it stands; again around the last iterate where an orientation has
  // turned too far to be described from the reference.
  void pass() {
    do {
      if (outcome_.turned) begin_at(at_);
      outcome_.converged = outcome_.restoring = outcome_.turned = false;
      optimise(false);
      // As many equations as free numbers: fixed ones are then kept as variables.
      if (outcome_.end == PassEnd::too_few_variables) optimise(true);
      at_ = inside_bounds(outcome_.x.size() > 0 && outcome_.x.allFinite()
                              ? problem_.retract(program_->reference(), outcome_.x)
                              : program_->reference());
    } while (outcome_.turned && !outcome_.stopped && !out_of_iterations());
  }

  void optimise(bool fixed_stay) {
    run_pass({settings_, request_, std::max(0, limit_ - outcome_.iterations), warm_, fixed_stay},
             *program_, record_, outcome_);
  }

  bool solved() const {
    return outcome_.converged || outcome_.end == PassEnd::solved ||
           outcome_.end == PassEnd::acceptable;
  }
  bool out_of_iterations() const { return outcome_.iterations >= limit_; }
  bool feasible() const {
    return worst_row_violation(program_->at_reference(), problem_.row_values(at_)) <= kMet;
  }
  // No feasible point, and not for want of time.
  bool stuck() const {
    if (outcome_.stopped || out_of_iterations() || feasible()) return false;
    return outcome_.restoring || outcome_.end == PassEnd::infeasible ||
           outcome_.end == PassEnd::no_step;
  }

  SolveResult finish(SolveStatus status) {
    // The last iterate need not be the best one.
    if (status != SolveStatus::optimal && outcome_.best.size() > 0 &&
        (!feasible() || outcome_.best_cost < problem_.cost(at_)))
      at_ = inside_bounds(outcome_.best);
    if (status == SolveStatus::infeasible && feasible()) status = SolveStatus::feasible;
    std::string message;
    if (status == SolveStatus::infeasible) message = say_missed(problem_.violations(at_));
    if (status == SolveStatus::numerical_error || status == SolveStatus::feasible)
      message = std::string("Ipopt ended with ") + outcome_.name;
    return record_.finish(status, std::move(message), outcome_.iterations,
                          {at_, outcome_.rows, outcome_.bounds});
  }

  // Ipopt's iterates pass their bounds by a hair.
  Stages inside_bounds(const Stages& at) const {
    LocalModel model;
    problem_.linearise(at, model);
    const VectorXd zero = VectorXd::Zero(problem_.columns());
    return problem_.retract(at, zero.cwiseMax(model.step_lower).cwiseMin(model.step_upper));
  }

  const TrajectoryProblem& problem_;
  const SolveRequest& request_;
  const IpoptSettings& settings_;
  SolveRecord record_;
  std::optional<Program> program_;
  PassOutcome outcome_;
  Stages at_;
  int limit_ = 0;
  bool warm_ = false;
};

SolveResult Ipopt::solve(const TrajectoryProblem& problem, const SolveRequest& request) const {
  return Run(problem, request, settings_).solve();
}

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Ipopt)
