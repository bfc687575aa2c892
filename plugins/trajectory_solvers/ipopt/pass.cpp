// SPDX-License-Identifier: Apache-2.0
// How: `Bridge` answers Ipopt's calls from a Program. Matrices are passed as triplets whose order
// is that of the compressed columns, so that values are copied as they are. Row multipliers of
// Ipopt have the opposite sign of the kernel's; those of bounds are its zl - zu.
//
// intermediate_callback ends a pass where
//   - the optimality error is small relative to the cost (Ipopt's own test is absolute);
//   - Ipopt restores feasibility for more than ten iterations: the elastic program does it better;
//   - an orientation has turned so far that its chart is nearly singular (program.h);
//   - the user or a time limit ends the solve.
// Ipopt 3.11 does not tell the callback its iterate. `accepted_` is the point at which derivatives
// were last asked for: Ipopt asks for them at accepted points only.
#include "plugins/trajectory_solvers/ipopt/pass.h"

#define HAVE_CSTDDEF  // Ipopt 3.11's headers ask for the C++ headers by name
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <mutex>
#include <new>

#include <coin/IpIpoptApplication.hpp>
#include <coin/IpIpoptCalculatedQuantities.hpp>
#include <coin/IpIpoptData.hpp>
#include <coin/IpTNLP.hpp>

#include "plugins/trajectory_solvers/ipopt/journal.h"

namespace lapwing {
namespace {

using Eigen::Map;
using Eigen::VectorXd;
using Index = ::Ipopt::Index;
using Number = ::Ipopt::Number;

constexpr double kNoBound = 2e19;      // Ipopt takes what is beyond 1e19 as none
constexpr double kUsualBarrier = 0.1;  // Ipopt's own first one
constexpr double kWarmBarrier = 1e-6;  // where the barrier parameter begins from an earlier answer
constexpr double kWarmPush = 1e-9;     // how far from its bounds an earlier answer is moved
constexpr int kRestorations = 10;      // iterations in a row that Ipopt may take for feasibility
constexpr double kLargestTurn = 4.0;   // rad, of an orientation from its reference

class LogJournal final : public ::Ipopt::Journal {
 public:
  LogJournal() : Journal("lapwing", ::Ipopt::J_ITERSUMMARY) {}
  bool out_of_memory() const { return lines_.out_of_memory(); }

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

// Between Ipopt and the program.
class Bridge final : public ::Ipopt::TNLP {
 public:
  Bridge(Program& program, const SolveRequest& request, const IpoptSettings& settings,
         SolveRecord& record, PassOutcome& outcome)
      : program_(program),
        request_(request),
        settings_(settings),
        record_(record),
        outcome_(outcome),
        before_(outcome.iterations) {}

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
    Map<VectorXd>(x, n) = program_.start();
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
    outcome_.iterations = before_ + iteration;
    if (request_.progress)
      request_.progress->report(-1.0,
                                "interior-point iteration " + std::to_string(outcome_.iterations));
    if (!accepted_.empty() && (iteration > 0 || before_ == 0)) keep(alpha);
    outcome_.stopped = record_.stopped();
    const bool regular = mode == ::Ipopt::RegularMode;
    restorations_ = regular ? 0 : restorations_ + 1;
    outcome_.restoring = !program_.relaxed() && restorations_ > kRestorations;
    outcome_.turned = program_.largest_turn() > kLargestTurn;
    // Ipopt's own test is absolute: a cost of 1e6 has not the digits for it.
    outcome_.converged =
        regular && violation <= settings_.feasibility &&
        quantities->curr_nlp_error() <= settings_.tolerance * (1.0 + std::abs(cost));
    return !outcome_.stopped && !outcome_.converged && !outcome_.restoring && !outcome_.turned;
  }

  void finalize_solution(::Ipopt::SolverReturn, Index, const Number* x, const Number* zl,
                         const Number* zu, Index m, const Number*, const Number* lambda, Number,
                         const ::Ipopt::IpoptData*, ::Ipopt::IpoptCalculatedQuantities*) override {
    const int n = program_.columns();
    outcome_.x = Map<const VectorXd>(x, n);
    outcome_.rows = -Map<const VectorXd>(lambda, m);
    outcome_.bounds = Map<const VectorXd>(zl, n) - Map<const VectorXd>(zu, n);
  }

