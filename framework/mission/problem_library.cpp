// SPDX-License-Identifier: Apache-2.0
// Stating a problem: run:vehicle, run:problem, and the methods of a problem.
#include <lua.hpp>

#include "framework/mission/controller_source.h"
#include "framework/mission/environment_source.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/mission/script_terms.h"
#include "framework/mission/vehicle_source.h"
#include "framework/mission/way_library.h"
#include "framework/problem/constraint.h"
#include "framework/problem/cost_term.h"
#include "framework/problem/vehicle_model.h"

namespace lapwing {

namespace {

TrajectoryProblem& open_problem(lua_State* state) {
  ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  if (object.finished) throw InputError("the problem is finished; nothing can be added to it");
  return *object.problem;
}

// {type = plugin, name = ..., weight = ..., and the plugin's own parameters}
struct PluginArgument {
  std::string type, name;
  double weight = 1;
  bool listed = false;  // of a constraint: by name in the certificate
  Value parameters = Value::map();
};

ParameterTable plugin_frame_table() {
  ParameterTable frame;
  frame.required_text("type", "name of the plugin")
      .optional_text("name", "its name in this problem");
  return frame;
}

ParameterTable constraint_frame_table() {
  return plugin_frame_table().choice(
      "certificate", "other_checks", {"other_checks", "listed"},
      "other_checks: other checks cover it; listed: it is reported as not checked");
}

ParameterTable cost_frame_table() {
  return plugin_frame_table().number("weight", 1.0, "", "weight of the term", at_least(0));
}

PluginArgument plugin_argument(lua_State* state, const char* what, const ParameterTable& frame) {
  const Origin origin = Sandbox::of(state).script_position(state);
  if (!lua_istable(state, 2)) {
    throw InputError(origin,
                     std::string(what) + ": expected a table, got " + luaL_typename(state, 2));
  }
  const Value given = value_from_lua(state, 2, origin, what);
  Value own = Value::map();
  own.with_origin(origin);
  PluginArgument argument;
  argument.parameters.with_origin(origin);
  if (given.is_map()) {
    for (const auto& [key, value] : given.as_map()) {
      (frame.find(key) ? own : argument.parameters).set(key, value);
    }
  }
  const Parameters checked = check(frame, own, what);
  argument.type = checked.text("type");
  argument.name = checked.has("name") ? checked.text("name") : argument.type;
  if (frame.find("weight")) argument.weight = checked.number("weight");
  if (frame.find("certificate")) argument.listed = checked.text("certificate") == "listed";
  return argument;
}

template <class Interface>
std::unique_ptr<Interface> create(lua_State* state, const PluginArgument& argument) {
  const Registry& registry = *run_of(state).settings.registry;
  registry.find(Interface::kKind, argument.type, argument.parameters.origin());
  return registry.create<Interface>(argument.type, argument.parameters, argument.name);
}

int add_model(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  const PluginArgument argument = plugin_argument(state, "add_model", plugin_frame_table());
  problem.add_model(argument.name, create<VehicleModel>(state, argument));
  return 0;
}

// p:has_block("force"): whether a model or the script added a block of that name.
int has_block(lua_State* state) {
  const TrajectoryProblem& problem = open_problem(state);
  lua_pushboolean(state, problem.layout().find(text_argument(state, 2, "has_block")) >= 0);
  return 1;
}

int rests_of_problem(lua_State* state) {
  lua_pushboolean(state, open_problem(state).rests());
  return 1;
}

ParameterTable block_table() {
  ParameterTable table;
  table.required_text("name", "name of the block")
      .integer("size", 1, "numbers in it", between(1, 64))
      .text("unit", "", "unit of each number");
  return table;
}

int add_block(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  const Parameters given = table_argument(state, 2, block_table(), "add_block");
  BlockSpec block;
  block.name = given.text("name");
  block.size = static_cast<int>(given.integer("size"));
  block.unit = given.text("unit");
  block.role = BlockRole::free;
  problem.add_block(std::move(block));
  return 0;
}

// Notes a term of the script's own; whether it was one.
bool add_own_term(lua_State* state, WrittenTermKind kind) {
  open_problem(state);
  if (!is_script_term(state, 2, kind)) return false;
  ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  if (!object.terms) object.terms = std::make_shared<std::vector<ScriptTerm>>();
  ScriptTerm term = read_script_term(state, 2, kind);
  expect_new_name(term, *object.terms);
  object.terms->push_back(std::move(term));
  return true;
}

int add_cost(lua_State* state) {
  if (add_own_term(state, WrittenTermKind::cost)) return 0;
  TrajectoryProblem& problem = open_problem(state);
  const PluginArgument argument = plugin_argument(state, "add_cost", cost_frame_table());
  problem.add_cost(argument.name, argument.weight, create<CostTerm>(state, argument));
  return 0;
}

int add_constraint(lua_State* state) {
  if (add_own_term(state, WrittenTermKind::constraint)) return 0;
  TrajectoryProblem& problem = open_problem(state);
  const PluginArgument argument =
      plugin_argument(state, "add_constraint", constraint_frame_table());
  problem.add_constraint(argument.name, create<Constraint>(state, argument));
  if (argument.listed)
    object_argument<ProblemObject>(state, 1, kProblemType)
        .listed.push_back(
            {.name = argument.name,
             .unjudged = "of the plugin '" + argument.type + "', not judged independently"});
  return 0;
}

constexpr BoundField kGuessedPlaces[] = {{"positions", "number[][]", "m, world: {{x, y, z}, ...}"}};
ParameterTable guessed_path_table() {
  ParameterTable table;
  table.required_numbers("times", 0, "s", "times of the points")
      .numbers("yaws", {}, "rad", "yaw at the points; none: 0");
  return table;
}

int guess_path(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  const Origin origin = Sandbox::of(state).script_position(state);
  const Parameters given =
      table_argument(state, 2, guessed_path_table(), "guess_path", kGuessedPlaces);
  std::vector<Eigen::Vector3d> positions;
  lua_getfield(state, 2, "positions");
  const Value points = value_from_lua(state, -1, origin, "guess_path.positions");
  for (const Value& point : points.as_list()) {
    if (!point.is_list() || point.as_list().size() != 3) {
      throw InputError(origin, "guess_path.positions: expected a list of 3 numbers each");
    }
    const auto& p = point.as_list();
    positions.emplace_back(p[0].as_number(), p[1].as_number(), p[2].as_number());
  }
  const auto times = given.numbers("times");
  const auto yaws = given.numbers("yaws");
  std::vector<double> angles(yaws.begin(), yaws.end());
  if (angles.empty()) angles.assign(times.size(), 0.0);
  if (positions.size() != times.size() || angles.size() != times.size() || positions.empty()) {
    throw InputError(origin,
                     "guess_path: expected as many positions and yaws as times, at least one");
  }
  problem.set_path_guess({times.begin(), times.end()}, std::move(positions), std::move(angles));
  return 0;
}

// problem:guess_solution(solution): leg by leg the motion of another problem's solution, which has
// the same legs, of the same lengths in time or not, in any number of stages.
int guess_solution(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  const SolutionObject& solution = object_argument<SolutionObject>(state, 2, kSolutionType);
  problem.set_motion_guess(solution.problem->trajectory(solution.result.point.stages),
                           solution.problem->horizon());
  return 0;
}

ParameterTable continued_table() {
  return ParameterTable{}
      .integer("stage", 0, "stage of the solution that is the first one here, from 0", at_least(0))
      .integer("held", 1, "number of stages, from that one, that stay as they are", at_least(1));
}

// problem:continue_from(solution, {stage = 40, held = 4}): the flight begins as that solution goes
// on from that stage.
int continue_from(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  const SolutionObject& solution = object_argument<SolutionObject>(state, 2, kSolutionType);
  const Parameters given = table_argument(state, 3, continued_table(), "continue_from");
  const Stages& stages = solution.result.point.stages;
  const std::int64_t first = given.integer("stage");
  if (first >= stages.cols())
    throw InputError(given.origin("stage"), "continue_from: the solution has " +
                                                std::to_string(stages.cols()) + " stages");
  const Eigen::Index count =
      std::min<Eigen::Index>(stages.cols() - first, problem.horizon().stages);
  problem.continue_from(stages.middleCols(first, count), static_cast<int>(given.integer("held")));
  return 0;
}

int finish(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  object.finished = true;  // functions of terms run now, and can add nothing
  if (object.terms)
    for (ScriptTerm& term : *object.terms) add_script_term(state, term, problem);
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    problem.finish(run_of(state).settings.like.get());
  }
  if (!object.terms) return 0;
  const Stages guess = problem.initial_guess();
  for (ScriptTerm& term : *object.terms) check_script_term(state, term, problem, guess);
  return 0;
}

int set_parameter(lua_State* state) {
  ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  std::vector<ScriptTerm> none;
  set_term_parameter(state, 2, object.terms ? *object.terms : none);
  return 0;
}

constexpr BoundField kGuessedValues[] = {
    {"values", "number[][]", "values of the block at these times"}};
ParameterTable guessed_block_table() {
  ParameterTable table;
  table.required_text("block", "name of the block")
      .required_numbers("times", 0, "s", "times of the values");
  return table;
}

int guess_block(lua_State* state) {
  TrajectoryProblem& problem = open_problem(state);
  const Origin origin = Sandbox::of(state).script_position(state);
  const Parameters given =
      table_argument(state, 2, guessed_block_table(), "guess_block", kGuessedValues);
  lua_getfield(state, 2, "values");
  const Value list = value_from_lua(state, -1, origin, "guess_block.values");
  std::vector<Eigen::VectorXd> values;
  for (const Value& entry : list.is_list() ? list.as_list() : Value::List{}) {
    if (!entry.is_list()) throw InputError(origin, "guess_block.values: expected lists of numbers");
    Eigen::VectorXd& value = values.emplace_back(entry.as_list().size());
    for (Eigen::Index i = 0; i < value.size(); ++i) value(i) = entry.as_list()[i].as_number();
  }
  const auto times = given.numbers("times");
  if (values.size() != times.size() || values.empty())
    throw InputError(origin, "guess_block: expected as many values as times, at least one");
  problem.set_block_guess(given.text("block"), {times.begin(), times.end()}, std::move(values));
  return 0;
}

Eigen::Vector3d place_argument(lua_State* state, const char* what) {
  const Origin origin = Sandbox::of(state).script_position(state);
  const Value given = value_from_lua(state, 2, origin, what);
  if (!given.is_list() || given.as_list().size() != 3)
    throw InputError(origin, std::string(what) + ": expected a position of 3 numbers");
  const auto& p = given.as_list();
  return {p[0].as_number(), p[1].as_number(), p[2].as_number()};
}

// The time that a place is asked of; absent: when the flight begins.
double time_argument(lua_State* state) {
  return lua_isnoneornil(state, 3) ? 0.0 : luaL_checknumber(state, 3);
}

int push_nearest(lua_State* state, const NearestObstacle& nearest) {
  lua_pushnumber(state, nearest.distance);
  push_text(state, nearest.name);
  return 2;
}

// problem:nearest_obstacle({x, y, z}, time): distance (negative inside, infinite without any) and
// name
int nearest(lua_State* state) {
  const ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  return push_nearest(
      state, nearest_obstacle(object.problem->environment(),
                              place_argument(state, "nearest_obstacle"), time_argument(state)));
}

// problem:flight_zone_distance({x, y, z}, time): to the nearest face of what the flight stays
// inside of, negative outside, infinite without any; and its name
int flight_zone_distance(lua_State* state) {
  const ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  return push_nearest(
      state, least_inside(object.problem->environment(),
                          place_argument(state, "flight_zone_distance"), time_argument(state)));
}

}  // namespace

