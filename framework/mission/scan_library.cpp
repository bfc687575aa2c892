// SPDX-License-Identifier: Apache-2.0
// Tours of views, and what scan missions may call.
#include <algorithm>
#include <cmath>

#include <lua.hpp>

#include "framework/core/log.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/scan_record.h"
#include "framework/view/footprint.h"

namespace lapwing {

PluginChoice choice_at(lua_State* state, int table, const char* key) {
  lua_getfield(state, table, key);
  return plugin_choice(state, lua_gettop(state), key);
}

TourDefinition tour_definition(const ScanWork& work, const std::string& function) {
  if (!work.passes.empty())
    throw InputError(function + ": the graph is of passes, which run:pass_tour orders");
  TourDefinition definition;
  definition.score = work.pinned.empty() ? work.graph.score : work.pinned_score;
  definition.view_seconds = {work.view_seconds};
  for (std::size_t k = 0; k < work.seconds.size(); ++k) {
    const ViewMotion& m = work.graph.motions.motions[k];
    definition.motions.push_back({m.a, m.b, work.seconds[k] - work.view_seconds});
  }
  definition.start = definition.end = work.home;
  return definition;
}

std::vector<int> pinned_views_missed(const ScanWork& work,
                                     const std::vector<std::vector<int>>& walks) {
  std::vector<int> missed;
  for (std::size_t k = 0; k < work.pinned.size(); ++k) {
    const bool taken = std::any_of(walks.begin(), walks.end(), [&](const std::vector<int>& walk) {
      return std::find(walk.begin(), walk.end(), work.pinned[k]) != walk.end();
    });
    if (!taken) missed.push_back(static_cast<int>(k) + 1);
  }
  return missed;
}

void take_out_pinned(const ScanWork& work, const std::vector<std::vector<int>>& walks,
                     const std::vector<int>& reachable, TourReport& report) {
  if (work.pinned.empty()) return;
  const double bonus = bonus_over(*work.graph.score);
  const auto all = static_cast<double>(work.pinned.size());
  const auto missed = static_cast<double>(pinned_views_missed(work, walks).size());
  const auto far = static_cast<double>(pinned_views_missed(work, {reachable}).size());
  report.score = std::max(0.0, report.score - (all - missed) * bonus);
  report.reachable_score = std::max(0.0, report.reachable_score - (all - far) * bonus);
  // Tours that leave out a pinned view are none: of those that take all, this many are counted.
  if (std::isfinite(report.upper_bound))
    report.upper_bound = std::max(
        report.score, std::min(report.upper_bound - (all - far) * bonus, report.reachable_score));
  report.gap = report.upper_bound > 0 && std::isfinite(report.upper_bound)
                   ? (report.upper_bound - report.score) / report.upper_bound
                   : 0;
}

namespace {

constexpr BoundField kTourFields[] = {
    {"name", "string", "name of the solver"},
    {"status", "string", "optimal, feasible, infeasible, iteration_limit, ..."},
    {"message", "string", "message of the solver"},
    {"score", "number", "score of its views"},
    {"upper_bound", "number?", "upper bound of the score of any tour; nil if none is known"},
    {"gap", "number", "gap to the bound, as a fraction of the bound"},
    {"seconds", "number", "flight time in s"},
    {"budget", "number", "s"},
    {"images", "integer", "number of different views"},
    {"visits", "integer", "views in order, including those that are only passed"},
    {"reachable", "integer", "number of views on any tour within the budget"},
    {"reachable_score", "number", "score of all reachable views"},
    {"evaluations", "integer", "evaluations of the score"},
    {"iterations", "integer", "iterations of the solver"},
    {"missed", "integer[]", "pinned views that are not on it, by their numbers"},
    {"legs", "table[]",
     "legs from view to view: {points, yaw_from, yaw_to, seconds}, m, rad, s without the pause"},
    {"flight", "table?",
     "for passes: {duration, times, positions, yaws, images}, s, m, rad; an image has a time and a "
     "position"}};

int tour_field(lua_State* state) {
  const TourObject& tour = object_argument<TourObject>(state, 1, kTourType);
  Value fields = to_value(tour.report, tour.solver);
  fields.set("budget", tour.budget);
  fields.set("visits", static_cast<std::int64_t>(tour.walk.size()));
  fields.set("upper_bound",
             std::isfinite(tour.report.upper_bound) ? Value(tour.report.upper_bound) : Value());
  fields.set("gap", tour.report.gap);
  Value& missed = fields.set("missed", Value::list());
  for (const int number : pinned_views_missed(*tour.work, {tour.walk}))
    missed.push_back(std::int64_t{number});
  const std::string field = text_argument(state, 2, "tour");
  fields.set("legs", field == "legs" && !tour.passing ? legs_of(tour) : Value());
  fields.set("flight", field == "flight" && tour.passing ? flight_of_passes(tour) : Value());
  return push_field(state, "a tour", field, fields, kTourFields);
}

constexpr BoundField kTourObjects[] = {
    {"graph", "lapwing.scan_graph", "graph of views"},
    {"solver", "lapwing.tour_solver", "solver"},
    {"initial?", "lapwing.tour", "initial tour of the same graph"}};
ParameterTable tour_table() {
  ParameterTable table;
  table.required_number("budget", "s", "flight time", above(0))
      .integer("finish", 1, "candidate at which it ends, from 1; absent: the start", at_least(1))
      .integer("images", 0, "largest number of images; 0: any number", at_least(0))
      .integer("iterations", 0, "iterations of the solver; 0: its default", at_least(0))
      .integer("evaluations", 0, "largest number of evaluations of the score; 0: any number",
               at_least(0))
      .optional_number("guard", "s", "wall-clock limit", above(0));
  return table;
}

// run:solve_tour{graph =, solver =, budget =, finish =, images =, initial = tour, iterations =}
int solve_tour_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, tour_table(), "solve_tour", kTourObjects);
  lua_getfield(state, 2, "graph");
  TourObject tour;
  tour.work = object_argument<GraphObject>(state, -1, kGraphType).work;
  const ScanWork& work = *tour.work;
  const PluginChoice chosen = choice_at(state, 2, "solver");
  tour.solver = chosen.type;
  tour.budget = given.number("budget");
  TourDefinition definition = tour_definition(work, "solve_tour");
  const auto count = static_cast<std::int64_t>(work.graph.candidates.viewpoints.size());
  if (given.integer("finish") > count)
    throw InputError(given.origin("finish"),
                     "solve_tour: there are candidates from 1 to " + std::to_string(count));
  definition.end = static_cast<int>(given.integer("finish") - 1);
  if (given.integer("images") > 0)
    definition.image_limit = static_cast<int>(given.integer("images"));
  definition.budget = tour.budget;
  TourRequest request;
  request.seed = run.settings.seed;
  if (given.integer("iterations") > 0) request.iteration_limit = given.integer("iterations");
  if (run.settings.observe_estimate) {
    const std::int64_t most = estimate_iterations(static_cast<std::size_t>(count));
    request.iteration_limit = std::min(request.iteration_limit.value_or(most), most);
  }
  if (given.integer("evaluations") > 0) request.evaluation_limit = given.integer("evaluations");
  if (given.has("guard")) request.wall_clock_guard = given.number("guard");
  request.cancellation = run.settings.cancellation;
  request.progress = run.settings.progress;
  const TourReport* begun = nullptr;
  if (lua_getfield(state, 2, "initial") != LUA_TNIL) {
    const TourObject& initial = object_argument<TourObject>(state, -1, kTourType);
    request.initial = initial.walk;
    begun = &initial.report;
  }
  const auto solver =
      run.settings.registry->create<TourSolver>(chosen.type, chosen.parameters, "tour.solver");
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    if (run.settings.observe_tour) run.settings.observe_tour(work, definition);
    const TourProblem problem(std::move(definition));
    const std::string wrong = request.initial ? problem.problem_of(*request.initial) : "";
    if (!wrong.empty())
      throw InputError("solve_tour: the initial tour is not a tour of this problem: " + wrong);
    TourResult result = solver->solve(problem, request);
    if (result.report.status == TourStatus::failed) throw PluginError(result.report.message);
    tour.report = result.report;
    if (begun) take_over_time_limit(*begun, tour.report);
    tour.walk = std::move(result.walk);
    tour.reachable = problem.reachable();
    take_out_pinned(work, {tour.walk}, tour.reachable, tour.report);
  }
  run.solve_seconds += tour.report.wall_seconds;
  logging::info(
      chosen.type + ": " + to_string(tour.report.status) + ", score " +
      std::to_string(tour.report.score) + ", " + std::to_string(tour.report.seconds_used) + " s, " +
      std::to_string(tour.report.images) + " images, " + std::to_string(tour.report.evaluations) +
      " evaluations" + (tour.report.message.empty() ? "" : "; " + tour.report.message));
  new_object(state, kTourType, std::move(tour));
  return 1;
}

