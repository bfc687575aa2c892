// SPDX-License-Identifier: Apache-2.0
// Maps and surfaces as Lua holds them.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "framework/mission/map_work.h"
#include "framework/mission/run.h"

namespace lapwing {

struct MapObject {
  std::shared_ptr<Mapping> mapping;
};

struct SurfaceObject {
  std::string name;
  std::shared_ptr<MeshScene> scene;
  Eigen::AlignedBox3d region;  // of interest, m
  Value moves = Value::map();  // that its scene recommends for explorations
};

inline constexpr const char* kMapType = "map";
inline constexpr const char* kSurfaceType = "surface";

inline constexpr BoundField kSurfaceObject[] = {{"surface", "lapwing.surface", "seen surface"}};

// Adds the types above; after open_lapwing_library.
void open_map_library(lua_State* state);
// surface, read_surface, map, map_resolution.
std::span<const Binding> map_methods_of_run();

}  // namespace lapwing
