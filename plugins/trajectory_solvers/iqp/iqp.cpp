// SPDX-License-Identifier: Apache-2.0
// Iterative quadratic programming (thesis 3.6).
//
// Each iteration solves the quadratic model of the problem around the current trajectory,
//
//   minimise g'd + d'Hd/2   with   lower <= c + A d <= upper,   x_min <= x + d <= x_max,
//
// H Gauss-Newton's with the convex part of the constraints' curvature, and takes x + alpha d with
// the longest alpha in 1, 1/2, 1/4, ... that lowers the merit  phi(x) = cost(x) + nu * sum of
// violations  by a share of what the model promises; nu exceeds every multiplier. A purely
// quadratic problem is one program and one full step.
//
// Where this cuts a step short, the whole step is taken on trial (the watchdog of Chamberlain,
// Powell, Lemarechal and Pedersen, Math. Programming Study 16, 1982). The merit may grow, and more
// whole steps follow, until one lies as low as the search asked of the first. If the fourth does
// not, the solve goes back and takes the cut step. In a curved valley, such as a camera that moves
// along its line of sight, whole steps leave the valley and return to it further on, where cut ones
// creep along it.
//
// It stops as optimal when the violations are within `feasibility` and the model promises less than
// `tolerance` * (1 + |cost|). Where the model's rows contradict each other its elastic form is
// solved: the step then restores feasibility, and where it no longer can, the problem is
// infeasible, and the report names the rows that give and the limits that hold them back.
//
//   solver: {type: iqp, iterations: 50}
#include <algorithm>
#include <chrono>
#include <cmath>

#include "framework/plugin/plugin.h"
#include "framework/solve/active_set.h"
#include "framework/solve/elastic.h"
#include "framework/solve/interior_point.h"
#include "framework/solve/local_program.h"
#include "framework/solve/nonlinear_interior_point.h"
#include "framework/solve/solve_record.h"
#include "framework/solve/trajectory_solver.h"

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kArmijo = 1e-4;        // share of the promised decrease that must come true
constexpr double kShortestStep = 1e-6;  // shorter line-search steps end the solve
constexpr double kNoise = 1e-13;        // relative, of a merit
// A step this short or shorter gives way to whole ones on trial, so many at most.
constexpr double kCut = 0.25;
constexpr int kTrialSteps = 4;
constexpr double kMeritMargin = 1.5;  // merit weight over the largest multiplier
// Programs are solved to this share of what the one before promised, within these limits: early
// ones only show the way.
constexpr double kProgramShare = 0.1, kProgramFinest = 1e-9, kProgramCoarsest = 1e-2;
constexpr double kPushing = 1e-8;        // of the largest multiplier: smaller ones are none
constexpr double kElasticPenalty = 1e3;  // times 1 + |g|
// The penalties are large beside the cost, so rounding may keep elastic programs from a finer one.
constexpr double kElasticTolerance = 1e-8;

class Iqp final : public TrajectorySolver {
 public:
  static constexpr PluginText kText{
      "iqp", "1.0.0", "sequential quadratic programming with a line search", "thesis 3.6"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("iterations", 50, "largest number of quadratic programs", between(1, 10000))
        .number("tolerance", 1e-6, "",
                "predicted relative decrease of the cost that ends the solve", between(1e-12, 1e-1))
        .number("feasibility", 1e-6, "", "largest violation of a row, in its unit",
                between(1e-12, 1e-1))
        .integer("steps", 300, "with free times or orientations: largest number of steps",
                 between(1, 100000))
        .number("first_barrier", 0.1, "",
                "with free times or orientations: first barrier parameter; less for a good guess",
                between(1e-9, 10));
  }

  explicit Iqp(const Parameters& parameters)
      : iterations_(static_cast<int>(parameters.integer("iterations"))),
        tolerance_(parameters.number("tolerance")),
        feasibility_(parameters.number("feasibility")),
        steps_(static_cast<int>(parameters.integer("steps"))),
        first_barrier_(parameters.number("first_barrier")) {}

  SolveResult solve(const TrajectoryProblem& problem, const SolveRequest& request) const override;

 private:
  int iterations_;
  double tolerance_, feasibility_;
  int steps_;
  double first_barrier_;
};

