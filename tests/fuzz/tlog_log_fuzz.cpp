// SPDX-License-Identifier: Apache-2.0
// Telemetry logs: whatever the bytes, a sound log or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "plugins/flight_logs/tlog/tlog_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const FlightLog log = tlog::read(bytes);
    if (!faults_of(log).empty()) std::abort();
    if (log.bytes != size || log.bytes_read > size) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
