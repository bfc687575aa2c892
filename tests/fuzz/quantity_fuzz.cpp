// SPDX-License-Identifier: Apache-2.0
// Quantities such as `36 km/h`: whatever the bytes, a number or none. The first byte chooses the
// unit that is wanted.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>

#include "framework/core/units.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* kUnits[] = {"",  "m",   "m/s",   "m/s^2", "s",
                                    "1", "rad", "rad/s", "kg",    "a unit that nobody has"};
  const auto number = lapwing::parse_quantity({reinterpret_cast<const char*>(data + 1), size - 1},
                                              kUnits[data[0] % std::size(kUnits)]);
  if (number && *number != *number) std::abort();
  return 0;
}
