// Flying plans and timing paths: methods of `run`.
#pragma once

#include "framework/core/parameters.h"
#include "framework/trajectory/polyline.h"

struct lua_State;

namespace lapwing {

// x, y, z of two points or more in turn. InputError naming the key.
Points points_of(const Parameters& given, const std::string& key);

// The methods, for the table of `run`; to be guarded.
int fly_plan(lua_State* state);
int time_path(lua_State* state);
int path_distance(lua_State* state);
int pursue_path(lua_State* state);

}  // namespace lapwing
