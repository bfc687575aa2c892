// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/check.h"

#include <algorithm>
#include <cmath>

#include "framework/conformance/differences.h"
#include "framework/conformance/function_checks.h"
#include "framework/export/exporter.h"
#include "framework/flight_log/flight_log_reader.h"
#include "framework/items/executor.h"
#include "framework/shape/shape.h"

namespace lapwing {
namespace {

// Bounds are numbers, in order, and a range has the same meaning as its instances one by one.
void check_bounds(const BoundSubject& subject, Findings& findings) {
  const auto& constraint = static_cast<const Constraint&>(subject.function);
  const int m = subject.shape.rows, count = subject.count();
  std::vector<double> lower(count * m, std::nan("")), upper(lower), low(m), high(m);
  constraint.bounds({0, count}, lower.data(), upper.data());
  for (int k = 0; k < count; ++k) {
    constraint.bounds({k, 1}, low.data(), high.data());
    for (int r = 0; r < m; ++r) {
      const double l = lower[k * m + r], u = upper[k * m + r];
      const std::string at = "row " + std::to_string(r) + " of instance " + std::to_string(k);
      findings.expect("bounds", l <= u && l < HUGE_VAL && u > -HUGE_VAL,
                      [&] { return at + " lies between " + text_of(l) + " and " + text_of(u); });
      findings.expect("bounds", low[r] == l && high[r] == u,
                      [&] { return at + " has other bounds alone than in a range"; });
    }
  }
}

template <class Kind>
std::vector<CheckResult> check_registered(const Registry& registry, const PluginEntry& entry,
                                          const CheckOptions& options,
                                          std::vector<CheckResult> (*check)(const Specimen<Kind>&,
                                                                            const CheckOptions&)) {
  return check(subject_of<Kind>(registry, entry), options);
}

}  // namespace

bool CheckOptions::wants(const std::string& check) const {
  return only.empty() || std::find(only.begin(), only.end(), check) != only.end();
}

bool CheckOptions::wants_any(std::initializer_list<const char*> checks) const {
  return std::any_of(checks.begin(), checks.end(), [&](const char* check) { return wants(check); });
}

std::vector<std::vector<std::string>> check_groups(const std::string& kind) {
  if (kind == CostTerm::kKind || kind == Constraint::kKind) {
    std::vector<std::vector<std::string>> groups{
        {"creation"}, {"values", "pattern"}, {"derivatives"}, {"curvature"}, {"ranges"},
        {"affine"},   {"degenerate input"},  {"repeatable"},  {"threads"},   {"allocations"},
        {"identity"}, {"invariance"}};
    if (kind == Constraint::kKind) groups.push_back({"bounds"});
    return groups;
  }
  if (kind == VehicleModel::kKind)
    return {{"creation"},
            {"blocks"},
            {"bounds"},
            {"motion"},
            {"flow", "degenerate input"},
            {"derivatives"},
            {"curvature"},
            {"halves"},
            {"samples"},
            {"ranges"},
            {"repeatable", "threads", "allocations"},
            {"affine"}};
  if (kind == TrajectorySolver::kKind)
    return {{"creation"},
            {"point", "reported cost", "reported violations", "status", "optimum", "infeasible"},
            {"warm start"},
            {"repeatable"},
            {"work limit"},
            {"cancellation"},
            {"wall clock"}};
  if (kind == Map::kKind)
    return {{"creation"},
            {"empty", "integration", "ray casts", "boxes", "import"},
            {"touching", "means", "refusals"},
            {"repeatable", "threads"},
            {"round trip", "memory"}};
  if (kind == PathPlanner::kKind)
    return {{"creation"},
            {"answers", "honest", "messages", "paths", "work limit"},
            {"repeatable"},
            {"cancellation", "wall clock"}};
  if (kind == TourSolver::kKind)
    return {{"creation"},
            {"answers", "honest", "messages", "tours", "teams", "work", "upper bound"},
            {"repeatable"},
            {"cancellation", "wall clock"}};
  if (kind == ViewInformation::kKind)
    return {{"creation"}, {"finite", "at least 0", "repeats", "alone"}, {"submodular"}};
  if (kind == ViewUtility::kKind)
    return {{"creation"}, {"finite"}, {"repeatable"}, {"threads"},
            {"alone"},    {"truth"},  {"monotone"},   {"submodular"}};
  if (kind == Shape::kKind)
    return {{"creation"},
            {"values", "gradient", "curvature"},
            {"never too large", "sign", "depth", "surface", "bounds", "convex"},
            {"rays"},
            {"record"}};
  if (kind == Controller::kKind)
    return {{"creation"}, {"finite", "limits"}, {"follows"}, {"repeatable", "threads"}, {"time"}};
  if (kind == Exporter::kKind) return {{"creation"}, {"extension"}, {"repeatable", "contents"}};
  if (kind == FlightLogReader::kKind)
    return {{"creation"}, {"example", "repeatable"}, {"refusals"}, {"cut short"}, {"damage"}};
  if (kind == Executor::kKind)
    return {{"creation"}, {"exchange"},     {"items", "order"}, {"threads"},
            {"failure"},  {"cancellation"}, {"dispatch"}};
  return {};
}

std::vector<std::string> check_names(const std::string& kind) {
  std::vector<std::string> names;
  for (const auto& group : check_groups(kind))
    names.insert(names.end(), group.begin(), group.end());
  return names;
}

std::vector<CheckResult> check_cost_term(const Specimen<CostTerm>& subject,
                                         const CheckOptions& options) {
  Findings findings(options);
  check_stage_function({subject.parameters, subject.create, subject.declares}, options, findings,
                       [](const BoundSubject&) {});
  return std::move(findings).results();
}

std::vector<CheckResult> check_constraint(const Specimen<Constraint>& subject,
                                          const CheckOptions& options) {
  Findings findings(options);
  check_stage_function({subject.parameters, subject.create, subject.declares, true}, options,
                       findings, [&](const BoundSubject& bound) {
                         if (options.wants("bounds")) check_bounds(bound, findings);
                       });
  return std::move(findings).results();
}

std::vector<CheckResult> check_plugin(const Registry& registry, const PluginEntry& entry,
                                      const CheckOptions& options) {
  if (entry.kind == CostTerm::kKind)
    return check_registered<CostTerm>(registry, entry, options, check_cost_term);
  if (entry.kind == Constraint::kKind)
    return check_registered<Constraint>(registry, entry, options, check_constraint);
  if (entry.kind == VehicleModel::kKind)
    return check_registered<VehicleModel>(registry, entry, options, check_vehicle_model);
  if (entry.kind == TrajectorySolver::kKind)
    return check_registered<TrajectorySolver>(registry, entry, options, check_trajectory_solver);
  if (entry.kind == Map::kKind) return check_registered<Map>(registry, entry, options, check_map);
  if (entry.kind == PathPlanner::kKind)
    return check_registered<PathPlanner>(registry, entry, options, check_path_planner);
  if (entry.kind == ViewInformation::kKind)
    return check_registered<ViewInformation>(registry, entry, options, check_information);
  if (entry.kind == TourSolver::kKind)
    return check_registered<TourSolver>(registry, entry, options, check_tour_solver);
  if (entry.kind == ViewUtility::kKind)
    return check_registered<ViewUtility>(registry, entry, options, check_utility);
  if (entry.kind == Shape::kKind)
    return check_shape_plugin(subject_of<Shape>(registry, entry), options, &registry);
  if (entry.kind == Controller::kKind)
    return check_registered<Controller>(registry, entry, options, check_controller);
  if (entry.kind == Exporter::kKind)
    return check_registered<Exporter>(registry, entry, options, check_exporter);
  if (entry.kind == FlightLogReader::kKind)
    return check_registered<FlightLogReader>(registry, entry, options, check_flight_log);
  if (entry.kind == Executor::kKind)
    return check_registered<Executor>(registry, entry, options, check_executor);
  return {{"kind", Outcome::skipped, "no checks for plugins of kind " + entry.kind}};
}

}  // namespace lapwing
