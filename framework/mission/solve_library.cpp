// SPDX-License-Identifier: Apache-2.0
// Solving: vehicles, run:solve and its solutions.
#include <algorithm>
#include <cmath>
#include <limits>

#include <lua.hpp>

#include "framework/core/log.h"
#include "framework/mission/guard.h"
#include "framework/mission/joined_solution.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/mission/script_terms.h"
#include "framework/trajectory/plan_digest.h"

namespace lapwing {

namespace {

constexpr BoundField kWarmStart[] = {
    {"warm_start?", "lapwing.solution", "solution of a problem of the same size, for a warm start"},
    {"start?", "lapwing.plan",
     "plan of the same kind and vehicle, for a warm start; resampled in time"}};

// What keeps a plan from being a start of the problem, in words; "" for nothing.
std::string unlike(const Plan& plan, const TrajectoryProblem& problem, const std::string& kind) {
  if (plan.kind != kind) return "a plan of kind '" + plan.kind + "', the mission is a " + kind;
  const Value* name = plan.vehicle.is_map() ? plan.vehicle.find("name") : nullptr;
  if (!name || !name->is_text() || name->as_text() != problem.vehicle().name)
    return "a plan of the vehicle '" + (name && name->is_text() ? name->as_text() : "") +
           "', the problem is of '" + problem.vehicle().name + "'";
  const Trajectory own = problem.trajectory(problem.initial_guess());
  const Trajectory& theirs = plan.trajectory;
  if (theirs.motion.name != own.motion.name || theirs.motion.columns != own.motion.columns)
    return "the plan moves by '" + theirs.motion.name + "', the problem by '" + own.motion.name +
           "'";
  const auto says = [](bool has) { return has ? "a " : "no "; };
  if (theirs.has_gimbal != own.has_gimbal)
    return std::string("the plan has ") + says(theirs.has_gimbal) + "gimbal, the problem " +
           says(own.has_gimbal) + "gimbal";
  if (theirs.has_target != own.has_target)
    return std::string("the plan has ") + says(theirs.has_target) + "target, the problem " +
           says(own.has_target) + "target";
  return theirs.samples.size() < 2 ? "the plan has a single sample" : "";
}

// What the third argument of run:solve says, into the request; and the plan that it names, as the
// solution tells of it.
Value take_solve_argument(lua_State* state, int index, const TrajectoryProblem& problem,
                          SolveRequest& request) {
  if (lua_isnoneornil(state, index)) return {};
  const Parameters given = table_argument(state, index, {}, "solve", kWarmStart);
  const bool from_solution = lua_getfield(state, index, "warm_start") != LUA_TNIL;
  if (lua_getfield(state, index, "start") != LUA_TNIL) {
    if (from_solution)
      throw InputError(given.origin(), "solve: give warm_start or start, not both");
    const Plan& plan = object_argument<PlanObject>(state, -1, kPlanType).plan;
    const std::string why = unlike(plan, problem, run_of(state).kind);
    if (!why.empty()) throw InputError(given.origin(), "solve: cannot begin from it: " + why);
    request.warm_start = WarmStart{problem.point_of(plan.trajectory), {}, {}};
    // A problem that is only stated makes no plan that would tell; the digest takes milliseconds.
    if (run_of(state).stating) return {};
    Value started_from = Value::map();
    started_from.set("mission", plan.mission);
    started_from.set("sha256", digest_of(to_value(plan)).at("sha256"));
    return started_from;
  }
  lua_pop(state, 1);
  if (!from_solution) return {};
  const WarmStart& point = object_argument<SolutionObject>(state, -1, kSolutionType).result.point;
  if (point.stages.rows() != problem.layout().size() ||
      point.stages.cols() != problem.horizon().stages) {
    throw InputError("solve: the warm start belongs to a problem of another size");
  }
  WarmStart start = point;
  if (start.row_multipliers.size() != problem.rows()) start.row_multipliers.resize(0);
  if (start.bound_multipliers.size() != problem.columns()) start.bound_multipliers.resize(0);
  request.warm_start = std::move(start);
  return {};
}

// What a plan says of the problem's constraints; those of plugins may share a name.
std::vector<StatedConstraint> constraints_of(const ProblemObject& object) {
  std::vector<StatedConstraint> all;
  if (object.terms) all = stated_constraints(*object.terms);
  for (StatedConstraint listed : object.listed) {
    const std::string name = listed.name;
    const auto taken = [&](const StatedConstraint& other) { return other.name == listed.name; };
    for (int k = 2; std::any_of(all.begin(), all.end(), taken); ++k)
      listed.name = name + " " + std::to_string(k);
    all.push_back(std::move(listed));
  }
  return all;
}

// Of a mission that is only stated, a solution is where its solver would begin.
void state_only(MissionStatement& statement, SolutionObject& solution,
                std::shared_ptr<const TrajectorySolver> solver, const SolveRequest& request) {
  if (statement.problem)
    throw InputError(
        "a mission that solves one problem after the other cannot be edited as one: "
        "fix what the first is solved for (of a film: timing and times)");
  statement.problem = solution.problem;
  statement.solver = std::move(solver);
  statement.solver_name = solution.solver;
  statement.start = request.warm_start;
  solution.result.report.status = SolveStatus::feasible;
  solution.result.point.stages = solution.problem->initial_guess();
}

// run:solve(problem, solver [, {warm_start = solution, start = plan}]): a solution; its `status`
// states the outcome.
int solve(lua_State* state) {
  MissionRun& run = run_of(state);
  const ProblemObject& object = object_argument<ProblemObject>(state, 2, kProblemType);
  if (!object.finished)
    throw InputError("solve: the problem is not finished; call problem:finish()");
  const PluginChoice argument = plugin_choice(state, 3, "solver");
  SolveRequest request;
  Value started_from = take_solve_argument(state, 4, *object.problem, request);
  request.cancellation = run.settings.cancellation;
  request.progress = run.settings.progress;
  const std::shared_ptr<const TrajectorySolver> solver =
      run.settings.registry->create<TrajectorySolver>(argument.type, argument.parameters, "solver");
  begin_planning(run);
  if (run.settings.observe_problem) run.settings.observe_problem(object.problem);
  SolutionObject solution;
  solution.problem = object.problem;
  solution.solver = argument.type;
  solution.constraints = constraints_of(object);
  solution.started_from = std::move(started_from);
  if (run.stating) {
    state_only(*run.stating, solution, solver, request);
    new_object(state, kSolutionType, std::move(solution));
    return 1;
  }
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    solution.result = solve_by(*solver, *object.problem, request);
  }
  const SolveReport& report = solution.result.report;
  if (report.status == SolveStatus::numerical_error && solution.result.point.stages.size() > 0) {
    const std::string fault = object.problem->script_fault(solution.result.point.stages);
    if (!fault.empty()) throw InputError(fault);
  }
  run.solve_seconds += report.seconds;
  logging::info(argument.type + ": " + to_string(report.status) + " after " +
                std::to_string(report.iterations) + " iterations" +
                (report.message.empty() ? "" : "; " + report.message));
  new_object(state, kSolutionType, std::move(solution));
  return 1;
}

constexpr BoundField kSolutionPart[] = {
    {"solution", "lapwing.solution", "solution of the part"},
    {"first", "integer", "its first stage that is taken, counted from 0"},
    {"last", "integer", "its last stage that is taken"}};

int stage_number(lua_State* state, const char* field) {
  lua_getfield(state, -1, field);
  int is_integer = 0;
  const lua_Integer number = lua_tointegerx(state, -1, &is_integer);
  lua_pop(state, 1);
  constexpr lua_Integer kMost = 1'000'000;
  if (!is_integer || number < 0 || number > kMost)
    throw InputError(std::string("join: expected a stage number as `") + field + "`");
  return static_cast<int>(number);
}

// run:join(problem, {{solution = s, first = 0, last = 39}, ...})
int join_parts(lua_State* state) {
  const ProblemObject& whole = object_argument<ProblemObject>(state, 2, kProblemType);
  if (!whole.finished) throw InputError("join: the problem is not finished; call problem:finish()");
  if (!lua_istable(state, 3)) throw InputError("join: expected a list of parts");
  std::vector<SolutionPart> parts(lua_rawlen(state, 3));
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (lua_rawgeti(state, 3, static_cast<lua_Integer>(k + 1)) != LUA_TTABLE)
      throw InputError("join: expected {solution, first, last} as each part");
    parts[k].first = stage_number(state, "first");
    parts[k].last = stage_number(state, "last");
    lua_getfield(state, -1, "solution");
    parts[k].solution = &object_argument<SolutionObject>(state, -1, kSolutionType);
    lua_pop(state, 2);
  }
  SolutionObject joined;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    joined = join(whole, parts);
  }
  joined.constraints = constraints_of(whole);
  new_object(state, kSolutionType, std::move(joined));
  return 1;
}

