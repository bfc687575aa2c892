// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/joined_solution.h"

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kMissed = 1e-5;  // largest violation of a row or bound, in its unit

bool ended_well(SolveStatus status) {
  return status == SolveStatus::optimal || status == SolveStatus::feasible;
}

// Where the layouts of two problems agree, numbers of a stage have the same places in both.
void expect_same_blocks(const StageLayout& whole, const StageLayout& part) {
  bool same = whole.count() == part.count();
  for (int b = 0; same && b < whole.count(); ++b)
    same = whole.block(b).name == part.block(b).name && whole.block(b).size == part.block(b).size;
  if (!same) throw InputError("join: a part has other blocks than the whole");
}

// The part's stages behind the `count` that are there, without its clock.
void append(const SolutionPart& part, const StageLayout& layout, Stages& at, int& count) {
  const Stages& stages = part.solution->result.point.stages;
  const int size = part.last - part.first + 1;
  if (part.first < 0 || size < 1 || part.last >= stages.cols() || count + size > at.cols())
    throw InputError("join: stages " + std::to_string(part.first) + " to " +
                     std::to_string(part.last) + " of a part with " +
                     std::to_string(stages.cols()) + " do not fit behind " + std::to_string(count) +
                     " of " + std::to_string(at.cols()));
  for (int b = 0; b < layout.count(); ++b)
    if (layout.block(b).role != BlockRole::clock)
      at.block(layout.offset(b), count, layout.block(b).size, size) =
          stages.block(layout.offset(b), part.first, layout.block(b).size, size);
  count += size;
}

}  // namespace

SolutionObject join(const ProblemObject& whole, const std::vector<SolutionPart>& parts) {
  if (parts.empty()) throw InputError("join: expected at least one part");
  const TrajectoryProblem& problem = *whole.problem;
  SolutionObject joined;
  joined.problem = whole.problem;
  joined.solver = parts.front().solution->solver;
  SolveReport& report = joined.result.report;
  int unfinished = 0;
  SolveStatus first = SolveStatus::feasible;  // status of the first part that did not end well
  std::string why;
  Stages at = problem.initial_guess();
  int count = 0;
  for (const SolutionPart& part : parts) {
    expect_same_blocks(problem.layout(), part.solution->problem->layout());
    append(part, problem.layout(), at, count);
    const SolveReport& own = part.solution->result.report;
    report.iterations += own.iterations;
    report.seconds += own.seconds;
    if (ended_well(own.status)) continue;
    if (unfinished++ > 0) continue;
    first = own.status;
    why = own.message;
  }
  if (count != at.cols())
    throw InputError("join: the parts make " + std::to_string(count) + " stages of " +
                     std::to_string(at.cols()));
  report.terms = problem.term_costs(at);
  for (const TermCost& term : report.terms) report.cost += term.cost;
  report.violations = problem.violations(at);
  const double worst = report.violations.empty() ? 0.0 : report.violations.front().amount;
  report.status = worst <= kMissed ? SolveStatus::feasible : first;
  report.message = "joined from " + std::to_string(parts.size()) + " parts";
  if (unfinished > 0)
    report.message += ", " + std::to_string(unfinished) +
                      " of which did not end well, the first as " + to_string(first) +
                      (why.empty() ? "" : ": " + why);
  joined.result.point.stages = std::move(at);
  return joined;
}

}  // namespace lapwing
