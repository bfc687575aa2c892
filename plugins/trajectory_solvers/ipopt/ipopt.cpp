// Ipopt, an interior-point method with a filter line search (Waechter and Biegler 2006), on the
// trajectory problem as it stands: every stage's numbers are variables, dynamics and constraints
// are rows with exact sparse Jacobians, and the Hessian of the Lagrangian is exact by default.
//
//   solver: {type: ipopt, hessian: exact, mu_strategy: adaptive}
#define HAVE_CSTDDEF  // Ipopt 3.11's headers ask for the C++ headers by name
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <mutex>

#include <coin/IpIpoptApplication.hpp>
#include <coin/IpIpoptCalculatedQuantities.hpp>
#include <coin/IpIpoptData.hpp>
#include <coin/IpTNLP.hpp>

#include "framework/plugin/plugin.h"
#include "framework/solve/solve_record.h"
#include "plugins/trajectory_solvers/ipopt/journal.h"
#include "plugins/trajectory_solvers/ipopt/program.h"

namespace lapwing {
namespace {

using Eigen::Map;
using Eigen::VectorXd;
using Index = ::Ipopt::Index;
using Number = ::Ipopt::Number;

constexpr double kNoBound = 2e19;      // Ipopt takes what is beyond 1e19 as none
constexpr double kWarmBarrier = 1e-6;  // where the barrier parameter begins from an earlier answer
constexpr double kWarmPush = 1e-9;     // how far from its bounds an earlier answer is moved

constexpr double kMet = 1e-6;  // in a row's own unit, of a point that is called feasible

struct Settings {
  int iterations = 0;
  double tolerance = 0, feasibility = 0, acceptable_tolerance = 0;
  int acceptable_iterations = 0;
  std::string hessian, mu_strategy;
};

class Ipopt final : public TrajectorySolver {
 public:
  static constexpr PluginText kText{
      "ipopt", "1.0.0", "interior-point method with a filter line search",
      "Waechter and Biegler, On the implementation of a primal-dual interior point filter line "
      "search algorithm, 2006"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("iterations", 500, "most iterations", between(1, 100000))
        .number("tolerance", 1e-8, "", "scaled optimality error that ends the solve",
                between(1e-12, 1e-2))
        .number("feasibility", 1e-7, "", "largest violation of a row, in its own unit",
                between(1e-12, 1e-5))
        .number("acceptable_tolerance", 1e-6, "",
                "optimality error that ends the solve when no better one comes",
                between(1e-12, 1e-2))
        .integer("acceptable_iterations", 15,
                 "iterations at the acceptable tolerance that end the solve; 0 for never",
                 between(0, 10000))
        .choice("hessian", "exact", {"exact", "gauss_newton", "limited_memory"},
                "second derivatives: exact, of residuals to first order, or estimated from "
                "gradients")
        .choice("mu_strategy", "adaptive", {"adaptive", "monotone"},
                "how the barrier parameter falls");
  }

  explicit Ipopt(const Parameters& parameters) {
    settings_.iterations = static_cast<int>(parameters.integer("iterations"));
    settings_.tolerance = parameters.number("tolerance");
    settings_.feasibility = parameters.number("feasibility");
    settings_.acceptable_tolerance = parameters.number("acceptable_tolerance");
    settings_.acceptable_iterations = static_cast<int>(parameters.integer("acceptable_iterations"));
    settings_.hessian = parameters.text("hessian");
    settings_.mu_strategy = parameters.text("mu_strategy");
  }

  SolveResult solve(const TrajectoryProblem& problem, const SolveRequest& request) const override;

 private:
  Settings settings_;
};

class LogJournal final : public ::Ipopt::Journal {
 public:
  LogJournal() : Journal("lapwing", ::Ipopt::J_ITERSUMMARY) {}

