// SPDX-License-Identifier: Apache-2.0
// The only source that includes CBC.
//
// How: the rows are passed to Clp as a sparse matrix; CBC minimises, so the objective changes its
// sign. Clp solves the linear relaxation, whose value is a first bound. Branch and bound follows,
// with Gomory, knapsack, rounding and flow cuts, and with heuristics (rounding, feasibility pump
// without a start, diving, RINS). The start is set as the first solution. Two handlers ask whether
// to end: one at nodes, one at every pivot of Clp, because a single relaxation can take long.
#include "plugins/tour_solvers/milp/integer_program.h"

#include <algorithm>
#include <cmath>
#include <coin/CbcEventHandler.hpp>
#include <coin/CbcHeuristic.hpp>
#include <coin/CbcHeuristicDiveCoefficient.hpp>
#include <coin/CbcHeuristicFPump.hpp>
#include <coin/CbcHeuristicRINS.hpp>
#include <coin/CbcModel.hpp>
#include <coin/CglFlowCover.hpp>
#include <coin/CglGomory.hpp>
#include <coin/CglKnapsackCover.hpp>
#include <coin/CglMixedIntegerRounding2.hpp>
#include <coin/CoinPackedMatrix.hpp>
#include <coin/OsiClpSolverInterface.hpp>
#include <memory>

namespace lapwing {

int IntegerProgram::add_column(double gain, double upper, bool whole) {
  objective.push_back(gain);
  column_upper.push_back(upper);
  integer.push_back(whole ? 1 : 0);
  return columns() - 1;
}

void IntegerProgram::add_row(double lower, const std::vector<Entry>& row, double upper) {
  entries.insert(entries.end(), row.begin(), row.end());
  row_start.push_back(entries.size());
  row_lower.push_back(lower);
  row_upper.push_back(upper);
}

double IntegerProgram::violation(const std::vector<double>& x) const {
  double worst = 0;
  for (int c = 0; c < columns(); ++c) worst = std::max({worst, -x[c], x[c] - column_upper[c]});
  for (int r = 0; r < rows(); ++r) {
    double sum = 0;
    for (std::size_t i = row_start[r]; i < row_start[r + 1]; ++i) {
      sum += entries[i].factor * x[entries[i].column];
    }
    worst = std::max({worst, row_lower[r] - sum, sum - row_upper[r]});
  }
  return worst;
}

namespace {

using Ended = std::function<bool(std::int64_t)>;

// Both stop at the next opportunity. CBC copies its handlers; what they ask outlives all copies.
class NodeHandler final : public CbcEventHandler {
 public:
  explicit NodeHandler(const Ended* ended) : ended_(ended) {}
  CbcAction event(CbcEvent) override {
    const bool stops = *ended_ && (*ended_)(model_ ? model_->getNodeCount() : 0);
    return stops ? stop : noAction;
  }
  CbcEventHandler* clone() const override { return new NodeHandler(*this); }

 private:
  const Ended* ended_;
};

class PivotHandler final : public ClpEventHandler {
 public:
  explicit PivotHandler(const Ended* ended) : ended_(ended) {}
  int event(Event which) override {
    const bool stops = which == endOfIteration && *ended_ && (*ended_)(0);
    return stops ? 0 : -1;
  }
  ClpEventHandler* clone() const override { return new PivotHandler(*this); }

