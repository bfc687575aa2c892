// SPDX-License-Identifier: Apache-2.0
// JSON documents: whatever the bytes, a value that is written and read back as itself, or an
// InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const Value value = from_json({reinterpret_cast<const char*>(data), size}, "input");
    const std::string text = to_json(value, -1);
    if (to_json(from_json(text, "written"), -1) != text) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