 private:
  void PrintImpl(::Ipopt::EJournalCategory, ::Ipopt::EJournalLevel, const char* text) override {
    lines_.write(text);
  }
  void PrintfImpl(::Ipopt::EJournalCategory, ::Ipopt::EJournalLevel, const char* format,
                  va_list arguments) override {
    char text[1024];
    std::vsnprintf(text, sizeof text, format, arguments);
    lines_.write(text);
  }
  void FlushBufferImpl() override {}

  JournalLines lines_;
};

// What a solve leaves behind.
struct Outcome {
  VectorXd x, rows, bounds;  // x and multipliers, signed as the kernel's
  int iterations = 0;
  std::optional<SolveStatus> stopped;  // by us
  bool converged = false;              // by our measure
};

// Between Ipopt and the program.
class Bridge final : public ::Ipopt::TNLP {
 public:
  Bridge(Program& program, const SolveRequest& request, const Settings& settings,
         SolveRecord& record, Outcome& outcome)
      : program_(program),
        request_(request),
        settings_(settings),
        record_(record),
        outcome_(outcome) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian,
                    IndexStyleEnum& style) override {
    n = program_.variables();
    m = program_.rows();
    jacobian = static_cast<Index>(program_.at_reference().jacobian.nonZeros());
    hessian = static_cast<Index>(program_.at_reference().hessian.nonZeros());
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* xl, Number* xu, Index m, Number* gl, Number* gu) override {
    const LocalModel& model = program_.at_reference();
    Map<VectorXd>(xl, n) = model.step_lower.cwiseMax(-kNoBound);
    Map<VectorXd>(xu, n) = model.step_upper.cwiseMin(kNoBound);
    Map<VectorXd>(gl, m) = model.row_lower.cwiseMax(-kNoBound);
    Map<VectorXd>(gu, m) = model.row_upper.cwiseMin(kNoBound);
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool want_bounds, Number* zl, Number* zu,
                          Index m, bool want_rows, Number* lambda) override {
    std::fill_n(x, n, 0.0);  // the reference itself
    if (want_bounds) {
      const VectorXd& bounds = request_.warm_start->bound_multipliers;
      Map<VectorXd>(zl, n) = bounds.cwiseMax(0.0);
      Map<VectorXd>(zu, n) = (-bounds).cwiseMax(0.0);
    }
    if (want_rows) Map<VectorXd>(lambda, m) = -request_.warm_start->row_multipliers;
    return true;
  }

  bool eval_f(Index, const Number* x, bool new_x, Number& f) override {
    move_to(x, new_x);
    f = program_.cost();
    return std::isfinite(f);
  }
  bool eval_grad_f(Index n, const Number* x, bool new_x, Number* gradient) override {
    move_to(x, new_x);
    Map<VectorXd>(gradient, n) = program_.linear().gradient;
    accepted_.assign(x, x + n);
    return true;
  }
  bool eval_g(Index, const Number* x, bool new_x, Index m, Number* g) override {
    move_to(x, new_x);
    Map<VectorXd> values(g, m);
    values = program_.row_values();
    return values.allFinite();
  }
  bool eval_jac_g(Index n, const Number* x, bool new_x, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    if (!values) return structure(program_.at_reference().jacobian, rows, columns);
    move_to(x, new_x);
    const SparseMatrix& jacobian = program_.linear().jacobian;
    std::copy_n(jacobian.valuePtr(), jacobian.nonZeros(), values);
    accepted_.assign(x, x + n);
    return true;
  }
  bool eval_h(Index, const Number* x, bool new_x, Number factor, Index, const Number* lambda, bool,
              Index, Index* rows, Index* columns, Number* values) override {
    if (!values) return structure(program_.at_reference().hessian, rows, columns);
    move_to(x, new_x);
    program_.hessian(factor, lambda, values);
    return true;
  }

