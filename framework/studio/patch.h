// SPDX-License-Identifier: Apache-2.0
// Changes of a document of options, their inverses, and configurations that make them.
//
// A document is the effective configuration of a mission: maps, lists and plain values.
#pragma once

#include <optional>
#include <vector>

#include "framework/studio/option_path.h"

namespace lapwing {

// Sets what is at the path; without a value, removes the key that it ends with.
struct Change {
  OptionPath path;
  std::optional<Value> value;
  bool operator==(const Change&) const = default;
};

// Applied in order and together.
using Patch = std::vector<Change>;

inline constexpr std::size_t kMostChanges = 2000;  // of a patch from outside

// [{"path": "keyframes[2].time", "value": 3}, {"path": "volume.upper", "remove": true}]. Throws
// InputError, its text beginning with `what`, for anything else and for more than that many.
Patch patch_from(const Value& list, const std::string& what);
Value to_value(const Patch& patch);

// Applies it and returns what takes it back. Keys may be new; what leads to them, and entries of
// lists, must be there. Throws InputError naming the path; the document is then as it was.
Patch apply_patch(Value& document, const Patch& patch);

// What makes the one of the other: as small as paths can say, lists of another length whole. The
// order of keys that are new in `to` is not kept.
Patch difference(const Value& from, const Value& to);

// Whether a change of one is at, above or below a change of the other.
bool overlap(const Patch& a, const Patch& b);

// Whether both are the same: maps whatever the order of their keys.
bool same_options(const Value& a, const Value& b);

// The same without where its parts were written: what came over a wire has no file and line.
Value without_origins(const Value& value);

// The configuration that makes `document` of a script whose own is `script`, by the rules of
// `merge`: changed keys alone, lists and what has another `type` whole. Keys that the document
// lacks cannot be taken away, and stay.
Value layer_of(const Value& script, const Value& document);

}  // namespace lapwing
