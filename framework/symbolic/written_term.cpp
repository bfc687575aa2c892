// SPDX-License-Identifier: Apache-2.0
#include "framework/symbolic/written_term.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapwing {

namespace {

std::vector<double> for_all_rows(const WrittenTerm& term, const std::vector<double>& bounds,
                                 double none, const char* which) {
  const int rows = term.shape.tape->rows();
  if (bounds.empty()) return std::vector<double>(rows, none);
  if (bounds.size() == 1) return std::vector<double>(rows, bounds[0]);
  if (static_cast<int>(bounds.size()) != rows)
    throw InputError(term.origin, term.what() + ": " + which + " has " +
                                      std::to_string(bounds.size()) +
                                      " numbers, the function returns " + std::to_string(rows));
  return bounds;
}

// Blocks that a plan's samples hold, by the names of the shipped models; a free block does not
// reach the plan, but for the target.
bool is_in_plans(const std::string& block) {
  static const std::vector<std::string> known{"time",          "step",
                                              "position",      "yaw",
                                              "velocity",      "yaw_rate",
                                              "force",         "yaw_torque",
                                              "target",        "orientation",
                                              "body_rates",    "gimbal_yaw",
                                              "gimbal_pitch",  "gimbal_yaw_rate",
                                              "rotor_thrusts", "gimbal_pitch_rate"};
  return std::find(known.begin(), known.end(), block) != known.end();
}

// What the plan says of the constraint, but for its parameters.
void state_constraint(WrittenTerm& term, const std::vector<double>& lower,
                      const std::vector<double>& upper, const Horizon& horizon) {
  StatedConstraint& stated = term.stated;
  stated.name = term.name;
  stated.required = term.required;
  if (horizon.step_free &&
      !(term.shape.times.empty() && term.shape.spans.empty() && term.shape.except.empty()))
    stated.unjudged = "it names times of a flight whose times are free";
  if (term.recorded.operations.size() > StatedConstraint::kMostOperations)
    stated.unjudged =
        "it takes more than " + std::to_string(StatedConstraint::kMostOperations) + " operations";
  for (const ConstraintStep& step : term.recorded.operations) {
    if (step.op == ConstraintOp::input && !is_in_plans(step.name))
      stated.unjudged = "it reads '" + step.name + "', which plans do not have";
    if (!std::isfinite(step.number)) stated.unjudged = "it uses a number that is not finite";
  }
  if (!stated.unjudged.empty()) return;
  stated.times = term.shape.times;
  stated.spans = term.shape.spans;
  stated.except = term.shape.except;
  for (std::size_t r = 0; r < lower.size(); ++r) {
    ConstraintResult result{.operation = term.recorded.results[r]};
    if (std::isfinite(lower[r])) result.lower = lower[r];
    if (std::isfinite(upper[r])) result.upper = upper[r];
    if (result.lower || result.upper) stated.results.push_back(result);
  }
  if (stated.results.empty()) stated.unjudged = "its bounds are infinite";
  stated.operations = term.recorded.operations;
}

}  // namespace

void add_written_term(WrittenTerm& term, TermFormula& formula, const SymbolicEntries& rows,
                      const Origin& place, TrajectoryProblem& problem) {
  formula.compile(rows, place, term.shape);
  const bool cost = term.kind == WrittenTermKind::cost;
  if (!cost) term.recorded = formula.operations();
  term.shape.parameters = term.parameters.values;
  if (!term.shape.times.empty() && term.shape.window > 1)
    throw InputError(term.origin,
                     term.what() + ": at given times there is no neighbouring stage to read");
  if (cost) {
    problem.add_cost(term.name, term.weight, tape_cost(term.shape));
    return;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> lower = for_all_rows(term, term.lower, -kInfinity, "lower");
  std::vector<double> upper = for_all_rows(term, term.upper, kInfinity, "upper");
  for (std::size_t r = 0; r < lower.size(); ++r)
    if (lower[r] > upper[r])
      throw InputError(term.origin,
                       term.what() + ": lower is above upper in result " + std::to_string(r + 1));
  state_constraint(term, lower, upper, problem.horizon());
  if (!term.held) return;
  problem.add_constraint(term.name,
                         tape_constraint(term.shape, std::move(lower), std::move(upper)));
}

StatedConstraint stated_constraint(const WrittenTerm& term) {
  StatedConstraint stated = term.stated;
  if (!stated.operations.empty())
    for (const auto& [place, parameter] : term.recorded.parameters)
      stated.operations[place].number = (*term.parameters.values)[parameter];
  return stated;
}

}  // namespace lapwing
