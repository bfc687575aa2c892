// Explorations: run:explore and what it returns.
#pragma once

struct lua_State;

namespace lapwing {

// Adds the type `exploration`.
void open_explore_library(lua_State* state);

// run:explore{surface =, map =, utility =, camera =, ...}: an exploration, whatever came out.
// Its fields: end, reason, images, efficiency, observed_surface, surface, length, seconds,
// relative (to the oracle from the same start; nil unless compare); its method:
// exploration:plan{vehicle =, margin =} -> a plan of the flown path in the map that it made.
int explore_surface(lua_State* state);

}  // namespace lapwing
