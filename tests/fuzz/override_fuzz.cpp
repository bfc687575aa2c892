// SPDX-License-Identifier: Apache-2.0
// Overrides, as `--set` takes them: whatever the bytes, they are laid on a configuration, or they
// are an InputError and the configuration is as before.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/config/overrides.h"
#include "framework/core/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  static const Value kBase = [] {
    Value weights = Value::map();
    weights.set("snap", 1.5);
    Value keyframe = Value::map();
    keyframe.set("time", 3);
    Value base = Value::map();
    base.set("name", "a film");
    base.set("weights", weights);
    base.set("keyframes", Value(Value::List{keyframe, keyframe}));
    base.set("solver", "iqp");
    return base;
  }();
  Value value = kBase;
  try {
    apply_override(value, std::string(reinterpret_cast<const char*>(data), size));
  } catch (const InputError&) {
    if (!(value == kBase)) std::abort();
  }
  return 0;
}
