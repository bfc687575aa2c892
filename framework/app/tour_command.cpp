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
  const TeamProblem* problem = nullptr;
  std::string file, instance, solver;
  TeamResult result;
};

// A single tour is solved as what it is: solvers that take no teams take that.
TeamResult solve_one(const TourSolver& solver, const TourProblem& problem,
                     const TourRequest& request) {
  TourResult one = solver.solve(problem, request);
  TeamResult result;
  static_cast<TourReport&>(result.report) = one.report;
  if (one.walk.empty()) return result;
  result.report.tours = {{"1", one.report.seconds_used, problem.budget(), one.report.images}};
  result.walks = {std::move(one.walk)};
  return result;
}

TeamResult solve(const TourSolver& solver, const TeamProblem& problem, const TourRequest& request) {
  if (problem.size() == 1) return solve_one(solver, problem.tour(0), request);
  TeamRequest of_team;
  of_team.limits = request;
  return solver.solve(problem, of_team);
}

TeamProblem problem_of(TourDefinition definition, int team) {
  definition.budget /= team;
  return equal_tours(std::move(definition), team);
}

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
  const TeamReport& report = solved.result.report;
  Value row = Value::map();
  row.set("file", solved.file);
  row.set("instance", solved.instance);
  row.set("nodes", solved.problem->views());
  row.set("cost_limit", solved.problem->tour(0).budget());
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
  const auto nodes_of = [](const std::vector<int>& walk) {
    Value nodes = Value::list();
    for (const int node : walk) nodes.push_back(static_cast<std::int64_t>(node + 1));
    return nodes;
  };
  const Walks& walks = solved.result.walks;
  if (solved.problem->size() == 1) {
    row.set("walk", walks.empty() ? Value::list() : nodes_of(walks.front()));
    return row;
  }
  Value& tours = row.set("team", Value::list());
  for (std::size_t t = 0; t < walks.size(); ++t) {
    Value tour = Value::map();
    tour.set("length", report.tours[t].seconds_used);
    tour.set("visited", report.tours[t].images);
    tour.set("walk", nodes_of(walks[t]));
    tours.push_back(std::move(tour));
  }
  return row;
}

std::vector<std::string> cells_of(const SolvedTour& solved) {
  const TeamReport& report = solved.result.report;
  return {solved.instance,
          std::to_string(solved.problem->views()),
          shown_number(solved.problem->tour(0).budget()),
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
  std::vector<std::pair<std::string, TeamProblem>> instances;
  for (const std::filesystem::path& file : asked.files) {
    OrienteeringInstance read = read_orienteering_file(file);
    const std::string name = read.name.empty() ? file.stem().string() : read.name;
    try {
      instances.emplace_back(name, problem_of(std::move(read.definition), asked.team));
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
          {&problem, asked.files[i].string(), instance, name, solve(*solver, problem, request)});
      found = found && !all.back().result.walks.empty();
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
      if (solved.result.walks.empty())
        std::printf("%s: %s: %s\n", visible_line(solved.instance).c_str(), solved.solver.c_str(),
                    visible_line(solved.result.report.message).c_str());
  }
  if (interruption.token().cancelled()) return ExitStatus::interrupted;
  return found ? ExitStatus::done : ExitStatus::not_certified;
}

}  // namespace lapwing
