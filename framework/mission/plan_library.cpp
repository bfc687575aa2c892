// SPDX-License-Identifier: Apache-2.0
// Plans: what a mission returns, and what the verifier says of it.
#include <lua.hpp>

#include "framework/core/files.h"
#include "framework/export/report_value.h"
#include "framework/mission/controller_source.h"
#include "framework/mission/flight_library.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/map_objects.h"
#include "framework/mission/players.h"
#include "framework/mission/run.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/vectors.h"
#include "framework/verify/verify.h"

namespace lapwing {

PluginChoice plugin_choice(lua_State* state, int index, const std::string& what) {
  const Value given = value_from_lua(state, index, Sandbox::of(state).script_position(state), what);
  PluginChoice choice;
  const Value* type = given.is_map() ? given.find("type") : &given;
  if (!type || !type->is_text())
    throw InputError(given.origin(),
                     what + ": expected a plugin's name or a table with its `type`");
  choice.type = type->as_text();
  choice.parameters.with_origin(given.origin());
  if (given.is_map())
    for (const auto& [key, value] : given.as_map())
      if (key != "type") choice.parameters.set(key, value);
  return choice;
}

std::vector<Section> stated_sections(lua_State* state, int index, const std::string& what) {
  constexpr std::size_t kLargestImage = std::size_t{64} << 20;  // bytes
  lua_getfield(state, index, "sections");
  const Value given = value_from_lua(state, -1, Sandbox::of(state).script_position(state), what);
  lua_pop(state, 1);
  if (given.is_null()) return {};
  return sections_from_value(given, what, [&](const std::string& name) {
    return read_file(run_of(state).files.find(name), kLargestImage);
  });
}

namespace {

ParameterTable span_table() {
  ParameterTable table;
  table.required_number("start", "s", "start of the span, in the flight", at_least(0))
      .required_number("finish", "s", "end of the span, in the flight", at_least(0));
  return table;
}

ParameterTable task_table() {
  const KeyframeTask standard;
  ParameterTable keyframe;
  keyframe.required_number("time", "s", "when", at_least(0))
      .required_numbers("position", 3, "m", "where, world")
      .optional_number("yaw", "rad", "heading")
      .number("tolerance", standard.tolerance, "m", "largest miss", above(0))
      .number("time_tolerance", standard.time_tolerance, "s", "largest time error", at_least(0))
      .number("yaw_tolerance", standard.yaw_tolerance, "rad", "largest miss of yaw", above(0));
  ParameterTable stroke;
  stroke.required_numbers("points", 0, "m", "x, y, z of each point in turn, world");
  ParameterTable gate;
  gate.text("name", "", "name in messages")
      .choice("shape", "ball", {"ball", "rectangle", "triangle", "pentagon", "hexagon"}, "opening")
      .required_numbers("position", 3, "m", "centre, world")
      .numbers("direction", {1, 0, 0}, "", "direction of flight")
      .numbers("up", {0, 0, 1}, "", "upward direction of the opening")
      .number("tunnel_length", 0, "m", "length, half before and half behind the opening",
              at_least(0));
  for (const char* size : {"width", "height", "radius", "side"})
    gate.optional_number(size, "m", "size of the opening, if its shape has it", above(0));
  ParameterTable framing = span_table();
  framing.required_text("subject", "subject in the image");
  ParameterTable table;
  table.tables("keyframes", keyframe, "keyframes of the flight")
      .tables("gates", gate, "gates in the order of flight")
      .boolean("closed_loop_required", true, "false: tracking under control is reported only")
      .tables("framing", framing, "subject in the image, by span of time")
      .tables("strokes", stroke, "strokes to draw with light")
      .number("drawing_tolerance", Task{}.drawing_tolerance, "m",
              "mean distance between light and strokes", above(0))
      .numbers("drawing_view", {0, 1, 0}, "", "viewing direction of the spectators")
      .number("framing_share", Task{}.framing_share, "", "fraction of that time", {0, 1, true})
      .boolean("line_of_sight_required", true,
               "for that share of the time; false: hidden subjects are reported only");
  return table;
}

GateTask gate_of(const Parameters& given) {
  const auto size = [&](const char* name) { return given.has(name) ? given.number(name) : 0.0; };
  GateTask gate;
  gate.name = given.text("name");
  gate.position = vector_of(given.numbers("position"));
  gate.corners = gate_corners(
      {given.text("shape"), size("width"), size("height"), size("radius"), size("side")});
  if (gate.ball()) {
    gate.radius = given.number("radius");
    return gate;
  }
  gate.tunnel_length = given.number("tunnel_length");
  set_direction(gate, vector_of(given.numbers("direction")), vector_of(given.numbers("up")));
  return gate;
}

Task task_of(const Parameters& given) {
  Task task;
  for (const Parameters& entry : given.tables("keyframes")) {
    KeyframeTask keyframe;
    keyframe.time = entry.number("time");
    keyframe.position = vector_of(entry.numbers("position"));
    if (entry.has("yaw")) keyframe.yaw = entry.number("yaw");
    keyframe.tolerance = entry.number("tolerance");
    keyframe.time_tolerance = entry.number("time_tolerance");
    keyframe.yaw_tolerance = entry.number("yaw_tolerance");
    task.keyframes.push_back(keyframe);
  }
  for (const Parameters& entry : given.tables("gates")) task.gates.push_back(gate_of(entry));
  task.closed_loop_required = given.boolean("closed_loop_required");
  for (const Parameters& entry : given.tables("framing"))
    task.framing.push_back(
        {entry.text("subject"), {entry.number("start"), entry.number("finish")}});
  task.framing_share = given.number("framing_share");
  task.line_of_sight_required = given.boolean("line_of_sight_required");
  for (const Parameters& entry : given.tables("strokes"))
    task.strokes.push_back(points_of(entry, "points"));
  task.drawing_tolerance = given.number("drawing_tolerance");
  task.drawing_view = vector_of(given.numbers("drawing_view"));
  return task;
}

// The origin that the mission was given, or one that its input has.
std::optional<GeodeticOrigin> origin_of(const MissionRun& run, const Parameters& place) {
  if (!place.has("lat") || !place.has("lon")) return run.origin;
  if (run.origin)
    throw InputError("origin: the input of the mission has an origin of its own; remove one");
  return GeodeticOrigin{place.number("lat"), place.number("lon"),
                        place.has("alt") ? place.number("alt") : 0.0};
}

ParameterTable plan_table() {
  ParameterTable origin;
  origin.optional_number("lat", "", "degrees north", between(-90, 90))
      .optional_number("lon", "", "degrees east", between(-180, 180))
      .optional_number("alt", "m", "above the ellipsoid");
  ParameterTable table;
  table.table("task", task_table(), "task that the certificate checks")
      .tables("cuts", span_table(), "spans of discarded footage")
      .optional_number("budget", "s", "flight time", above(0))
      .tables("lights", span_table(), "spans in which the light is on")
      .optional_text("controller", "controller that flies it; absent: that of the vehicle")
      .table("geodetic_origin", origin, "origin of the world frame")
      .tables("players", player_table(), "pilots of the course, in simulation");
  return table;
}

std::vector<std::string> notes_argument(lua_State* state, int index, const char* key,
                                        const Origin& origin) {
  std::vector<std::string> notes;
  lua_getfield(state, index, key);
  const Value given = value_from_lua(state, -1, origin, std::string("plan.") + key);
  lua_pop(state, 1);
  if (given.is_null()) return notes;
  for (const Value& note : given.as_list()) notes.push_back(note.as_text());
  return notes;
}

constexpr BoundField kPlanObjects[] = {
    {"solution", "lapwing.solution", "solution with the motion"},
    {"notes?", "string[]", "sentences for the user"},
    {"details?", "string[]",
     "sentences on failed attempts: shown "
     "if the plan is not certified, or with --verbose"},
    {"figures?", "table", "figures of the mission kind, for --json"},
    kStatedSections};

// plan:add_sections(sections): more of its report.
int add_sections(lua_State* state) {
  PlanObject& made = object_argument<PlanObject>(state, 1, kPlanType);
  lua_settop(state, 2);
  lua_createtable(state, 0, 1);
  lua_insert(state, 2);
  lua_setfield(state, 2, "sections");
  for (Section& section : stated_sections(state, 2, "add_sections"))
    made.sections.push_back(std::move(section));
  return 0;
}

int plan(lua_State* state) {
  MissionRun& run = run_of(state);
  const Origin origin = Sandbox::of(state).script_position(state);
  const Parameters given = table_argument(state, 2, plan_table(), "plan", kPlanObjects);
  lua_getfield(state, 2, "solution");
  const SolutionObject& solution = object_argument<SolutionObject>(state, -1, kSolutionType);
  PlanObject made;
  made.report = solution.result.report;
  made.solver = solution.solver;
  made.notes = notes_argument(state, 2, "notes", origin);
  made.details = notes_argument(state, 2, "details", origin);
  lua_getfield(state, 2, "figures");
  made.block = value_from_lua(state, -1, origin, "plan.figures");
  made.sections = stated_sections(state, 2, "sections");
  made.pilots = pilots_of(given.tables("players"), run.files);

  Plan& document = made.plan;
  document.mission = run.name;
  document.kind = run.kind;
  document.vehicle = to_value(solution.problem->vehicle());
  if (given.has("controller")) document.vehicle.set("controller", given.text("controller"));
  document.trajectory = solution.problem->trajectory(solution.result.point.stages);
  document.environment = solution.problem->environment();
  document.task = task_of(given.table("task"));
  document.constraints = solution.constraints;
  for (const Parameters& cut : given.tables("cuts"))
    document.cuts.push_back({cut.number("start"), cut.number("finish")});
  for (const Parameters& light : given.tables("lights"))
    document.lights.push_back({light.number("start"), light.number("finish")});
  if (given.has("budget")) document.budget = given.number("budget");
  document.geodetic_origin = origin_of(run, given.table("geodetic_origin"));
  document.home = run.home;
  document.configuration = run.configuration;
  document.solver = to_value(solution.result.report, solution.solver);
  if (solution.started_from.is_map()) document.solver.set("started_from", solution.started_from);
  if (run.stating && run.stating->problem == solution.problem) {
    run.stating->plan = std::move(document);
    throw StatementMade();
  }
  new_object(state, kPlanType, std::move(made));
  return 1;
}

constexpr BoundField kPlanFields[] = {
    {"duration", "number", "s"},
    {"keyframes", "integer", "number of keyframes in its task"},
    {"views", "table[]", "views of a scan: {position, yaw, pitch}, m and rad"}};

int plan_field(lua_State* state) {
  const PlanObject& made = object_argument<PlanObject>(state, 1, kPlanType);
  const Plan& plan = made.plan;
  Value views = Value::list(), fields = Value::map();
  if (plan.task.scan)
    for (const PlannedView& view : plan.task.scan->views) {
      Value entry = Value::map();
      entry.set("position",
                Value(Value::List{view.position.x(), view.position.y(), view.position.z()}));
      entry.set("yaw", view.yaw);
      entry.set("pitch", view.pitch);
      views.push_back(std::move(entry));
    }
  fields.set("views", std::move(views));
  fields.set("duration", plan.trajectory.duration());
  fields.set("keyframes", static_cast<int>(plan.task.keyframes.size()));
  const std::string field = text_argument(state, 2, "plan");
  return push_field(state, "a plan", field, fields, kPlanFields);
}

// run:certify(plan): {feasible =, failures = {"sentence", ...}, checks = {...}}; a check that was
// made has its result in words as `line`.
int certify(lua_State* state) {
  const PlanObject& object = object_argument<PlanObject>(state, 2, kPlanType);
  Certificate certificate;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const MissionRun& run = run_of(state);
    certificate = verify(object.plan, {.folder = run.obstacles.folder(),
                                       .controllers = controllers_of(*run.settings.registry)});
  }
  Value result = certificate.to_value();
  Value failures = Value::list(), checks = Value::list();
  for (const Check& check : certificate.failures()) failures.push_back(to_line(check));
  for (std::size_t i = 0; i < certificate.checks.size(); ++i) {
    Value check = result.at("checks").as_list()[i];
    if (certificate.checks[i].skipped.empty()) check.set("line", to_line(certificate.checks[i]));
    checks.push_back(std::move(check));
  }
  result.set("checks", std::move(checks));
  result.set("failures", std::move(failures));
  push_value(state, result);
  return 1;
}

}  // namespace

std::span<const Binding> planning_methods_of_run() {
  static const Binding methods[] = {
      {"plan", &guarded<plan>, "(made: @): lapwing.plan",
       "the plan that `plan` of a mission returns", &plan_table, kPlanObjects},
      {"certify", &guarded<certify>, "(plan: lapwing.plan): table",
       "the result of the verifier: `feasible`, `failures` (sentences) and `checks`; a check is as "
       "in a plan, with its result in words as `line`"}};
  return methods;
}

void open_plan_library(lua_State* state) {
  static const Binding of_plan[] = {
      {"add_sections", &guarded<add_sections>, "(sections: table[])",
       "adds sections to its report: text, facts, tables, charts, drawings, images"}};
  define_type<PlanObject>(state, kPlanType, {of_plan}, &guarded<plan_field>);
  note_fields(state, kPlanType, kPlanFields);
}

}  // namespace lapwing