// x, y, z of every stage in turn.
Value positions_of(const SolutionObject& solution) {
  Value list = Value::list();
  for (const Sample& s : solution.problem->trajectory(solution.result.point.stages).samples)
    for (int axis = 0; axis < 3; ++axis) list.push_back(s.position(axis));
  return list;
}

constexpr BoundField kSolutionFields[] = {
    {"status", "string",
     "optimal, feasible, infeasible, iteration_limit, time_limit, cancelled, ..."},
    {"message", "string", "message of the solver"},
    {"solver", "string", "its name"},
    {"cost", "number", "sum of all weighted terms"},
    {"iterations", "integer", "iterations of the solver"},
    {"violations", "table[]", "largest violation of each constraint: {name, row, amount, time}"},
    {"legs", "number[]", "durations of the legs, s"},
    {"duration", "number", "s"},
    {"defects", "number[]", "defect of each leg, as a fraction of the limit of the certificate"},
    {"path", "number[]", "x, y, z of the first stage, of the second, ...; m, world"}};

int solution_field(lua_State* state) {
  const SolutionObject& solution = object_argument<SolutionObject>(state, 1, kSolutionType);
  const SolveReport& report = solution.result.report;
  const std::string field = text_argument(state, 2, "solution");
  Value violations = Value::list();
  for (const Violation& violation : report.violations) {
    Value entry = Value::map();
    entry.set("name", violation.name);
    entry.set("row", violation.row);
    entry.set("amount", violation.amount);
    entry.set("time", violation.time);
    violations.push_back(std::move(entry));
  }
  Value fields = Value::map();
  fields.set("status", to_string(report.status));
  fields.set("message", report.message);
  fields.set("solver", solution.solver);
  fields.set("cost", report.cost);
  fields.set("iterations", report.iterations);
  fields.set("violations", std::move(violations));
  const Horizon& horizon = solution.problem->horizon();
  Value legs = Value::list();
  const Stages& at = solution.result.point.stages;
  for (int leg = 0; leg < horizon.leg_count(); ++leg)
    legs.push_back(solution.problem->time(at, horizon.end_of_leg(leg + 1)) -
                   solution.problem->time(at, horizon.end_of_leg(leg)));
  fields.set("legs", std::move(legs));
  if (field == "defects") {
    const std::vector<double> defects = solution.problem->leg_defects(at);
    fields.set("defects", Value(Value::List(defects.begin(), defects.end())));
  }
  fields.set("duration", solution.problem->time(at, horizon.stages - 1));
  fields.set("path", Value());
  if (field == "path") fields.set("path", positions_of(solution));
  return push_field(state, "a solution", field, fields, kSolutionFields);
}

