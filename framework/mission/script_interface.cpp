// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/script_interface.h"

#include <algorithm>

#include <lua.hpp>

#include "framework/core/files.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/options.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

// Modules that declare options, by themselves or through mission/mission_of.lua.
std::vector<std::string> mission_modules(const fs::path& scripts) {
  std::vector<std::string> names;
  for (const auto& item : fs::directory_iterator(scripts / "mission")) {
    if (item.path().extension() != ".lua") continue;
    const std::string text = read_file(item.path());
    if (text.find("lapwing.options(") != std::string::npos ||
        text.find("require \"mission.mission_of\"") != std::string::npos)
      names.push_back(item.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// Calls every function of the module on top of the stack with an empty table. What returns a
// mission of the module's kind makes such missions.
void ask_functions(lua_State* state, const std::string& kind, std::vector<MissionFunction>& found) {
  const int module = lua_gettop(state);
  if (!lua_istable(state, module)) return;
  std::vector<std::string> names;
  for (lua_pushnil(state); lua_next(state, module); lua_pop(state, 1))
    if (lua_type(state, -2) == LUA_TSTRING && lua_isfunction(state, -1))
      names.emplace_back(lua_tostring(state, -2));
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    lua_settop(state, module);
    lua_getfield(state, module, name.c_str());
    lua_newtable(state);
    if (lua_pcall(state, 1, 1, 0) != LUA_OK || !lua_istable(state, -1)) continue;
    const int mission = lua_gettop(state);
    lua_getfield(state, mission, "kind");
    if (lua_type(state, -1) != LUA_TSTRING || lua_tostring(state, -1) != kind) continue;
    lua_getfield(state, mission, "options");
    if (const auto* options = test_object<MissionOptions>(state, -1, kOptionsType))
      found.push_back({kind, name, options->declarations.to_value()});
  }
}

// Tables of the module on top of the stack that hold `described`, as film.shots does:
// {{name =, summary =, gives =, arguments = {...}}, ...}.
void read_described(lua_State* state, const std::string& kind,
                    std::vector<DescribedFunction>& found) {
  const int module = lua_gettop(state);
  if (!lua_istable(state, module)) return;
  std::vector<std::string> names;
  for (lua_pushnil(state); lua_next(state, module); lua_pop(state, 1))
    if (lua_type(state, -2) == LUA_TSTRING && lua_istable(state, -1))
      names.emplace_back(lua_tostring(state, -2));
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    lua_settop(state, module);
    lua_getfield(state, module, name.c_str());
    if (lua_getfield(state, -1, "described") != LUA_TTABLE) continue;
    const Value list = value_from_lua(state, lua_gettop(state), {kind, 0}, "described");
    for (const Value& entry : list.as_list())
      found.push_back({kind + "." + name, entry.at("name").as_text(), entry.at("summary").as_text(),
                       entry.at("gives").as_text(),
                       OptionDeclarations::from_value(entry.at("arguments")).to_value()});
  }
  lua_settop(state, module);
}

}  // namespace

ScriptInterface read_script_interface(const MissionSettings& settings) {
  ScriptInterface interface;
  MissionRun run{settings, DataFiles({settings.configs}), "", "", Value::map(), 0, {}};
  Sandbox sandbox(settings.limits, settings.seed, {settings.scripts}, settings.print);
  sandbox.protect([&](lua_State* state) {
    note_bindings(state, interface.types);
    open_script_libraries(state, run);
    for (const std::string& name : mission_modules(settings.scripts)) {
      lua_settop(state, 0);
      sandbox.require(state, "mission." + name);
      read_described(state, name, interface.described);
      ask_functions(state, name, interface.missions);
    }
    lua_settop(state, 0);
  });
  return interface;
}

}  // namespace lapwing