namespace {

constexpr double kMostIntervals = 100'000;

// {{duration = 2, intervals = 20, mode = "free", shortest = 0, longest = 10}, ...}
Horizon horizon_of_legs(const Parameters& given) {
  std::vector<Leg> legs;
  double total = 0;
  for (const Parameters& entry : given.tables("legs")) {
    Leg leg;
    leg.intervals = static_cast<int>(entry.integer("intervals"));
    leg.step = entry.number("duration") / leg.intervals;
    leg.free = entry.text("mode") == "free";
    leg.shortest = entry.number("shortest");
    if (entry.has("longest")) leg.longest = entry.number("longest");
    total += leg.intervals;
    legs.push_back(leg);
  }
  if (total > kMostIntervals)
    throw InputError(given.origin("legs"), "problem: more than 100000 stages in all legs");
  Horizon horizon = Horizon::of_legs(std::move(legs));
  horizon.periodic = given.boolean("periodic");
  horizon.turns = static_cast<int>(given.integer("turns"));
  return horizon;
}

ParameterTable leg_table() {
  ParameterTable leg;
  leg.required_number("duration", "s", "duration of the leg; if it is free, the first guess",
                      above(0))
      .integer("intervals", 20, "number of intervals between stages", between(1, 100000))
      .choice("mode", "free", {"free", "fixed"}, "free: the leg chooses its duration")
      .number("shortest", 0, "s", "bound on a free duration", at_least(0))
      .optional_number("longest", "s", "bound on a free duration", above(0));
  return leg;
}

}  // namespace

