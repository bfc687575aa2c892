// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/scene_script.h"

#include <lua.hpp>

#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"

namespace lapwing {

GeneratedScene finished_scene(const SceneObject& object) {
  SceneObject::Parts& parts = *object.parts;
  const std::string what = "scene '" + parts.name + "'";
  if (parts.builder.depth() > 1) throw InputError(what + ": a push lacks its pop");
  if (parts.region.isEmpty()) throw InputError(what + " names no region of interest: call region");
  GeneratedScene scene{parts.name, parts.region, parts.builder.mesh(), parts.moves};
  check_mesh(scene.mesh, what);
  return scene;
}

GeneratedScene generate_scene(const std::filesystem::path& script, const Value& options,
                              const MissionSettings& settings) {
  std::vector<std::filesystem::path> folders{script.parent_path().empty() ? "."
                                                                          : script.parent_path()};
  folders.insert(folders.end(), settings.data.begin(), settings.data.end());
  folders.push_back(settings.configs);
  MissionRun run{settings, DataFiles(folders), "", "", Value::map(), 0};
  GeneratedScene scene;
  Sandbox sandbox(settings.limits, settings.seed, {settings.scripts}, settings.print);
  sandbox.watch(settings.cancellation);
  sandbox.protect([&](lua_State* state) {
    open_lapwing_library(state, run);
    open_scene_library(state);
    sandbox.run_script(state, script);
    if (!lua_isfunction(state, -1)) {
      throw InputError(sandbox.script_position(state),
                       std::string("a scene script returns a function from options to a scene; "
                                   "this one returns ") +
                           luaL_typename(state, -1));
    }
    push_value(state, options.is_null() ? Value::map() : options);
    lua_call(state, 1, 1);
    const SceneObject* made = test_object<SceneObject>(state, -1, kSceneType);
    if (!made) {
      throw InputError(
          sandbox.script_position(state),
          std::string("expected the function to return a scene, got ") + luaL_typename(state, -1));
    }
    scene = finished_scene(*made);
  });
  return scene;
}

}  // namespace lapwing