  bool intermediate_callback(::Ipopt::AlgorithmMode mode, Index iteration, Number cost,
                             Number violation, Number, Number, Number, Number, Number, Number alpha,
                             Index, const ::Ipopt::IpoptData*,
                             ::Ipopt::IpoptCalculatedQuantities* quantities) override {
    outcome_.iterations = iteration;
    if (request_.progress)
      request_.progress->report(-1.0, "interior-point iteration " + std::to_string(iteration));
    if (!accepted_.empty()) keep(accepted_, alpha);
    outcome_.stopped = record_.stopped();
    // Ipopt's own test is absolute: a cost of 1e6 has not the digits for it.
    outcome_.converged =
        mode == ::Ipopt::RegularMode && violation <= settings_.feasibility &&
        quantities->curr_nlp_error() <= settings_.tolerance * (1.0 + std::abs(cost));
    return !outcome_.stopped && !outcome_.converged;
  }

  void finalize_solution(::Ipopt::SolverReturn, Index n, const Number* x, const Number* zl,
                         const Number* zu, Index m, const Number*, const Number* lambda, Number,
                         const ::Ipopt::IpoptData*, ::Ipopt::IpoptCalculatedQuantities*) override {
    outcome_.x = Map<const VectorXd>(x, n);
    outcome_.rows = -Map<const VectorXd>(lambda, m);
    outcome_.bounds = Map<const VectorXd>(zl, n) - Map<const VectorXd>(zu, n);
  }

  // The cheapest feasible iterate, empty when there was none.
  const VectorXd& best() const { return best_; }

 private:
  void move_to(const Number* x, bool new_x) {
    if (!new_x && begun_) return;
    begun_ = true;
    program_.move_to(x);
  }
  void keep(const std::vector<Number>& x, double alpha) {
    const Map<const VectorXd> step(x.data(), static_cast<Index>(x.size()));
    const Stages at = program_.problem().retract(program_.reference(), step);
    record_.add(at, alpha);
    if (record_.latest().violation > settings_.feasibility || record_.latest().cost >= best_cost_)
      return;
    best_cost_ = record_.latest().cost;
    best_ = step;
  }
  static bool structure(const SparseMatrix& matrix, Index* rows, Index* columns) {
    for (int j = 0; j < matrix.outerSize(); ++j)
      for (SparseMatrix::InnerIterator e(matrix, j); e; ++e) {
        *rows++ = static_cast<Index>(e.row());
        *columns++ = j;
      }
    return true;
  }

  Program& program_;
  const SolveRequest& request_;
  const Settings& settings_;
  SolveRecord& record_;
  Outcome& outcome_;
  std::vector<Number> accepted_;  // the iterate, known by where derivatives were last asked for
  VectorXd best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  bool begun_ = false;
};

// Ipopt's own name of how it ended.
const char* name_of(::Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case ::Ipopt::Solve_Succeeded:
      return "Solve_Succeeded";
    case ::Ipopt::Solved_To_Acceptable_Level:
      return "Solved_To_Acceptable_Level";
    case ::Ipopt::Infeasible_Problem_Detected:
      return "Infeasible_Problem_Detected";
    case ::Ipopt::Search_Direction_Becomes_Too_Small:
      return "Search_Direction_Becomes_Too_Small";
    case ::Ipopt::Diverging_Iterates:
      return "Diverging_Iterates";
    case ::Ipopt::User_Requested_Stop:
      return "User_Requested_Stop";
    case ::Ipopt::Feasible_Point_Found:
      return "Feasible_Point_Found";
    case ::Ipopt::Maximum_Iterations_Exceeded:
      return "Maximum_Iterations_Exceeded";
    case ::Ipopt::Restoration_Failed:
      return "Restoration_Failed";
    case ::Ipopt::Error_In_Step_Computation:
      return "Error_In_Step_Computation";
    case ::Ipopt::Maximum_CpuTime_Exceeded:
      return "Maximum_CpuTime_Exceeded";
    case ::Ipopt::Not_Enough_Degrees_Of_Freedom:
      return "Not_Enough_Degrees_Of_Freedom";
    case ::Ipopt::Invalid_Problem_Definition:
      return "Invalid_Problem_Definition";
    case ::Ipopt::Invalid_Option:
      return "Invalid_Option";
    case ::Ipopt::Invalid_Number_Detected:
      return "Invalid_Number_Detected";
    case ::Ipopt::Unrecoverable_Exception:
      return "Unrecoverable_Exception";
    case ::Ipopt::NonIpopt_Exception_Thrown:
      return "NonIpopt_Exception_Thrown";
    case ::Ipopt::Insufficient_Memory:
      return "Insufficient_Memory";
    case ::Ipopt::Internal_Error:
      return "Internal_Error";
  }
  return "an unknown status";
}