// Angles and rates, or false without a gimbal.
Value gimbal_value(const Vehicle& vehicle) {
  if (!vehicle.gimbal) return Value(false);
  Value gimbal = Value::map();
  gimbal.set("yaw_min", vehicle.gimbal->yaw_min);
  gimbal.set("yaw_max", vehicle.gimbal->yaw_max);
  gimbal.set("pitch_min", vehicle.gimbal->pitch_min);
  gimbal.set("pitch_max", vehicle.gimbal->pitch_max);
  gimbal.set("yaw_rate", vehicle.gimbal->yaw_rate_max);
  gimbal.set("pitch_rate", vehicle.gimbal->pitch_rate_max);
  return gimbal;
}

// Half the angle that the camera sees, across and up, of the narrower side.
Value half_view_value(const Camera& camera) {
  const double left = camera.principal_x + 0.5, top = camera.principal_y + 0.5;
  Value view = Value::map();
  view.set("across", std::atan(std::min(left, camera.width - left) / camera.focal_x));
  view.set("up", std::atan(std::min(top, camera.height - top) / camera.focal_y));
  return view;
}

Value wing_value(const Vehicle& vehicle) {
  if (!vehicle.wing) return false;
  Value wing = Value::map();
  wing.set("stall_speed", vehicle.wing->stall_speed);
  wing.set("bank", vehicle.wing->bank_max);
  wing.set("bank_rate", vehicle.wing->bank_rate_max);
  return wing;
}