namespace {

constexpr BoundField kProblemObjects[] = {
    {"vehicle", "lapwing.vehicle", "vehicle"},
    {"obstacles?", "lapwing.shape[]",
     "shapes by plugin, with name, side, opaque and track in addition to their parameters"}};

ParameterTable problem_table() {
  ParameterTable table;
  table.optional_number("duration", "s", "duration of the flight; required without legs", above(0))
      .tables("legs", leg_table(), "legs with separate steps")
      .boolean("periodic", false, "the last state closes onto the first")
      .integer("turns", 0, "turns of yaw in one period, counter-clockwise", between(-1000, 1000))
      .number("step", 0.1, "s", "longest time between two stages", above(0))
      .number("begin", 0, "s", "time of the first stage, of a part of a longer flight", at_least(0))
      .choice("step_mode", "fixed", {"fixed", "free"}, "free: the step is a variable")
      .table("environment", environment_table(), "obstacles, subjects and zones");
  return table;
}

}  // namespace

// run:problem{vehicle = v, duration = 20, step = 0.1, environment = {...}, step_mode = "fixed"}:
// as many stages as keep the step at or below `step`, evenly over the duration; or with
// legs = {{duration = 2, intervals = 20}, ...} a step for each leg.
int problem_of_run(lua_State* state) {
  const Parameters given = table_argument(state, 2, problem_table(), "problem", kProblemObjects);
  lua_getfield(state, 2, "obstacles");
  const Value obstacles = value_from_lua(state, -1, given.origin(), "problem.obstacles");
  lua_getfield(state, 2, "vehicle");
  const Vehicle& vehicle = object_argument<Vehicle>(state, -1, kVehicleType);
  constexpr double kRounding = 1e-9;  // of an interval
  const bool legs = !given.tables("legs").empty();
  if (legs == given.has("duration"))
    throw InputError(given.origin(), "problem: expected either a duration or legs");
  if (legs && given.number("begin") != 0)
    throw InputError(given.origin("begin"), "problem: a flight of legs begins at 0");
  const double intervals = legs ? 1 : given.number("duration") / given.number("step");
  if (intervals > kMostIntervals) {
    throw InputError(given.origin(), "problem: more than 100000 stages; raise the step");
  }
  Horizon horizon;
  if (legs) {
    horizon = horizon_of_legs(given);
  } else {
    horizon.stages = std::max(1, static_cast<int>(std::ceil(intervals - kRounding))) + 1;
    horizon.step = given.number("duration") / (horizon.stages - 1);
    horizon.begin = given.number("begin");
    horizon.step_free = given.text("step_mode") == "free";
    horizon.periodic = given.boolean("periodic");
    horizon.turns = static_cast<int>(given.integer("turns"));
  }
  ProblemObject object;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    object.problem = std::make_shared<TrajectoryProblem>(
        vehicle, horizon, environment_of(given.table("environment"), obstacles, run_of(state)));
  }
  new_object(state, kProblemType, std::move(object));
  return 1;
}

