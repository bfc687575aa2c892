// SPDX-License-Identifier: Apache-2.0
// Tours of several batteries that share one score (view/team_problem.h).
#include <algorithm>
#include <cmath>

#include <lua.hpp>

#include "framework/core/log.h"
#include "framework/mission/fleet_objects.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"

namespace lapwing {
namespace {

constexpr BoundField kTeamFields[] = {
    {"name", "string", "name of the solver"},
    {"status", "string", "optimal, feasible, infeasible, iteration_limit, ..."},
    {"message", "string", "message of the solver"},
    {"score", "number", "score of the views of all tours together"},
    {"upper_bound", "number?", "upper bound of the score of any tours; nil if none is known"},
    {"gap", "number", "gap to the bound, as a fraction of the bound"},
    {"seconds", "number", "flight time of all tours, s"},
    {"images", "integer", "number of different views"},
    {"reachable", "integer", "number of views on any tour within its budget"},
    {"reachable_score", "number", "score of all reachable views"},
    {"evaluations", "integer", "evaluations of the score"},
    {"iterations", "integer", "iterations of the solver"},
    {"missed", "integer[]", "pinned views that are on none of the tours, by their numbers"},
    {"tours", "lapwing.tour[]", "one for each that was asked for; none if nothing was found"}};

int team_field(lua_State* state) {
  const TeamObject& team = object_argument<TeamObject>(state, 1, kTeamType);
  const std::string field = text_argument(state, 2, "team");
  if (field == "tours") {
    lua_createtable(state, static_cast<int>(team.tours.size()), 0);
    for (std::size_t i = 0; i < team.tours.size(); ++i) {
      new_object(state, kTourType, team.tours[i]);
      lua_rawseti(state, -2, static_cast<lua_Integer>(i + 1));
    }
    return 1;
  }
  Value fields = to_value(team.report, team.solver);
  fields.set("upper_bound",
             std::isfinite(team.report.upper_bound) ? Value(team.report.upper_bound) : Value());
  fields.set("gap", team.report.gap);
  Value& missed = fields.set("missed", Value::list());
  std::vector<std::vector<int>> walks;
  for (const TourObject& tour : team.tours) walks.push_back(tour.walk);
  if (!team.tours.empty())
    for (const int number : pinned_views_missed(*team.tours.front().work, walks))
      missed.push_back(std::int64_t{number});
  return push_field(state, "a team", field, fields, kTeamFields);
}

constexpr BoundField kTeamObjects[] = {
    {"graph", "lapwing.scan_graph", "graph of views"},
    {"solver", "lapwing.tour_solver", "solver; it takes teams"},
    {"initial?", "lapwing.team", "initial tours of the same graph, as many"}};

ParameterTable team_table() {
  ParameterTable tour;
  tour.required_text("name", "unique name of the tour")
      .integer("home", 1, "candidate at which it begins and ends, from 1", at_least(1));
  ParameterTable table;
  table.required_number("budget", "s", "flight time of each tour", above(0))
      .tables("tours", tour, "tours", true)
      .integer("images", 0, "largest number of images of each tour; 0: any number", at_least(0))
      .integer("iterations", 0, "iterations of the solver; 0: its default", at_least(0))
      .integer("evaluations", 0, "largest number of evaluations of the score; 0: any number",
               at_least(0))
      .optional_number("guard", "s", "wall-clock limit", above(0));
  return table;
}

TeamProblem team_problem(const ScanWork& work, const Parameters& given) {
  TourDefinition definition = tour_definition(work, "solve_team");
  definition.budget = given.number("budget");
  if (given.integer("images") > 0)
    definition.image_limit = static_cast<int>(given.integer("images"));
  const auto count = static_cast<std::int64_t>(work.graph.candidates.viewpoints.size());
  std::vector<TeamTour> tours;
  for (const Parameters& tour : given.tables("tours")) {
    const std::int64_t home = tour.integer("home");
    if (home > count)
      throw InputError(tour.origin("home"),
                       "solve_team: there are candidates from 1 to " + std::to_string(count));
    definition.start = definition.end = static_cast<int>(home - 1);
    const auto same = std::find_if(tours.begin(), tours.end(), [&](const TeamTour& other) {
      return other.problem.start() == definition.start;
    });
    tours.push_back({tour.text("name"),
                     same == tours.end()
                         ? TourProblem(definition)
                         : same->problem.with_limits(definition.budget, definition.image_limit)});
  }
  return TeamProblem(std::move(tours));
}

// What is told of one tour of several: no bound is known of it but what it could reach.
TourReport report_of_tour(const TeamReport& team, const TourProblem& problem,
                          const std::vector<int>& walk, int tours) {
  TourReport report = team;
  report.message = "one of " + std::to_string(tours) + " tours that share one score" +
                   (team.message.empty() ? "" : "; " + team.message);
  if (report.status == TourStatus::optimal) report.status = TourStatus::feasible;
  report.score = problem.score_of(walk);
  report.seconds_used = problem.seconds_of(walk);
  report.images = TourProblem::images_of(walk);
  const std::vector<int> reachable = problem.reachable();
  report.reachable = static_cast<int>(reachable.size());
  report.reachable_score = problem.score_of(reachable);
  report.upper_bound = std::min(team.upper_bound, report.reachable_score);
  report.gap = report.upper_bound > 0
                   ? std::max(0.0, (report.upper_bound - report.score) / report.upper_bound)
                   : 0;
  return report;
}

TeamRequest team_request(lua_State* state, const MissionRun& run, const ScanWork& work,
                         const Parameters& given) {
  TeamRequest request;
  request.limits.seed = run.settings.seed;
  if (given.integer("iterations") > 0) request.limits.iteration_limit = given.integer("iterations");
  if (run.settings.observe_estimate) {
    const std::int64_t most = estimate_iterations(work.graph.candidates.viewpoints.size());
    request.limits.iteration_limit = std::min(request.limits.iteration_limit.value_or(most), most);
  }
  if (given.integer("evaluations") > 0)
    request.limits.evaluation_limit = given.integer("evaluations");
  if (given.has("guard")) request.limits.wall_clock_guard = given.number("guard");
  request.limits.cancellation = run.settings.cancellation;
  request.limits.progress = run.settings.progress;
  if (lua_getfield(state, 2, "initial") != LUA_TNIL) {
    request.initial.emplace();
    for (const TourObject& tour : object_argument<TeamObject>(state, -1, kTeamType).tours)
      request.initial->push_back(tour.walk);
  }
  return request;
}

// run:solve_team{graph =, solver =, budget =, tours = {{name =, home =}, ...}, images =, initial =}
int solve_team_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, team_table(), "solve_team", kTeamObjects);
  if (run.settings.observe_tour)
    throw InputError(
        "solve_team: a study of scans compares tours of one battery; "
        "expected a mission with one");
  lua_getfield(state, 2, "graph");
  const std::shared_ptr<const ScanWork> work =
      object_argument<GraphObject>(state, -1, kGraphType).work;
  const PluginChoice chosen = choice_at(state, 2, "solver");
  TeamObject team;
  team.solver = chosen.type;
  const TeamRequest request = team_request(state, run, *work, given);
  const auto solver =
      run.settings.registry->create<TourSolver>(chosen.type, chosen.parameters, "tour.solver");
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const TeamProblem problem = team_problem(*work, given);
    const std::string wrong = request.initial ? problem.problem_of(*request.initial) : "";
    if (!wrong.empty())
      throw InputError("solve_team: the initial tours are not tours of this problem: " + wrong);
    TeamResult result = solver->solve(problem, request);
    if (result.report.status == TourStatus::failed) throw PluginError(result.report.message);
    team.report = result.report;
    if (request.initial) {
      lua_getfield(state, 2, "initial");
      take_over_time_limit(object_argument<TeamObject>(state, -1, kTeamType).report, team.report);
    }
    team.reachable = problem.reachable();
    take_out_pinned(*work, result.walks, team.reachable, team.report);
    for (std::size_t i = 0; i < result.walks.size(); ++i) {
      const TourProblem& tour = problem.tour(static_cast<int>(i));
      TourReport report = report_of_tour(team.report, tour, result.walks[i], problem.size());
      take_out_pinned(*work, {result.walks[i]}, tour.reachable(), report);
      team.tours.push_back({work, chosen.type, tour.budget(), std::move(report),
                            std::move(result.walks[i]), nullptr, team.reachable});
    }
  }
  run.solve_seconds += team.report.wall_seconds;
  logging::info(chosen.type + ": " + std::to_string(team.tours.size()) + " tours, " +
                to_string(team.report.status) + ", score " + std::to_string(team.report.score) +
                ", " + std::to_string(team.report.seconds_used) + " s, " +
                std::to_string(team.report.images) + " images, " +
                std::to_string(team.report.evaluations) + " evaluations" +
                (team.report.message.empty() ? "" : "; " + team.report.message));
  new_object(state, kTeamType, std::move(team));
  return 1;
}

// run:team_solvers(): names.
int team_solvers(lua_State* state) {
  Value names = Value::list();
  for (const PluginEntry& entry : run_of(state).settings.registry->entries())
    if (entry.kind == TourSolver::kKind &&
        std::find(entry.extensions.begin(), entry.extensions.end(), kTakesTeams) !=
            entry.extensions.end())
      names.push_back(entry.name);
  push_value(state, names);
  return 1;
}

}  // namespace

void open_team_type(lua_State* state) {
  define_type<TeamObject>(state, kTeamType, {}, &guarded<team_field>);
  note_fields(state, kTeamType, kTeamFields);
}

std::span<const Binding> team_methods_of_run() {
  static const Binding methods[] = {
      {"solve_team", &guarded<solve_team_of_run>, "(settings: @): lapwing.team",
       "tours of views within a budget each, that share one score", &team_table, kTeamObjects},
      {"team_solvers", &guarded<team_solvers>, "(): string[]",
       "names of the tour solvers that run:solve_team takes"}};
  return methods;
}

}  // namespace lapwing