// The programs of one problem after the other: their orderings are kept where nothing changed.
struct IqpMemory final : SolverMemory {
  InteriorPoint programs, elastic;
  ActiveSet sets;
};

// One solve: the state that goes from iteration to iteration.
class Solve {
 public:
  Solve(const TrajectoryProblem& problem, const SolveRequest& request, int iterations,
        double tolerance, double feasibility)
      : problem_(problem),
        request_(request),
        tolerance_(tolerance),
        feasibility_(feasibility),
        limit_(request.iteration_limit.value_or(iterations)),
        start_(std::chrono::steady_clock::now()),
        sets_(memory_of(request).sets),
        interior_point_(memory_of(request).programs),
        elastic_point_(memory_of(request).elastic) {}

  SolveResult run();

 private:
  struct Step {
    QuadraticStatus status = QuadraticStatus::numerical_error;
    VectorXd d, rows, bounds;  // step and multipliers
    bool elastic = false;
  };

  IqpMemory& memory_of(const SolveRequest& request) {
    if (!request.memory) return own_;
    auto* kept = dynamic_cast<IqpMemory*>(request.memory->get());
    if (!kept) {
      *request.memory = std::make_unique<IqpMemory>();
      kept = static_cast<IqpMemory*>(request.memory->get());
    }
    return *kept;
  }
  void move_inside_bounds();
  SolveStatus iterate();
  void linearise();
  Step quadratic_step();
  Step elastic_step();
  std::optional<SolveStatus> stopped() const;
  bool line_search(const Step& step, double violation);
  void go_on(const Step& step);
  void go_back();
  double total_violation(const Stages& at) const;
  double predicted_violation(const Step& step) const;
  double merit_at(const Stages& at) const {
    return problem_.cost(at) + merit_weight_ * total_violation(at);
  }
  bool made_up(double merit) const;
  double worst_violation() const;
  // Whether the problem is like one solved before. Without a start, memory changes no result.
  bool edited() const { return request_.memory && request_.warm_start; }
  // Of the last program.
  double fine_tolerance() const { return std::max(kProgramFinest, kProgramShare * tolerance_); }
  void record(double step);
  std::string explain(const Step& step) const;
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  // Whole steps on trial: from where, what the search asked of the first, and the cut step instead.
  struct Trial {
    Stages from;
    double cost, violation, slope, cut;
    Step step;
    int steps = 1;
  };

  const TrajectoryProblem& problem_;
  const SolveRequest& request_;
  double tolerance_, feasibility_;
  int limit_;
  std::chrono::steady_clock::time_point start_;
  Stages at_;
  VectorXd rows_, bounds_;  // multipliers
  LocalModel model_;
  QuadraticProgram program_;
  IqpMemory own_;
  ActiveSet& sets_;
  InteriorPoint &interior_point_, &elastic_point_;
  bool contradictory_ = false;  // the last model's rows and bounds
  double program_tolerance_ = kProgramFinest;
  double merit_weight_ = 0;
  std::optional<Trial> trial_;
  int no_trial_ = 0;  // so many line searches begin none
  int failures_ = 0;  // trials in a row that came to nothing
  SolveReport report_;
};

SolveResult Solve::run() {
  at_ = problem_.initial_guess();
  if (request_.warm_start) {
    const WarmStart& warm = *request_.warm_start;
    if (warm.stages.rows() == at_.rows() && warm.stages.cols() == at_.cols()) at_ = warm.stages;
    rows_ = warm.row_multipliers;
    bounds_ = warm.bound_multipliers;
  }
  if (!problem_.quadratic()) {
    move_inside_bounds();
    program_tolerance_ = kProgramCoarsest;
  } else if (edited()) {  // as exact as is asked for, and no more
    program_tolerance_ = fine_tolerance();
  }
  record(0.0);
  report_.status = iterate();
  if (trial_ && report_.status != SolveStatus::optimal) go_back();
  report_.terms = problem_.term_costs(at_);
  report_.cost = 0;
  for (const TermCost& term : report_.terms) report_.cost += term.cost;
  report_.violations = problem_.violations(at_);
  report_.seconds = seconds();
  return {std::move(report_), {at_, rows_, bounds_}};
}