// Its name and the limits that a mission may plan with.
constexpr BoundField kVehicleFields[] = {
    {"name", "string", "name of the vehicle"},
    {"mass", "number", "kg"},
    {"speed_across", "number", "largest horizontal speed, m/s"},
    {"climb_speed", "number", "largest climb speed, m/s"},
    {"descent_speed", "number", "largest descent speed, m/s"},
    {"acceleration_across", "number", "largest horizontal acceleration, m/s^2"},
    {"acceleration_up", "number", "largest upward acceleration, m/s^2; math.huge if not stated"},
    {"acceleration_down", "number",
     "largest downward acceleration, m/s^2; math.huge if not stated"},
    {"yaw_rate", "number", "largest yaw rate, rad/s"},
    {"thrust_max", "number", "largest used thrust of all rotors, N"},
    {"rotor_thrust_max", "number", "largest thrust of one rotor, N"},
    {"flight_time", "number", "flight time of one battery, s"},
    {"flies", "boolean", "whether its rotors are known, so that its flight can be simulated"},
    {"gimbal", "table|false",
     "{yaw_min, yaw_max, pitch_min, pitch_max, yaw_rate, pitch_rate}, rad and rad/s; false: none"},
    {"wing", "table|false", "{stall_speed, bank, bank_rate}, m/s, rad and rad/s; false: none"},
    {"half_view", "table", "{across, up}: half the angle that the camera sees, rad"}};

int vehicle_field(lua_State* state) {
  const Vehicle& vehicle = object_argument<Vehicle>(state, 1, kVehicleType);
  const std::string field = text_argument(state, 2, "vehicle");
  Value fields = Value::map();
  fields.set("name", vehicle.name);
  fields.set("mass", vehicle.mass);
  fields.set("speed_across", vehicle.speed_across_max);
  fields.set("climb_speed", vehicle.climb_speed_max);
  fields.set("descent_speed", vehicle.descent_speed_max);
  fields.set("acceleration_across", vehicle.acceleration_across_max);
  fields.set("yaw_rate", vehicle.yaw_rate_max);
  fields.set("thrust_max", vehicle.thrust_max());
  fields.set("rotor_thrust_max", vehicle.rotors.thrust_max);
  fields.set("flight_time", vehicle.flight_time);
  const double infinite = std::numeric_limits<double>::infinity();
  fields.set("acceleration_up", vehicle.acceleration_up_max.value_or(infinite));
  fields.set("acceleration_down", vehicle.acceleration_down_max.value_or(infinite));
  fields.set("flies", vehicle.has_rotors);
  fields.set("gimbal", gimbal_value(vehicle));
  fields.set("wing", wing_value(vehicle));
  fields.set("half_view", half_view_value(vehicle.camera));
  return push_field(state, "a vehicle", field, fields, kVehicleFields);
}

}  // namespace

std::span<const Binding> solving_methods_of_run() {
  static const Binding methods[] = {
      {"solve", &guarded<solve>,
       "(problem: lapwing.problem, solver: lapwing.trajectory_solver, options?: @): "
       "lapwing.solution",
       "a solution; its `status` states the outcome", nullptr, kWarmStart},
      {"join", &guarded<join_parts>, "(whole: lapwing.problem, parts: @[]): lapwing.solution",
       "the solution of a whole flight from those of its parts, in order of time", nullptr,
       kSolutionPart}};
  return methods;
}

void open_solve_library(lua_State* state) {
  define_type<Vehicle>(state, kVehicleType, {}, &guarded<vehicle_field>);
  note_fields(state, kVehicleType, kVehicleFields);
  define_type<SolutionObject>(state, kSolutionType, {}, &guarded<solution_field>);
  note_fields(state, kSolutionType, kSolutionFields);
}

}  // namespace lapwing
