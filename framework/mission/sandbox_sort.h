// SPDX-License-Identifier: Apache-2.0
// table.sort without chance.
#pragma once

struct lua_State;

namespace lapwing {

// table.sort(t [, before]) for at most `kLargestSort` entries. Stable: what compares equal stays in
// the order it had. Lua's own picks its pivots by the clock, so that equal entries, and a
// comparison that contradicts itself, come out in another order in another run.
inline constexpr long long kLargestSort = 2'000'000;
int stable_sort(lua_State* state);

}  // namespace lapwing
