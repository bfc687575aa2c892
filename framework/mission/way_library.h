// SPDX-License-Identifier: Apache-2.0
// Ways round what stands in the way: methods of a problem.
#pragma once

#include "framework/mission/binding.h"

namespace lapwing {

ParameterTable way_table();
inline constexpr BoundField kWayObjects[] = {
    {"planner", "lapwing.path_planner", "path planner"},
    {"excluded?", "number[][][]", "paths whose passages are not taken"}};
inline constexpr BoundField kCorridorWay[] = {{"way", "number[][]", "places, m, world"}};

// problem:plan_way{from =, to =, planner =, more =, excluded = {way, ...}, tries =}: {{x, y, z},
// ...}, a free way that keeps the margin, the distance to bystanders that stand still, and `more`
// metres, and goes through a passage that none of the excluded ways has; or nil, why there is none
// in words, and the planner's status: start_blocked, goal_blocked, iteration_limit, ...
int plan_way(lua_State* state);

// problem:grow_corridor{way = {{x, y, z}, ...}}: {{from =, to =, lower =, size =}, ...}, free boxes
// along the way, parts in shares of its length; empty where the way is not free.
int grow_corridor_of_problem(lua_State* state);

}  // namespace lapwing
