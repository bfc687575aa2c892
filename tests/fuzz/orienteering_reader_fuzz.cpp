// SPDX-License-Identifier: Apache-2.0
// Orienteering instances: whatever the bytes, a tour problem with a budget and distances of at
// least 0, or an InputError.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/view/orienteering_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const TourProblem problem(
        read_orienteering({reinterpret_cast<const char*>(data), size}, "input").definition);
    if (!(problem.budget() >= 0)) std::abort();
    for (const double leg : problem.legs_from(problem.start()))
      if (!(leg >= 0)) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