// What an end means. `feasible`: the point that is returned meets every row.
SolveStatus meaning(::Ipopt::ApplicationReturnStatus status, const Outcome& outcome,
                    bool feasible) {
  if (outcome.converged && feasible) return SolveStatus::optimal;
  if (outcome.stopped) return *outcome.stopped;
  switch (status) {
    case ::Ipopt::Solve_Succeeded:
      return feasible ? SolveStatus::optimal : SolveStatus::numerical_error;
    case ::Ipopt::Infeasible_Problem_Detected:
      return SolveStatus::infeasible;
    case ::Ipopt::Maximum_Iterations_Exceeded:
      return SolveStatus::iteration_limit;
    case ::Ipopt::Solved_To_Acceptable_Level:
    case ::Ipopt::Feasible_Point_Found:
    case ::Ipopt::Search_Direction_Becomes_Too_Small:
    case ::Ipopt::Restoration_Failed:
    case ::Ipopt::Error_In_Step_Computation:
      return feasible ? SolveStatus::feasible : SolveStatus::numerical_error;
    default:
      return SolveStatus::numerical_error;
  }
}

// One solve with Ipopt as it is set up.
class Run {
 public:
  Run(const TrajectoryProblem& problem, const SolveRequest& request, const Settings& settings)
      : problem_(problem),
        request_(request),
        settings_(settings),
        record_(problem, request),
        program_(problem, record_.start(), settings.hessian == "exact") {}

  SolveResult solve() {
    if (const auto stop = record_.stopped()) return early(*stop, "");
    const std::string crossed = say_crossed(problem_, program_.at_reference());
    if (!crossed.empty()) return early(SolveStatus::infeasible, crossed);
    limit_ = request_.iteration_limit.value_or(settings_.iterations);
    if (limit_ <= 0) return early(SolveStatus::iteration_limit, "");
    ::Ipopt::ApplicationReturnStatus status = optimise("make_parameter");
    // As many equations as free numbers: fixed ones are then kept as variables.
    if (status == ::Ipopt::Not_Enough_Degrees_Of_Freedom) status = optimise("relax_bounds");
    return finish(status);
  }

 private:
  SolveResult early(SolveStatus status, std::string message) {
    WarmStart point{inside_bounds(program_.reference()), {}, {}};
    if (record_.warm_multipliers()) {
      point.row_multipliers = request_.warm_start->row_multipliers;
      point.bound_multipliers = request_.warm_start->bound_multipliers;
    }
    return record_.finish(status, std::move(message), 0, std::move(point));
  }