// Steps of a program stay within the bounds only from a point that is within them.
void Solve::move_inside_bounds() {
  problem_.linearise(at_, model_);
  const VectorXd zero = VectorXd::Zero(problem_.columns());
  at_ = problem_.retract(at_, zero.cwiseMax(model_.step_lower).cwiseMin(model_.step_upper));
}

// Cancelled or out of time between iterations.
std::optional<SolveStatus> Solve::stopped() const {
  if (request_.cancellation && request_.cancellation->cancelled()) return SolveStatus::cancelled;
  if (request_.wall_clock_guard && seconds() > *request_.wall_clock_guard)
    return SolveStatus::time_limit;
  return {};
}

SolveStatus Solve::iterate() {
  for (int k = 1; k <= limit_; ++k) {
    if (const auto stop = stopped()) return *stop;
    if (request_.progress)
      request_.progress->report(-1.0, "quadratic program " + std::to_string(k));
    linearise();
    // What contradicts itself once mostly does so again: no second proof until violations vanish.
    Step step;
    if (!contradictory_) step = quadratic_step();
    // One that comes to no end is mostly one whose contradiction is too small to be proven.
    contradictory_ = contradictory_ || step.status == QuadraticStatus::infeasible ||
                     step.status == QuadraticStatus::iteration_limit ||
                     step.status == QuadraticStatus::numerical_error;
    if (contradictory_) step = elastic_step();
    if (step.status == QuadraticStatus::cancelled) return SolveStatus::cancelled;
    if (step.status != QuadraticStatus::optimal && trial_) {
      go_back();
      continue;
    }
    if (step.status != QuadraticStatus::optimal) {
      report_.message = step.status == QuadraticStatus::unbounded
                            ? "the cost is unbounded: a term or a bound is missing"
                            : "the quadratic program could not be solved to its tolerance";
      return SolveStatus::numerical_error;
    }
    report_.iterations = k;
    rows_ = step.rows;
    bounds_ = step.bounds;
    if (problem_.quadratic()) {
      at_ = problem_.retract(at_, step.d);
      record(1.0);
      if (!step.elastic || worst_violation() <= feasibility_) return SolveStatus::optimal;
      report_.message = explain(step);
      return SolveStatus::infeasible;
    }
    const double violation = total_violation(at_);
    const double promised =
        -(model_.gradient.dot(step.d) +
          0.5 * step.d.dot(model_.hessian.selfadjointView<Eigen::Lower>() * step.d));
    const double fine = fine_tolerance();
    const bool coarse = program_tolerance_ > fine;
    program_tolerance_ =
        std::clamp(kProgramShare * std::abs(promised) / (1.0 + std::abs(model_.cost)),
                   kProgramFinest, kProgramCoarsest);
    const bool still = std::abs(promised) <= tolerance_ * (1.0 + std::abs(model_.cost));
    if (still && trial_ && !made_up(model_.cost + merit_weight_ * violation)) {
      go_back();  // what it ends at is worse than where it began
      continue;
    }
    if (still && worst_violation() <= feasibility_) {
      if (!coarse) return SolveStatus::optimal;
      program_tolerance_ = fine;  // a coarse program may promise less than there is
      continue;
    }
    contradictory_ = step.elastic && predicted_violation(step) > feasibility_;
    if (!line_search(step, violation)) {
      if (worst_violation() <= feasibility_) return SolveStatus::feasible;
      if (step.elastic) report_.message = explain(step);
      return step.elastic ? SolveStatus::infeasible : SolveStatus::numerical_error;
    }
  }
  return SolveStatus::iteration_limit;
}

void Solve::linearise() {
  if (problem_.quadratic() || rows_.size() != problem_.rows() || rows_.size() == 0) {
    problem_.linearise(at_, model_);
    return;
  }
  // Rows that do not push have no curvature to weigh.
  const double least = kPushing * rows_.cwiseAbs().maxCoeff();
  const VectorXd pushing = (rows_.cwiseAbs().array() > least).select(-rows_, 0.0);
  problem_.linearise(at_, model_, Curvature::convex, &pushing);
}

