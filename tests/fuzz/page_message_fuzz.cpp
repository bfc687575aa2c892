// SPDX-License-Identifier: Apache-2.0
// Messages of studio pages: whatever the bytes, a message or an InputError; a patch that applies to
// a document is taken back by its inverse, and one that does not leaves it as it was.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/json.h"
#include "framework/studio/page_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  static const Value before = from_json(
      R"({"margin": 0.5, "name": "x", "weights": {"yaw": 1, "type": "a"}, "none": null,
          "keyframes": [{"time": 0, "position": [0, 0, 2]}, {"time": 5}]})",
      "document");
  try {
    const PageMessage message = page_message({reinterpret_cast<const char*>(data), size});
    Value document = before;
    try {
      const Patch inverse = apply_patch(document, message.patch);
      const Patch said = difference(before, document);
      Value again = before;
      apply_patch(again, patch_from(to_value(said), "patch"));
      if (!same_options(again, document)) std::abort();
      apply_patch(document, inverse);
      if (!same_options(document, before)) std::abort();
    } catch (const InputError&) {
      if (!(document == before)) std::abort();
    }
  } catch (const InputError&) {
  }
  return 0;
}