// run:vehicle("vehicles/solo") or run:vehicle{...} with the keys of a vehicle file.
int vehicle_of_run(lua_State* state) {
  const Origin origin = Sandbox::of(state).script_position(state);
  Value source = value_from_lua(state, 2, origin, "vehicle");
  // Lua's values bear no origin: an option that is handed on keeps the place where it was written.
  const Value* option = run_of(state).configuration.find("vehicle");
  if (option && *option == source && option->origin().source != "default") source = *option;
  const MissionRun& run = run_of(state);
  const Vehicle vehicle = load_vehicle(source, run.files.folders());
  // Before anything is computed that the certificate would then refuse.
  if (!vehicle.controller.is_null())
    controllers_of (*run.settings.registry)(controller_of(vehicle));
  new_object(state, kVehicleType, vehicle);
  return 1;
}

std::span<const Binding> problem_methods_of_run() {
  static const Binding methods[] = {
      {"vehicle", &guarded<vehicle_of_run>, "(source: string|table): lapwing.vehicle",
       "a vehicle, by the name of its file in configs/ or as a table like such a file"},
      {"problem", &guarded<problem_of_run>, "(stated: @): lapwing.problem",
       "a problem, over a duration or in legs with separate steps", &problem_table,
       kProblemObjects}};
  return methods;
}