constexpr BoundField kEstimateObjects[] = {
    {"tours", "lapwing.tour[]", "solved tours of one graph"}};
ParameterTable estimate_table() {
  ParameterTable table;
  table.boolean("changed", false, "true: the graph was made from one of other options");
  return table;
}

// run:estimate{tours =}: where only that is asked for, plans end here.
int estimate_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, estimate_table(), "estimate", kEstimateObjects);
  if (!run.settings.observe_estimate) return 0;
  std::vector<int> views;
  double seconds = 0;
  std::int64_t flown = 0;
  std::shared_ptr<const ScanWork> work;
  lua_getfield(state, 2, "tours");
  const int list = lua_gettop(state);
  for (lua_Integer k = 1; k <= luaL_len(state, list); ++k) {
    lua_rawgeti(state, list, k);
    const TourObject& tour = object_argument<TourObject>(state, -1, kTourType);
    if (TourProblem::images_of(tour.walk) > 1) {
      work = tour.work;
      views.insert(views.end(), tour.walk.begin(), tour.walk.end());
      seconds += tour.report.seconds_used;
      ++flown;
    }
    lua_pop(state, 1);
  }
  if (!work) throw InputError("estimate: no tour takes an image");
  std::sort(views.begin(), views.end());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const SurfaceAreas areas = areas_seen(*work, views, run.settings.threads);
  Value told = Value::map();
  told.set("tours", flown);
  told.set("images", static_cast<std::int64_t>(views.size()));
  told.set("seconds", seconds);
  told.set("changed", given.boolean("changed"));
  told.set("known", areas.known);
  told.set("seen", areas.seen);
  run.settings.observe_estimate(told);
  throw Cancelled();
}

