// SPDX-License-Identifier: Apache-2.0
// Iteration in an order that is the same in every run.
//
// Lua's own order follows addresses and a random seed. Here keys come as numbers by value, texts
// byte by byte, then false and true, tables, functions, userdata and threads, each in the order in
// which they were made.
#pragma once

struct lua_State;

namespace lapwing {

// pairs(t): the keys that t has at the time of the call; those removed meanwhile are passed over.
int ordered_pairs(lua_State* state);

// next(t [, k]): the first key after k, and its value. A walk asks for the order once, when it
// leaves the first key, and keeps it until it ends or another walk of t begins; like in Lua itself
// keys may be removed while one walks, not added. next(t) alone looks at every key once.
int ordered_next(lua_State* state);

}  // namespace lapwing
