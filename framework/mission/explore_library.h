// Explorations: run:explore and what it returns.
#pragma once

#include "framework/mission/binding.h"

namespace lapwing {

// Adds the type `exploration`.
void open_explore_library(lua_State* state);

// run:explore, and the table that it takes.
ParameterTable explore_table();
inline constexpr BoundField kExploreObjects[] = {
    {"surface", "lapwing.surface", "that is explored"},
    {"map", "lapwing.map_choice", "that is made of it"},
    {"utility", "lapwing.utility", "how useful a view is"}};
int explore_surface(lua_State* state);

}  // namespace lapwing