Solve::Step Solve::quadratic_step() {
  program_ = local_program(model_);
  InteriorPointOptions options;
  options.cancellation = request_.cancellation;
  options.tolerance = program_tolerance_;
  if (problem_.quadratic() && request_.moved)  // whose one program is all there is to be seen
    options.early = [this](const VectorXd& x) { request_.moved(problem_.retract(at_, x)); };
  std::optional<QuadraticWarmStart> warm;
  if (rows_.size() == problem_.rows() && bounds_.size() == problem_.columns())
    warm = QuadraticWarmStart{VectorXd::Zero(problem_.columns()), rows_, bounds_};
  if (warm && edited()) {  // mostly the same limits as before hold the flight back
    std::optional<QuadraticResult> near = sets_.solve(program_, options, *warm);
    if (near) return {near->status, near->x, near->row_multipliers, near->bound_multipliers};
  }
  QuadraticResult result = interior_point_.solve(program_, options, warm);
  if (warm && result.status != QuadraticStatus::optimal &&
      result.status != QuadraticStatus::cancelled)
    result = interior_point_.solve(program_, options);  // a bad start, not a bad program
  return {result.status, result.x, result.row_multipliers, result.bound_multipliers};
}

// Relaxes what was asked for (all rows but the dynamics); if limits alone contradict each other,
// those too.
Solve::Step Solve::elastic_step() {
  const double penalty =
      kElasticPenalty *
      (1.0 + (model_.gradient.size() ? model_.gradient.cwiseAbs().maxCoeff() : 0));
  for (const bool bounds : {false, true}) {
    QuadraticProgram hard = program_;
    if (!bounds && (hard.x_lower.array() > hard.x_upper.array()).any()) continue;
    const ElasticProgram elastic = make_elastic(hard, problem_.dynamics_rows(), bounds, penalty);
    InteriorPointOptions options;
    options.cancellation = request_.cancellation;
    options.tolerance = kElasticTolerance;
    const QuadraticResult result = elastic_point_.solve(elastic.program, options);
    if (result.status == QuadraticStatus::infeasible && !bounds) continue;
    return {result.status, result.x.head(elastic.variables),
            result.row_multipliers.head(problem_.rows()),
            result.bound_multipliers.head(elastic.variables), true};
  }
  return {QuadraticStatus::numerical_error, {}, {}, {}, true};
}

double Solve::total_violation(const Stages& at) const {
  const VectorXd c = problem_.row_values(at);
  return (model_.row_lower - c).cwiseMax(c - model_.row_upper).cwiseMax(0.0).sum();
}

double Solve::worst_violation() const {
  const VectorXd& c = model_.values;
  if (c.size() == 0) return 0.0;
  return (model_.row_lower - c).cwiseMax(c - model_.row_upper).cwiseMax(0.0).maxCoeff();
}

// What remains of the violations after the whole step, by the model's rows.
double Solve::predicted_violation(const Step& step) const {
  const VectorXd rows = model_.values + model_.jacobian * step.d;
  return (model_.row_lower - rows).cwiseMax(rows - model_.row_upper).cwiseMax(0.0).sum();
}

bool Solve::line_search(const Step& step, double violation) {
  const double largest = step.rows.size() ? step.rows.cwiseAbs().maxCoeff() : 0.0;
  merit_weight_ = std::max(merit_weight_, kMeritMargin * largest);
  if (trial_) {
    go_on(step);
    return true;
  }
  const double left = predicted_violation(step);
  const double slope =
      std::min(0.0, model_.gradient.dot(step.d) - merit_weight_ * (violation - left));
  const double merit = model_.cost + merit_weight_ * violation;
  const double noise = kNoise * (1.0 + std::abs(merit));
  double whole = 0;
  for (double alpha = 1.0; alpha > kShortestStep; alpha *= 0.5) {
    Stages next = problem_.retract(at_, alpha * step.d);
    const double now = merit_at(next);
    if (alpha == 1.0) whole = now;
    if (!(now <= merit + kArmijo * alpha * slope + noise)) continue;
    const bool on_trial = alpha <= kCut && no_trial_ == 0 && !step.elastic && std::isfinite(whole);
    if (on_trial) {
      trial_ = Trial{at_, model_.cost, violation, slope, alpha, step};
      next = problem_.retract(at_, step.d);
    } else if (no_trial_ > 0) {
      --no_trial_;
    }
    at_ = std::move(next);
    record(on_trial ? 1.0 : alpha);
    return true;
  }
  return false;
}

