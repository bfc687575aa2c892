// SPDX-License-Identifier: Apache-2.0
// Scenes that a Lua script makes: a file that returns a function from options to a scene.
//
//   return function(options)
//     local scene = lapwing.scene { name = "hut", seed = options.seed or 1 }
//     scene:box({0, 0, 0}, {4, 3, 2.5})
//     scene:region({-1, -1, 0}, {5, 4, 3})
//     return scene
//   end
//
// See README.md for all that a scene can be asked for. Not thread-safe.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "framework/geometry/mesh_builder.h"
#include "framework/mission/run.h"

namespace lapwing {

struct GeneratedScene {
  std::string name;
  Eigen::AlignedBox3d region;  // of interest, m
  TriangleMesh mesh;           // with colours
  Value moves = Value::map();  // of explorations, that the scene recommends; scene_moves_table
};

// A scene being built; Lua holds references to it.
struct SceneObject {
  struct Parts {
    explicit Parts(std::uint64_t seed) : builder(seed), random(Random(seed).split(1)) {}
    std::string name;
    Eigen::AlignedBox3d region;  // empty until stated
    Value moves = Value::map();
    MeshBuilder builder;
    Random random;
  };
  std::shared_ptr<Parts> parts;
};

inline constexpr const char* kSceneType = "scene";

// How an exploration of the scene may move: step, turn_deg, body, clear, speed, as the mission's
// `moves` has them; what is left out is as everywhere.
ParameterTable scene_moves_table();

// Adds lapwing.scene and the type above; after open_lapwing_library.
void open_scene_library(lua_State* state);

// Takes the scene out of its object. InputError when it has no triangle or no region, or when a
// frame is still pushed.
GeneratedScene finished_scene(const SceneObject& object);

// Runs the script in a sandbox of its own and calls its function with `options` (a map, or null for
// none). InputError with the script's file and line. Of the settings it uses limits, scripts, data,
// configs, cancellation and print.
GeneratedScene generate_scene(const std::filesystem::path& script, const Value& options,
                              const MissionSettings& settings);

}  // namespace lapwing