ParameterTable first_flight_table() {
  ParameterTable table;
  table.tables("poses", viewpoint_table(), "where it takes its images", true)
      .table("camera", pinhole_table(), "camera of the images")
      .number("range", 60, "m", "largest depth", above(0))
      .number("level", 0, "m", "height of the ground, world");
  return table;
}

// run:first_flight{poses =, camera =, range =, level =}
int first_flight_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, first_flight_table(), "first_flight");
  if (!run.settings.observe_first_flight) return 0;
  const Pinhole pinhole = pinhole_of(given.table("camera"));
  Value told = Value::map();
  told.set("level", given.number("level"));
  Value& images = told.set("images", Value::list());
  for (const Parameters& pose : given.tables("poses")) {
    const Viewpoint view = viewpoint_of(pose);
    Value one = Value::map();
    one.set("position", list_of(view.position));
    Value& corners = one.set("footprint", Value::list());
    for (const Eigen::Vector2d& p :
         footprint_of(view, pinhole, given.number("level"), given.number("range")))
      corners.push_back(Value(Value::List{p.x(), p.y()}));
    images.push_back(std::move(one));
  }
  if (!given.tables("poses").empty()) run.settings.observe_first_flight(told);
  if (run.settings.first_flight_alone) throw Cancelled();
  return 0;
}

}  // namespace

void open_scan_library(lua_State* state) {
  open_prior_type(state);
  open_flight_rules_type(state);
  open_graph_type(state);
  define_type<TourObject>(state, kTourType, {}, &guarded<tour_field>);
  note_fields(state, kTourType, kTourFields);
}

std::span<const Binding> scan_methods_of_run() {
  static const Binding own[] = {
      {"solve_tour", &guarded<solve_tour_of_run>, "(settings: @): lapwing.tour",
       "a tour of views within a budget", &tour_table, kTourObjects},
      {"estimate", &guarded<estimate_of_run>, "(of: @)",
       "tells what solved tours come to, where only that is asked for: "
       "there the plan ends",
       &estimate_table, kEstimateObjects},
      {"first_flight", &guarded<first_flight_of_run>, "(flown: @)",
       "tells a viewer where a first flight takes its images and what they show of the ground; "
       "where only that is asked for, the plan ends",
       &first_flight_table}};
  static const std::vector<Binding> all = [] {
    std::vector<Binding> list;
    for (const std::span<const Binding> part :
         {prism_methods_of_run(), flight_rule_methods_of_run(), graph_methods_of_run(),
          graph_memory_methods_of_run(), std::span<const Binding>(own), pass_methods_of_run(),
          prior_methods_of_run(), scan_plan_methods_of_run()})
      list.insert(list.end(), part.begin(), part.end());
    return list;
  }();
  return all;
}

}  // namespace lapwing