// Whether a merit is as low as the first step on trial should have made it.
bool Solve::made_up(double merit) const {
  const double before = trial_->cost + merit_weight_ * trial_->violation;
  return merit <= before + kArmijo * trial_->slope + kNoise * (1.0 + std::abs(before));
}

// The next whole step, which may end the trial; or back.
void Solve::go_on(const Step& step) {
  Stages whole = problem_.retract(at_, step.d);
  const double merit = merit_at(whole);
  if (made_up(merit)) {
    trial_.reset();
    failures_ = 0;
  } else if (++trial_->steps > kTrialSteps || !std::isfinite(merit)) {
    return go_back();
  }
  at_ = std::move(whole);
  record(1.0);
}

void Solve::go_back() {
  at_ = problem_.retract(trial_->from, trial_->cut * trial_->step.d);
  rows_ = trial_->step.rows;
  bounds_ = trial_->step.bounds;
  record(trial_->cut);
  trial_.reset();
  contradictory_ = false;
  no_trial_ = 1 << std::min(++failures_, 5);
}

void Solve::record(double step) {
  SolveIteration entry;
  entry.iteration = static_cast<int>(report_.history.size());
  entry.step = step;
  for (const TermCost& term : problem_.term_costs(at_)) {
    entry.cost += term.cost;
    entry.terms.push_back(term.cost);
  }
  const std::vector<Violation> violations = problem_.violations(at_);
  entry.violation = violations.empty() ? 0.0 : violations.front().amount;
  report_.history.push_back(std::move(entry));
  if (request_.moved && report_.history.size() > 1) request_.moved(at_);
}

// "hard_keyframe.position.x at 5 s is violated by 2.3; limited by state_limits.speed_across.0 at 4
// s". A limit stands in the way when it is active and not an equation: what fixes the ends of a
// flight binds always and explains nothing. Of these the one whose loosening by a share of itself
// would help most is named: multiplier times limit, comparable across units.
std::string Solve::explain(const Step& step) const {
  const std::vector<Violation> violations = problem_.violations(at_);
  if (violations.empty()) return "the constraints contradict each other";
  char amount[32];
  std::snprintf(amount, sizeof amount, "%.3g", violations.front().amount);
  std::string text = violations.front().row + " is violated by " + amount;
  double most = 0;
  std::string name;
  const auto consider = [&](double multiplier, double lower, double upper, auto name_of) {
    const double limit = multiplier > 0 ? lower : upper;
    if (lower == upper || !std::isfinite(limit)) return;
    const double gain = std::abs(multiplier * limit);
    if (!(gain > most)) return;
    const std::string candidate = name_of();
    if (candidate.rfind(violations.front().name, 0) == 0) return;  // what is asked for, not a limit
    most = gain;
    name = candidate;
  };
  for (int c = 0; c < step.bounds.size(); ++c) {
    const auto [lower, upper] = problem_.bounds(c);
    consider(step.bounds(c), lower, upper,
             [&] { return problem_.bound_name(c, step.bounds(c) > 0); });
  }
  for (int r = problem_.dynamics_rows(); r < step.rows.size(); ++r)
    consider(step.rows(r), model_.row_lower(r), model_.row_upper(r),
             [&] { return problem_.row_name(r); });
  return name.empty() ? text : text + "; limited by " + name;
}

// Whether the problem is far from convex: rows that multiply a free time, or orientations.
bool far_from_convex(const TrajectoryProblem& problem) {
  const StageLayout& layout = problem.layout();
  for (int b = 0; b < layout.count(); ++b)
    if (layout.block(b).topology == Topology::quaternion) return true;
  return problem.horizon().step_free;
}

SolveResult Iqp::solve(const TrajectoryProblem& problem, const SolveRequest& request) const {
  if (!far_from_convex(problem))
    return Solve(problem, request, iterations_, tolerance_, feasibility_).run();
  SolveRecord record(problem, request);
  const NonlinearOptions options{.iteration_limit = request.iteration_limit.value_or(steps_),
                                 .tolerance = tolerance_,
                                 .feasibility = feasibility_,
                                 .first_barrier = first_barrier_};
  NonlinearOutcome outcome = solve_nonlinear(problem, request, options, record);
  return record.finish(outcome.status, std::move(outcome.message), outcome.iterations,
                       std::move(outcome.point));
}

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Iqp)