  void set_options(::Ipopt::OptionsList& options, const char* fixed) const {
    options.SetStringValue("sb", "yes");
    options.SetNumericValue("tol", settings_.tolerance);
    // Scaling by the first gradient would ruin the answer: that of a guess with kinks is 1e6 times
    // what matters at the optimum. Units are of one size as they are.
    options.SetStringValue("nlp_scaling_method", "none");
    options.SetNumericValue("constr_viol_tol", settings_.feasibility);
    options.SetNumericValue("acceptable_tol", settings_.acceptable_tolerance);
    options.SetNumericValue("acceptable_constr_viol_tol", settings_.feasibility);
    options.SetIntegerValue("acceptable_iter", settings_.acceptable_iterations);
    options.SetIntegerValue("max_iter", limit_);
    options.SetStringValue("mu_strategy", settings_.mu_strategy);
    options.SetStringValue("fixed_variable_treatment", fixed);
    options.SetStringValue("linear_solver", "mumps");
    if (settings_.hessian == "limited_memory")
      options.SetStringValue("hessian_approximation", "limited-memory");
    if (problem_.quadratic())
      for (const char* constant : {"jac_c_constant", "jac_d_constant", "hessian_constant"})
        options.SetStringValue(constant, "yes");
    if (!record_.warm_multipliers()) return;
    options.SetStringValue("warm_start_init_point", "yes");
    options.SetNumericValue("mu_init", kWarmBarrier);
    for (const char* push :
         {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_slack_bound_push",
          "warm_start_slack_bound_frac", "warm_start_mult_bound_push"})
      options.SetNumericValue(push, kWarmPush);
  }

  ::Ipopt::ApplicationReturnStatus optimise(const char* fixed) {
    static std::mutex one_at_a_time;  // MUMPS keeps state of its own
    const std::lock_guard<std::mutex> lock(one_at_a_time);
    ::Ipopt::SmartPtr<::Ipopt::IpoptApplication> app = new ::Ipopt::IpoptApplication(false);
    app->Jnlst()->AddJournal(new LogJournal);
    set_options(*app->Options(), fixed);
    const auto ready = app->Initialize("");  // no option file of the working directory
    if (ready != ::Ipopt::Solve_Succeeded) return ready;
    ::Ipopt::SmartPtr<Bridge> bridge = new Bridge(program_, request_, settings_, record_, outcome_);
    const auto status = app->OptimizeTNLP(GetRawPtr(bridge));
    best_ = bridge->best();
    return status;
  }

  SolveResult finish(::Ipopt::ApplicationReturnStatus status) {
    WarmStart point{program_.reference(), outcome_.rows, outcome_.bounds};
    if (outcome_.x.size() > 0 && outcome_.x.allFinite())
      point.stages = problem_.retract(program_.reference(), outcome_.x);
    point.stages = inside_bounds(point.stages);
    bool feasible = meets_rows(point.stages);
    if (!feasible && best_.size() > 0) {  // the last iterate is not the best one
      point.stages = inside_bounds(problem_.retract(program_.reference(), best_));
      feasible = meets_rows(point.stages);
    }
    const SolveStatus means = meaning(status, outcome_, feasible);
    std::string message;
    if (means == SolveStatus::infeasible) message = say_missed(problem_.violations(point.stages));
    if (means == SolveStatus::numerical_error || means == SolveStatus::feasible)
      message = std::string("Ipopt ended with ") + name_of(status);
    return record_.finish(means, std::move(message), outcome_.iterations, std::move(point));
  }

  // Ipopt's iterates pass their bounds by a hair.
  Stages inside_bounds(const Stages& at) const {
    LocalModel model;
    problem_.linearise(at, model);
    const VectorXd zero = VectorXd::Zero(problem_.columns());
    return problem_.retract(at, zero.cwiseMax(model.step_lower).cwiseMin(model.step_upper));
  }
  bool meets_rows(const Stages& at) const {
    return worst_row_violation(program_.at_reference(), problem_.row_values(at)) <= kMet;
  }

  const TrajectoryProblem& problem_;
  const SolveRequest& request_;
  const Settings& settings_;
  SolveRecord record_;
  Program program_;
  Outcome outcome_;
  VectorXd best_;
  int limit_ = 0;
};

SolveResult Ipopt::solve(const TrajectoryProblem& problem, const SolveRequest& request) const {
  return Run(problem, request, settings_).solve();
}

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Ipopt)
