// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ipopt_program.h"

#include <cstddef>

#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Ipopt::Index;
using Ipopt::Number;
using Entry = Eigen::SparseMatrix<double>::InnerIterator;

class Program final : public Ipopt::TNLP {
 public:
  Program(const QuadraticProgram& problem, QuadraticResult& result)
      : p_(problem), result_(result) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian,
                    IndexStyleEnum& style) override {
    n = p_.variables();
    m = p_.rows();
    jacobian = static_cast<Index>(p_.jacobian.nonZeros());
    hessian = static_cast<Index>(p_.hessian.nonZeros());
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index n, Number* xl, Number* xu, Index m, Number* gl, Number* gu) override {
    Eigen::Map<Eigen::VectorXd>(xl, n) = p_.x_lower.cwiseMax(-1e20);
    Eigen::Map<Eigen::VectorXd>(xu, n) = p_.x_upper.cwiseMin(1e20);
    Eigen::Map<Eigen::VectorXd>(gl, m) = p_.row_lower.cwiseMax(-1e20);
    Eigen::Map<Eigen::VectorXd>(gu, m) = p_.row_upper.cwiseMin(1e20);
    return true;
  }
  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool,
                          Number*) override {
    std::fill_n(x, n, 0.0);  // the programs are steps from the shared initial guess
    return true;
  }
  bool eval_f(Index n, const Number* x, bool, Number& f) override {
    f = p_.objective(Eigen::Map<const Eigen::VectorXd>(x, n));
    return true;
  }
  bool eval_grad_f(Index n, const Number* x, bool, Number* g) override {
    Eigen::Map<Eigen::VectorXd>(g, n) =
        p_.hessian.selfadjointView<Eigen::Lower>() * Eigen::Map<const Eigen::VectorXd>(x, n) +
        p_.gradient;
    return true;
  }
  bool eval_g(Index n, const Number* x, bool, Index m, Number* g) override {
    Eigen::Map<Eigen::VectorXd>(g, m) = p_.jacobian * Eigen::Map<const Eigen::VectorXd>(x, n);
    return true;
  }
  bool eval_jac_g(Index, const Number*, bool, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    return copy(p_.jacobian, 1.0, rows, columns, values);
  }
  bool eval_h(Index, const Number*, bool, Number scale, Index, const Number*, bool, Index,
              Index* rows, Index* columns, Number* values) override {
    return copy(p_.hessian, scale, rows, columns, values);
  }
  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number* zl,
                         const Number* zu, Index m, const Number*, const Number* lambda, Number,
                         const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
    const auto vector = [](const Number* v, Index size) {
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(v, size));
    };
    result_.x = vector(x, n);
    result_.row_multipliers = -vector(lambda, m);
    result_.bound_multipliers = vector(zl, n) - vector(zu, n);
  }

 private:
  static bool copy(const Eigen::SparseMatrix<double>& matrix, double scale, Index* rows,
                   Index* columns, Number* values) {
    Index k = 0;
    for (int j = 0; j < matrix.outerSize(); ++j)
      for (Entry e(matrix, j); e; ++e, ++k) {
        if (values)
          values[k] = scale * e.value();
        else
          rows[k] = static_cast<Index>(e.row()), columns[k] = j;
      }
    return true;
  }

  const QuadraticProgram& p_;
  QuadraticResult& result_;
};

}  // namespace

QuadraticResult solve_with_ipopt(const QuadraticProgram& problem, double tolerance, bool mehrotra) {
  QuadraticResult result;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> app = new Ipopt::IpoptApplication(false);
  app->Options()->SetIntegerValue("print_level", 0);
  app->Options()->SetNumericValue("tol", tolerance);
  app->Options()->SetStringValue("jac_c_constant", "yes");
  app->Options()->SetStringValue("jac_d_constant", "yes");
  app->Options()->SetStringValue("hessian_constant", "yes");
  if (mehrotra) app->Options()->SetStringValue("mehrotra_algorithm", "yes");
  app->Options()->SetStringValue("sb", "yes");
  if (app->Initialize() != Ipopt::Solve_Succeeded) throw Error("Ipopt does not start");
  const Ipopt::ApplicationReturnStatus status = app->OptimizeTNLP(new Program(problem, result));
  if (status != Ipopt::Solve_Succeeded && status != Ipopt::Solved_To_Acceptable_Level)
    throw Error("Ipopt ended with status " + std::to_string(status));
  result.status = QuadraticStatus::optimal;
  result.iterations = app->Statistics()->IterationCount();
  const QuadraticResiduals r =
      residuals(problem, result.x, result.row_multipliers, result.bound_multipliers);
  result.primal_residual = r.primal;
  result.dual_residual = r.dual;
  result.gap = r.gap;
  return result;
}

}  // namespace lapwing