void open_problem_library(lua_State* state) {
  static const Binding methods[] = {
      {"add_model", &guarded<add_model>, "(model: lapwing.vehicle_model)",
       "adds a vehicle model: a plugin by name, with its parameters"},
      {"has_block", &guarded<has_block>, "(name: string): boolean",
       "whether a model or the script added a block of that name"},
      {"rests", &guarded<rests_of_problem>, "(): boolean",
       "whether the added models allow the vehicle to stand still"},
      {"add_block", &guarded<add_block>, "(block: @)", "adds a free block", &block_table},
      {"add_cost", &guarded<add_cost>, "(term: lapwing.cost_term|lapwing.own_cost)",
       "adds a cost: a plugin by name, or a function of the script"},
      {"add_constraint", &guarded<add_constraint>,
       "(constraint: lapwing.constraint|lapwing.own_constraint)",
       "adds a constraint: a plugin by name, or a function of the script"},
      {"set_parameter", &guarded<set_parameter>, "(change: @)",
       "sets a parameter of a term of the script, before the next solve", &term_parameter_table,
       kTermParameterValue},
      {"guess_path", &guarded<guess_path>, "(path: @)", "sets the initial guess of solvers",
       &guessed_path_table, kGuessedPlaces},
      {"guess_block", &guarded<guess_block>, "(guess: @)",
       "sets the initial guess of a block: target, gimbal_pitch", &guessed_block_table,
       kGuessedValues},
      {"guess_solution", &guarded<guess_solution>, "(solution: lapwing.solution)",
       "sets the initial guess, leg by leg, from the solution of a problem with the same legs"},
      {"continue_from", &guarded<continue_from>, "(solution: lapwing.solution, from: @)",
       "continues the solution of another part of the flight: stage `stage` of it becomes the "
       "first "
       "stage here, the first `held` stages are fixed, the following ones are the initial guess",
       &continued_table},
      {"nearest_obstacle", &guarded<nearest>, "(place: number[], time?: number): number, string",
       "distance from the nearest obstacle in m, negative inside, and the name of the obstacle"},
      {"flight_zone_distance", &guarded<flight_zone_distance>,
       "(place: number[], time?: number): number, string",
       "distance from the nearest face of a flight zone in m, negative outside, and the name of "
       "the "
       "zone"},
      {"plan_way", &guarded<plan_way>, "(wanted: @): number[][]?, string?, string?",
       "a path whose distance from obstacles and from bystanders that stand still is at least the "
       "required one plus `more` (m); it uses a passage that no `excluded` path uses. If there is "
       "none: nil, the reason, and the status of the planner",
       &way_table, kWayObjects},
      {"grow_corridor", &guarded<grow_corridor_of_problem>, "(along: @): table[]",
       "collision-free boxes along a path: {from, to, lower, size}; `from` and `to` are the ends "
       "of "
       "the covered part, as fractions of its length; `lower` and `size` are the corner and the "
       "edges of the box, m",
       nullptr, kCorridorWay},
      {"finish", &guarded<finish>, "()", "completes the problem; nothing can be added afterwards"}};
  static const BoundTable tables[] = {
      {"plugin_frame", &plugin_frame_table, {}},
      {"constraint_frame", &constraint_frame_table, {}},
      {"cost_frame", &cost_frame_table, {}},
      {"own_cost", &own_cost_table, kOwnCostObjects},
      {"own_constraint", &own_constraint_table, kOwnConstraintObjects}};
  define_type<ProblemObject>(state, kProblemType, {methods});
  note_tables(state, "lapwing", tables);
}

}  // namespace lapwing
