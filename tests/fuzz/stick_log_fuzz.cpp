// SPDX-License-Identifier: Apache-2.0
// Logs of a pilot's stick: whatever the bytes, deflections from -1 to 1 at rising times, or an
// InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/vehicle/stick_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const StickLog log = parse_stick_log({reinterpret_cast<const char*>(data), size}, "input");
    double last = -1;
    for (const StickSample& sample : log.samples()) {
      if (!(sample.time > last) || !(sample.stick.cwiseAbs().maxCoeff() <= 1)) std::abort();
      last = sample.time;
    }
    if (!(log.at(0.5 * log.end()).cwiseAbs().maxCoeff() <= 1)) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