 private:
  const Ended* ended_;
};

double coin(double bound) {
  return std::isinf(bound) ? std::copysign(COIN_DBL_MAX, bound) : bound;
}

void load(const IntegerProgram& program, OsiClpSolverInterface& solver) {
  std::vector<int> rows, columns;
  std::vector<double> factors;
  for (int r = 0; r < program.rows(); ++r) {
    for (std::size_t i = program.row_start[r]; i < program.row_start[r + 1]; ++i) {
      rows.push_back(r);
      columns.push_back(program.entries[i].column);
      factors.push_back(program.entries[i].factor);
    }
  }
  CoinPackedMatrix matrix(true, rows.data(), columns.data(), factors.data(),
                          static_cast<CoinBigIndex>(factors.size()));
  matrix.setDimensions(program.rows(), program.columns());
  std::vector<double> lower(program.columns(), 0), upper, cost, row_lower, row_upper;
  for (const double bound : program.column_upper) upper.push_back(coin(bound));
  for (const double gain : program.objective) cost.push_back(-gain);
  for (const double bound : program.row_lower) row_lower.push_back(coin(bound));
  for (const double bound : program.row_upper) row_upper.push_back(coin(bound));
  solver.loadProblem(matrix, lower.data(), upper.data(), cost.data(), row_lower.data(),
                     row_upper.data());
  for (int c = 0; c < program.columns(); ++c) {
    if (program.integer[c]) solver.setInteger(c);
  }
}

void add_cuts_and_heuristics(CbcModel& model) {
  CglGomory gomory;
  gomory.setLimit(300);
  CglKnapsackCover cover;
  CglMixedIntegerRounding2 rounding;
  CglFlowCover flow;
  // -98: at the root, and later where they helped.
  model.addCutGenerator(&gomory, -98, "gomory");
  model.addCutGenerator(&cover, -98, "cover");
  model.addCutGenerator(&rounding, -98, "rounding");
  model.addCutGenerator(&flow, -98, "flow");
  CbcRounding simple(model);
  CbcHeuristicFPump pump(model);
  pump.setMaximumPasses(20);
  CbcHeuristicDiveCoefficient dive(model);
  dive.setWhen(3);
  CbcHeuristicRINS neighbourhood(model);
  neighbourhood.setHowOften(20);
  model.addHeuristic(&simple, "rounding");
  if (!model.bestSolution()) model.addHeuristic(&pump, "pump");
  model.addHeuristic(&dive, "dive");
  model.addHeuristic(&neighbourhood, "neighbourhood");
}

}  // namespace

IntegerResult solve_program(const IntegerProgram& program, const IntegerSearch& search) {
  IntegerResult result;
  result.x = search.start;
  OsiClpSolverInterface solver;
  solver.messageHandler()->setLogLevel(0);
  solver.setHintParam(OsiDoReducePrint, true, OsiHintTry);
  load(program, solver);
  const PivotHandler pivots(&search.ended);
  solver.getModelPtr()->passInEventHandler(&pivots);
  solver.getModelPtr()->setRandomSeed(search.seed);
  solver.initialSolve();
  if (solver.isProvenPrimalInfeasible()) {
    result.infeasible = true;
    return result;
  }
  if (!solver.isProvenOptimal()) return result;  // ended within the first linear program
  result.bound = -solver.getObjValue();

  CbcModel model(solver);
  model.messageHandler()->setLogLevel(0);
  model.solver()->messageHandler()->setLogLevel(0);
  model.setLogLevel(0);
  const NodeHandler nodes(&search.ended);
  model.passInEventHandler(&nodes);
  model.setRandomSeed(search.seed);
  model.setMaximumNodes(search.nodes);
  model.setUseElapsedTime(true);
  if (search.seconds_left) model.setMaximumSeconds(std::max(0.01, *search.seconds_left));
  model.setAllowableGap(1e-9);
  if (!search.start.empty()) {
    double cost = 0;
    for (int c = 0; c < program.columns(); ++c) cost -= program.objective[c] * search.start[c];
    model.setBestSolution(search.start.data(), program.columns(), cost, false);
  }
  add_cuts_and_heuristics(model);
  model.branchAndBound();

  result.nodes = model.getNodeCount();
  result.optimal = model.isProvenOptimal();
  result.infeasible = model.isProvenInfeasible() && search.start.empty();
  result.bound = std::min(result.bound, -model.getBestPossibleObjValue());
  if (const double* best = model.bestSolution()) {
    std::vector<double> x(best, best + program.columns());
    for (int c = 0; c < program.columns(); ++c) {
      if (program.integer[c]) x[c] = std::round(x[c]);
    }
    result.x = std::move(x);
  }
  return result;
}

}  // namespace lapwing
