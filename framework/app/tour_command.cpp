// SPDX-License-Identifier: Apache-2.0
#include "framework/app/tour_command.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "framework/app/interruption.h"
#include "framework/app/text_table.h"
#include "framework/config/overrides.h"
#include "framework/core/visible_text.h"
#include "framework/view/orienteering_file.h"
#include "framework/view/tour_solver.h"

namespace lapwing {
namespace {

struct SolvedTour {
  const TourProblem* problem = nullptr;
  std::string file, instance, solver;
  TourResult result;
};

Value finite_or_null(double number) {
  return std::isfinite(number) ? Value(number) : Value();
}

std::string shown_number(double number, const char* format = "%.6g") {
  if (!std::isfinite(number)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

// Nodes are numbered as in the file, from 1.
Value value_of(const SolvedTour& solved) {
  const TourReport& report = solved.result.report;
  Value row = Value::map();
  row.set("file", solved.file);
  row.set("instance", solved.instance);
  row.set("nodes", solved.problem->views());
  row.set("cost_limit", solved.problem->budget());
  row.set("solver", solved.solver);
  row.set("status", to_string(report.status));
  row.set("message", report.message);
  row.set("score", report.score);
  row.set("upper_bound", finite_or_null(report.upper_bound));
  row.set("gap", finite_or_null(report.gap));
  row.set("visited", report.images);
  row.set("length", report.seconds_used);
  row.set("evaluations", report.evaluations);
  row.set("iterations", report.iterations);
  row.set("seconds", report.wall_seconds);
  Value& walk = row.set("walk", Value::list());
  for (const int node : solved.result.walk) walk.push_back(static_cast<std::int64_t>(node + 1));
  return row;
}

std::vector<std::string> cells_of(const SolvedTour& solved) {
  const TourReport& report = solved.result.report;
  return {solved.instance,
          std::to_string(solved.problem->views()),
          shown_number(solved.problem->budget()),
          solved.solver,
          to_string(report.status),
          shown_number(report.score),
          shown_number(report.upper_bound),
          shown_number(100 * report.gap, "%.2f"),
          std::to_string(report.images),
          shown_number(report.seconds_used),
          shown_number(report.wall_seconds, "%.2f")};
}

}  // namespace

ExitStatus solve_tours(const TourRun& asked, const Invocation& invocation) {
  Value parameters = Value::map();
  for (const std::string& text : invocation.overrides) apply_override(parameters, text);
  const Registry registry = invocation.registry();
  std::vector<std::pair<std::string, std::unique_ptr<TourSolver>>> solvers;
  for (const std::string& name :
       asked.solvers.empty() ? std::vector<std::string>{"local_search"} : asked.solvers)
    solvers.emplace_back(name, registry.create<TourSolver>(name, parameters, name));
  std::vector<std::pair<std::string, TourProblem>> instances;
  for (const std::filesystem::path& file : asked.files) {
    OrienteeringInstance read = read_orienteering_file(file);
    const std::string name = read.name.empty() ? file.stem().string() : read.name;
    try {
      instances.emplace_back(name, TourProblem(std::move(read.definition)));
    } catch (const InputError& error) {
      throw InputError("'" + file.string() + "': " + error.what());
    }
  }
  const Interruption interruption;
  std::vector<SolvedTour> all;
  bool found = true;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    for (const auto& [name, solver] : solvers) {
      if (interruption.token().cancelled()) break;
      TourRequest request;
      request.seed = invocation.seed;
      request.wall_clock_guard = asked.guard;
      request.cancellation = &interruption.token();
      const auto& [instance, problem] = instances[i];
      all.push_back(
          {&problem, asked.files[i].string(), instance, name, solver->solve(problem, request)});
      found = found && !all.back().result.walk.empty();
    }
  }
  if (invocation.json) {
    Value object = Value::map();
    Value& rows = object.set("tours", Value::list());
    for (const SolvedTour& solved : all) rows.push_back(value_of(solved));
    print_json(object);
  } else {
    TextTable table{.rows = {{"instance", "nodes", "limit", "solver", "status", "score", "bound",
                              "gap %", "visited", "length", "s"}},
                    .keys = 1};
    for (const SolvedTour& solved : all) table.rows.push_back(cells_of(solved));
    std::fputs(text_of(table, columns_of_stdout()).c_str(), stdout);
    for (const SolvedTour& solved : all)
      if (solved.result.walk.empty())
        std::printf("%s: %s: %s\n", visible_line(solved.instance).c_str(), solved.solver.c_str(),
                    visible_line(solved.result.report.message).c_str());
  }
  if (interruption.token().cancelled()) return ExitStatus::interrupted;
  return found ? ExitStatus::done : ExitStatus::not_certified;
}

}  // namespace lapwing
