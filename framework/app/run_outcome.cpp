// SPDX-License-Identifier: Apache-2.0
#include "framework/app/run_outcome.h"

#include <cmath>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/export/flight_report.h"
#include "framework/export/report_value.h"

namespace lapwing {
namespace {

constexpr std::size_t kLargestObstacle = std::size_t{1} << 30;  // bytes, as the verifier reads

Value finite(double number) {
  return std::isfinite(number) ? Value(number) : Value();
}

}  // namespace

std::vector<std::string> told_notes(const MissionResult& result) {
  std::vector<std::string> all = result.notes;
  all.insert(all.end(), result.told.begin(), result.told.end());
  return all;
}

std::vector<std::string> all_notes(const MissionResult& result) {
  std::vector<std::string> all = told_notes(result);
  all.insert(all.end(), result.details.begin(), result.details.end());
  return all;
}

std::string status_of(const MissionResult& result, const Certificate& certificate, bool cancelled) {
  if (cancelled || result.report.status == SolveStatus::cancelled) return "cancelled";
  // Who stays where it is breaks no rule, but has done nothing of what was asked.
  const bool idle =
      result.report.status == SolveStatus::infeasible && !(result.plan.trajectory.duration() > 0);
  if (certificate.feasible() && !idle) return "ok";
  switch (result.report.status) {
    case SolveStatus::infeasible:
      return "infeasible";
    case SolveStatus::unsupported:
    case SolveStatus::numerical_error:
      return "failed";
    default:
      return "not_certified";
  }
}

ExitStatus exit_status_of(const std::string& status) {
  if (status == "ok") return ExitStatus::done;
  return status == "cancelled" ? ExitStatus::interrupted : ExitStatus::not_certified;
}

Value solver_figures(const MissionResult& result) {
  Value solver = Value::map();
  solver.set("name", result.solver);
  solver.set("status", to_string(result.report.status));
  solver.set("iterations", result.report.iterations);
  solver.set("cost", finite(result.report.cost));
  Value& terms = solver.set("terms", Value::map());
  for (const TermCost& term : result.report.terms) terms.set(term.name, finite(term.cost));
  return solver;
}

void complete_plan(MissionResult& result, const Certificate& certificate,
                   const std::string& status) {
  Plan& plan = result.plan;
  plan.certificate = certificate.to_value();
  std::vector<std::string> all = result.notes;
  all.insert(all.end(), result.details.begin(), result.details.end());
  if (!all.empty()) plan.solver.set("notes", Value(Value::List(all.begin(), all.end())));
  if (status == "cancelled") plan.solver.set("cancelled", true);
}

Report report_of(const MissionResult& result, const std::string& status, std::vector<Section> own,
                 std::optional<Viewer> viewer) {
  Report report = flight_report(result.plan, result.obstacle_folder);
  if (status == "cancelled") {
    report.status = "cancelled";
    report.status_mark = Mark::fail;
  }
  if (const auto all = all_notes(result); !all.empty()) {
    std::string text;
    for (const std::string& note : all) text += note + "\n\n";
    TextBlock findings;
    findings.text = text;
    report.sections.insert(report.sections.begin(), Section{"Findings", {findings}});
  }
  for (Section& section : sections_of(result)) own.push_back(std::move(section));
  report.sections.insert(report.sections.begin() + 1, own.begin(), own.end());
  report.viewer = std::move(viewer);
  return report;
}

void add_report(const Report& report, const Invocation& invocation, RunFiles& files) {
  files.report = render_html(report);
  if (invocation.report_data) files.report_data = to_json(to_value(report), -1) + "\n";
}

void add_obstacles(const MissionResult& result, RunFiles& files) {
  for (const std::string& name : result.obstacle_files) {
    std::string bytes = read_file(result.obstacle_folder / name, kLargestObstacle);
    if (name == "map.ot")
      files.map = std::move(bytes);
    else
      files.obstacles.emplace_back(name, std::move(bytes));
  }
}

}  // namespace lapwing
