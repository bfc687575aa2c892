// SPDX-License-Identifier: Apache-2.0
// Plan documents: whatever the bytes, a plan that is written and read back as itself, or an
// InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/trajectory/plan.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const Plan plan =
        plan_from_value(from_json({reinterpret_cast<const char*>(data), size}, "input"));
    const std::string text = plan_text(plan);
    if (plan_text(plan_from_value(from_json(text, "written"))) != text) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