 private:
  void move_to(const Number* x, bool new_x) {
    if (!new_x && begun_) return;
    begun_ = true;
    program_.move_to(x);
  }
  void keep(double alpha) {
    const Map<const VectorXd> step(accepted_.data(), program_.columns());
    const Stages at = program_.problem().retract(program_.reference(), step);
    record_.add(at, alpha);
    const SolveIteration& latest = record_.latest();
    if (latest.violation > settings_.feasibility || latest.cost >= outcome_.best_cost) return;
    outcome_.best_cost = latest.cost;
    outcome_.best = at;
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
  const IpoptSettings& settings_;
  SolveRecord& record_;
  PassOutcome& outcome_;
  int before_;  // iterations of earlier passes
  int restorations_ = 0;
  std::vector<Number> accepted_;  // the iterate, known by where derivatives were last asked for
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

PassEnd end_of(::Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case ::Ipopt::Solve_Succeeded:
      return PassEnd::solved;
    case ::Ipopt::Solved_To_Acceptable_Level:
    case ::Ipopt::Feasible_Point_Found:
      return PassEnd::acceptable;
    case ::Ipopt::Infeasible_Problem_Detected:
      return PassEnd::infeasible;
    case ::Ipopt::Search_Direction_Becomes_Too_Small:
    case ::Ipopt::Restoration_Failed:
    case ::Ipopt::Error_In_Step_Computation:
      return PassEnd::no_step;
    case ::Ipopt::Maximum_Iterations_Exceeded:
      return PassEnd::iteration_limit;
    case ::Ipopt::User_Requested_Stop:
      return PassEnd::stopped;
    case ::Ipopt::Not_Enough_Degrees_Of_Freedom:
      return PassEnd::too_few_variables;
    default:
      return PassEnd::failed;
  }
}

void set_options(::Ipopt::OptionsList& options, const PassRequest& pass, bool quadratic) {
  const IpoptSettings& settings = pass.settings;
  options.SetStringValue("sb", "yes");
  options.SetNumericValue("tol", settings.tolerance);
  // Scaling by the first gradient would ruin the answer: that of a guess with kinks is 1e6 times
  // what matters at the optimum. Units are of one size as they are.
  options.SetStringValue("nlp_scaling_method", "none");
  options.SetNumericValue("constr_viol_tol", settings.feasibility);
  options.SetNumericValue("acceptable_tol", settings.acceptable_tolerance);
  options.SetNumericValue("acceptable_constr_viol_tol", settings.feasibility);
  options.SetIntegerValue("acceptable_iter", settings.acceptable_iterations);
  options.SetIntegerValue("max_iter", pass.iterations);
  options.SetStringValue("mu_strategy", settings.mu_strategy);
  options.SetStringValue("fixed_variable_treatment",
                         pass.fixed_stay ? "relax_bounds" : "make_parameter");
  options.SetStringValue("linear_solver", "mumps");
  if (settings.hessian == "limited_memory")
    options.SetStringValue("hessian_approximation", "limited-memory");
  if (quadratic)
    for (const char* constant : {"jac_c_constant", "jac_d_constant", "hessian_constant"})
      options.SetStringValue(constant, "yes");
  if (!pass.warm && settings.first_barrier < kUsualBarrier) {
    // A first guess worth keeping is not pushed far from its bounds.
    options.SetNumericValue("mu_init", settings.first_barrier);
    for (const char* push : {"bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac"})
      options.SetNumericValue(push, std::min(1e-2, settings.first_barrier));
  }
  if (!pass.warm) return;
  options.SetStringValue("warm_start_init_point", "yes");
  options.SetNumericValue("mu_init", kWarmBarrier);
  for (const char* push :
       {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_slack_bound_push",
        "warm_start_slack_bound_frac", "warm_start_mult_bound_push"})
    options.SetNumericValue(push, kWarmPush);
}

}  // namespace

void run_pass(const PassRequest& request, Program& program, SolveRecord& record,
              PassOutcome& outcome) {
  static std::mutex one_at_a_time;  // MUMPS keeps state of its own
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  ::Ipopt::SmartPtr<::Ipopt::IpoptApplication> app = new ::Ipopt::IpoptApplication(false);
  const ::Ipopt::SmartPtr<LogJournal> journal = new LogJournal;
  app->Jnlst()->AddJournal(GetRawPtr(journal));
  set_options(*app->Options(), request, program.problem().quadratic());
  auto status = app->Initialize("");  // no option file of the working directory
  if (status == ::Ipopt::Solve_Succeeded) {
    ::Ipopt::SmartPtr<Bridge> bridge =
        new Bridge(program, request.request, request.settings, record, outcome);
    status = app->OptimizeTNLP(GetRawPtr(bridge));
  }
  if (status == ::Ipopt::Insufficient_Memory || journal->out_of_memory()) throw std::bad_alloc();
  outcome.end = end_of(status);
  outcome.name = name_of(status);
}

}  // namespace lapwing
