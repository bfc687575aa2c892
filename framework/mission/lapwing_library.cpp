// SPDX-License-Identifier: Apache-2.0
// The table `lapwing`: what a script needs before there is a run.
#include <lua.hpp>

#include "framework/core/files.h"
#include "framework/geometry/geodetic.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/options.h"
#include "framework/mission/run.h"
#include "framework/mission/script_lines.h"

namespace lapwing {

namespace {

ParameterTable geodetic_table() {
  ParameterTable table;
  table.required_number("lat", "", "degrees north", between(-90, 90))
      .required_number("lon", "", "degrees east", between(-180, 180))
      .required_number("alt", "m", "metres above the ellipsoid");
  return table;
}

GeodeticPoint geodetic_argument(lua_State* state, int index, const char* what) {
  const Parameters point = table_argument(state, index, geodetic_table(), what);
  return {point.number("lat"), point.number("lon"), point.number("alt")};
}

// lapwing.local_from_geodetic(origin, point), both {lat=, lon=, alt=}: {x, y, z}, east, north, up.
int local_from_geodetic(lua_State* state) {
  const GeodeticPoint origin = geodetic_argument(state, 1, "origin");
  const GeodeticPoint point = geodetic_argument(state, 2, "point");
  const Eigen::Vector3d local = to_local(origin, point);
  push_value(state, Value(Value::List{local.x(), local.y(), local.z()}));
  return 1;
}

// Values that are written in the script's call have their own lines.
void locate_in_script(lua_State* state, const Origin& call, Value& given) {
  if (call.source != Sandbox::of(state).script()) return;
  try {
    locate_argument(given, read_file(call.source), call.line);
  } catch (const InputError&) {  // removed since it was run: the line of the call must do
  }
}

// lapwing.options(declarations, given): the options of a mission.
int options(lua_State* state) {
  const Origin origin = Sandbox::of(state).script_position(state);
  MissionOptions made;
  made.declarations =
      OptionDeclarations::from_value(value_from_lua(state, 1, origin, "declarations"));
  made.given = value_from_lua(state, 2, origin);
  claim_copies(state, made.given);
  if (made.given.is_list() && made.given.as_list().empty()) made.given = Value::map();
  if (!made.given.is_map()) {
    throw InputError(
        origin, "lapwing.options: expected a table of options, got " + made.given.describe_type());
  }
  made.given.with_origin(origin);
  locate_in_script(state, origin, made.given);
  new_object(state, kOptionsType, std::move(made));
  return 1;
}

// lapwing.arguments(what, declarations, given): the given values, checked, with every default.
int arguments(lua_State* state) {
  const Origin origin = Sandbox::of(state).script_position(state);
  const std::string what = text_argument(state, 1, "lapwing.arguments");
  const auto declarations =
      OptionDeclarations::from_value(value_from_lua(state, 2, origin, "declarations"));
  Value given = value_from_lua(state, 3, origin, what);
  if (given.is_list() && given.as_list().empty()) given = Value::map();
  if (!given.is_map())
    throw InputError(origin, what + ": expected a table, got " + given.describe_type());
  given.with_origin(origin);
  locate_in_script(state, origin, given);
  push_value(state, declarations.check(given, *run_of(state).settings.registry, what));
  return 1;
}

// lapwing.fail(message): an error at the script's own line, whatever module found it.
int fail(lua_State* state) {
  throw InputError(Sandbox::of(state).script_position(state),
                   text_argument(state, 1, "lapwing.fail"));
}

// lapwing.has_module(name): whether `require` finds it; if not, also the nearest name, or nil.
int has_module(lua_State* state) {
  const std::string module = text_argument(state, 1, "lapwing.has_module");
  const Sandbox& sandbox = Sandbox::of(state);
  const bool found = !sandbox.module_file(module).empty();
  lua_pushboolean(state, found);
  if (found) return 1;
  const std::string nearest = sandbox.nearest_module(module);
  if (nearest.empty())
    lua_pushnil(state);
  else
    push_text(state, nearest);
  return 2;
}

}  // namespace

MissionRun& run_of(lua_State* state) {
  lua_getfield(state, LUA_REGISTRYINDEX, "lapwing.run");
  MissionRun* run = static_cast<MissionRun*>(lua_touserdata(state, -1));
  lua_pop(state, 1);
  return *run;
}

Parameters table_argument(lua_State* state, int index, const ParameterTable& table,
                          const std::string& what, std::span<const std::string_view> without) {
  const Origin origin = Sandbox::of(state).script_position(state);
  if (!lua_istable(state, index)) {
    throw InputError(origin, what + ": expected a table, got " + luaL_typename(state, index));
  }
  return check(table, value_from_lua(state, index, origin, what, without), what);
}

void open_lapwing_library(lua_State* state, MissionRun& run) {
  lua_pushlightuserdata(state, &run);
  lua_setfield(state, LUA_REGISTRYINDEX, "lapwing.run");
  define_type<MissionOptions>(state, kOptionsType, {});
  note_fields(state, kOptionsType, {});
  note_fields(state, "option", kDeclarationKeys);
  note_fields(state, "mission", kMissionParts);
  static const Binding functions[] = {
      {"options", &guarded<options>,
       "(declarations: lapwing.option[], given: table): lapwing.options",
       "the options of a mission, from declarations and the values of the script"},
      {"arguments", &guarded<arguments>,
       "(what: string, declarations: lapwing.option[], given: table): table",
       "the arguments of a function, checked like options, with defaults"},
      {"local_from_geodetic", &guarded<local_from_geodetic>,
       "(origin: lapwing.geodetic, point: lapwing.geodetic): number[]",
       "the position {east, north, up} of the point relative to the origin, m"},
      {"has_module", &guarded<has_module>, "(name: string): boolean, string?",
       "whether `require` finds a module; if not, also the nearest name"},
      {"fail", &guarded<fail>, "(message: string)", "raises an error at the line of the script"}};
  static const BoundTable tables[] = {{"geodetic", &geodetic_table, {}}};
  lua_newtable(state);
  bind_functions(state, "lapwing", functions);
  note_tables(state, "lapwing", tables);
  lua_setglobal(state, "lapwing");
  open_data_library(state);
}

}  // namespace lapwing
