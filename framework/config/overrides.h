// SPDX-License-Identifier: Apache-2.0
// `--set key.path=value`, and laying configurations on one another.
#pragma once

#include <span>
#include <string>

#include "framework/core/value.h"

namespace lapwing {

// Lays one override on `base`, by the rules of `merge`. The value is read as YAML:
// `weights.snap=2`, `solver=ipopt`, `start.velocity=[1, 0, 0]`, `name='4'`, `speed=36 km/h`. A list
// entry is named by its number, from 1 as in Lua: `keyframes[2].time=3`; it must exist. Nodes that
// are set get the origin "--set keyframes[2].time=3". InputError says what is malformed, or which
// part of the path is not there; `base` is then as it was.
void apply_override(Value& base, const std::string& text, const std::string& option = "--set");

// `lowest`, with `layers` laid on it in order, then `overrides` in order. Each value keeps the
// origin of the layer that it comes from.
Value layered(Value lowest, std::span<const Value> layers, std::span<const std::string> overrides);

}  // namespace lapwing
