// SPDX-License-Identifier: Apache-2.0
// Explorations: run:explore and what it returns.
#pragma once

#include <vector>

#include "framework/export/report.h"
#include "framework/mission/binding.h"
#include "framework/plugin/registry.h"

namespace lapwing {

// Adds the type `exploration`.
void open_explore_library(lua_State* state);

// run:explore, and the table that it takes.
ParameterTable explore_table();
inline constexpr BoundField kExploreObjects[] = {{"surface", "lapwing.surface", "explored surface"},
                                                 {"map", "lapwing.map_choice", "map to build"},
                                                 {"utility", "lapwing.utility", "value of a view"}};
int explore_surface(lua_State* state);

// What a report shows of the exploration at a place of the stack. InputError where there is none.
std::vector<Section> sections_of_exploration(lua_State* state, int index);

// Whether a utility declares that it reads the truth. InputError for one that there is not.
bool needs_truth(const Registry& registry, const std::string& utility);

}  // namespace lapwing
