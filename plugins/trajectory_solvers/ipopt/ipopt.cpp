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

constexpr double kNoBound = 2e19;     // Ipopt takes what is beyond 1e19 as none
constexpr double kWarmBarrier = 1e-6;  // where the barrier parameter begins from an earlier answer
constexpr double kWarmPush = 1e-9;     // how far from its bounds an earlier answer is moved

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
    settings_.acceptable_iterations =
        static_cast<int>(parameters.integer("acceptable_iterations"));
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
};

// Between Ipopt and the program.
class Bridge final : public ::Ipopt::TNLP {
 public:
  Bridge(Program& program, const SolveRequest& request, SolveRecord& record, double feasibility,
         Outcome& outcome)
      : program_(program),
        request_(request),
        record_(record),
        feasibility_(feasibility),
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

  bool intermediate_callback(::Ipopt::AlgorithmMode, Index iteration, Number, Number, Number,
                             Number, Number, Number, Number, Number alpha, Index,
                             const ::Ipopt::IpoptData*,
                             ::Ipopt::IpoptCalculatedQuantities*) override {
    outcome_.iterations = iteration;
    if (request_.progress)
      request_.progress->report(-1.0, "interior-point iteration " + std::to_string(iteration));
    if (!accepted_.empty()) keep(accepted_, alpha);
    outcome_.stopped = record_.stopped();
    return !outcome_.stopped;
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
    if (record_.latest().violation > feasibility_ || record_.latest().cost >= best_cost_) return;
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
  SolveRecord& record_;
  double feasibility_;
  Outcome& outcome_;
  std::vector<Number> accepted_;  // the iterate, known by where derivatives were last asked for
  VectorXd best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  bool begun_ = false;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Ipopt)
