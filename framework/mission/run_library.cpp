// SPDX-License-Identifier: Apache-2.0
// `run`, which a mission's `plan` gets: the methods of all libraries, and what the user is told.
#include <lua.hpp>

#include "framework/core/phases.h"
#include "framework/mission/controller_source.h"
#include "framework/mission/fleet_objects.h"
#include "framework/mission/flight_library.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/map_objects.h"
#include "framework/mission/photo_objects.h"
#include "framework/mission/place_library.h"
#include "framework/mission/players.h"
#include "framework/mission/run.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/site_objects.h"
#include "framework/mission/value_path.h"

namespace lapwing {

void begin_planning(MissionRun& run) {
  run.planning_began = true;
  if (run.judging) throw PlanningBegins();
}

Origin place_of_option(lua_State* state, const std::string& path) {
  const Origin origin = innermost_at(run_of(state).configuration, path).origin();
  if (origin.source.empty() || origin.source == "default")
    return Sandbox::of(state).script_position(state);
  return origin;
}

namespace {

int cancelled(lua_State* state) {
  const CancellationToken* token = run_of(state).settings.cancellation;
  lua_pushboolean(state, token && token->cancelled());
  return 1;
}

int progress(lua_State* state) {
  Progress* progress = run_of(state).settings.progress;
  const double fraction = luaL_checknumber(state, 2);
  const std::string what = text_argument(state, 3, "progress");
  if (progress) progress->report(fraction, what);
  return 0;
}

// run:phases { {name = "search", weight = 3}, ... }: before the first one begins.
int phases(lua_State* state) {
  const Value given = value_from_lua(state, 2, Sandbox::of(state).script_position(state), "phases");
  if (!given.is_list()) throw InputError(given.origin(), "phases: expected a list of phases");
  std::vector<Phase> phases;
  for (const Value& entry : given.as_list()) {
    const Value* name = entry.is_map() ? entry.find("name") : nullptr;
    const Value* weight = entry.is_map() ? entry.find("weight") : nullptr;
    if (!name || !name->is_text() || (weight && !weight->is_number()))
      throw InputError(given.origin(), "phases: expected {name = text, weight = number} each");
    phases.push_back({name->as_text(), weight ? std::max(0.0, weight->as_number()) : 0});
  }
  expect_phases(run_of(state).settings.progress, std::move(phases));
  return 0;
}

// run:phase("search"): the one before has ended.
int phase(lua_State* state) {
  begin_phase(run_of(state).settings.progress, text_argument(state, 2, "phase"));
  return 0;
}

// run:fail("keyframes[2].time", "message"): an error at the place of that option.
int fail(lua_State* state) {
  const std::string path = text_argument(state, 2, "fail");
  const std::string message = text_argument(state, 3, "fail");
  throw InputError(place_of_option(state, path), path + ": " + message);
}

// run:expect_plugin("tour.begin", "tour_solver"): an error where that option is given and names no
// plugin of the kind.
int expect_plugin(lua_State* state) {
  const std::string path = text_argument(state, 2, "expect_plugin");
  const std::string kind = text_argument(state, 3, "expect_plugin");
  const Value* value = at_path(run_of(state).configuration, path);
  if (!value || value->is_null()) return 0;
  if (!value->is_text()) throw InputError(value->origin(), path + ": expected a plugin's name");
  run_of(state).settings.registry->find(kind, value->as_text(), value->origin());
  return 0;
}

// run:expect_controller("controller"): an error where that option is given and names no controller,
// or parameters that it does not take.
int expect_controller(lua_State* state) {
  const std::string path = text_argument(state, 2, "expect_controller");
  const MissionRun& run = run_of(state);
  const Value* value = at_path(run.configuration, path);
  if (value && !value->is_null())
    controllers_of (*run.settings.registry)(controller_choice_from(*value, path));
  return 0;
}

// run:expect_players("players"): an error where that option names a log that cannot be read, before
// anything is computed that the error would lose.
int expect_players(lua_State* state) {
  const std::string path = text_argument(state, 2, "expect_players");
  const MissionRun& run = run_of(state);
  const Value* value = at_path(run.configuration, path);
  if (!value || !value->is_list()) return 0;
  for (std::size_t i = 0; i < value->as_list().size(); ++i)
    pilots_of(
        {check(player_table(), value->as_list()[i], path + "[" + std::to_string(i + 1) + "]")},
        run.files);
  return 0;
}

// run:stated("exploration.speed"): whether somebody wrote that option, or it is its default.
int stated(lua_State* state) {
  const std::string path = text_argument(state, 2, "stated");
  const Value* value = at_path(run_of(state).configuration, path);
  lua_pushboolean(state, value && !value->is_null() && !value->origin().source.empty() &&
                             value->origin().source != "default");
  return 1;
}

std::span<const Binding> told_methods() {
  static const Binding methods[] = {
      {"cancelled", &guarded<cancelled>, "(): boolean", "whether the user cancelled the run"},
      {"phases", &guarded<phases>, "(phases: table[])",
       "states the phases of the work: a list of {name, weight}; weights are relative, and "
       "optional"},
      {"phase", &guarded<phase>, "(name: string)", "begins a phase, and ends the one before"},
      {"progress", &guarded<progress>, "(fraction: number, words: string)",
       "reports progress, 0 to 1, with a text"},
      {"fail", &guarded<fail>, "(option: string, message: string)",
       "raises an error at the place where the option is set"},
      {"expect_plugin", &guarded<expect_plugin>, "(option: string, kind: string)",
       "raises an error at the option if it names no plugin of the kind"},
      {"expect_controller", &guarded<expect_controller>, "(option: string)",
       "raises an error at the option if it names no controller, or an unknown parameter of it"},
      {"expect_players", &guarded<expect_players>, "(option: string)",
       "raises an error at the option if it names a stick log that cannot be read"},
      {"stated", &guarded<stated>, "(option: string): boolean",
       "true if the option was set, false if it has its default"}};
  return methods;
}

// All that `run` can be asked, by library.
BindingLists all_methods() {
  return {problem_methods_of_run(), solving_methods_of_run(), planning_methods_of_run(),
          told_methods(),           place_methods_of_run(),   flight_methods_of_run(),
          map_methods_of_run(),     scan_methods_of_run(),    site_methods_of_run(),
          photo_methods_of_run(),   fleet_methods_of_run(),   city_methods_of_run()};
}

int run_field(lua_State* state) {
  const std::string field = text_argument(state, 2, "run");
  if (field == "options") {
    push_value(state, run_of(state).configuration);
    return 1;
  }
  if (field == "start") {
    const auto& start = run_of(state).settings.start;
    if (start)
      new_object(state, kPlanType, PlanObject{.plan = *start});
    else
      lua_pushnil(state);
    return 1;
  }
  std::vector<std::string> known = {"options", "start"};
  for (const auto list : all_methods())
    for (const Binding& method : list) known.emplace_back(method.name);
  const std::string nearest = nearest_name(field, known);
  throw InputError("run has no '" + field + "'" +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

struct RunHandle {};

}  // namespace

void open_run_library(lua_State* state) {
  static constexpr BoundField kRunFields[] = {
      {"options", "table", "the effective options"},
      {"start?", "lapwing.plan", "the plan of `--from`, to begin from"}};
  define_type<RunHandle>(state, kRunType, all_methods(), &guarded<run_field>);
  note_fields(state, kRunType, kRunFields);
}

void push_run(lua_State* state) {
  new_object(state, kRunType, RunHandle{});
}

}  // namespace lapwing
