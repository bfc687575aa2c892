// SPDX-License-Identifier: Apache-2.0
// The fuzzers of this folder, from a list that the build writes (tests.cmake).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lapwing {

struct FuzzedReader {
  const char* name;                               // of NAME_fuzz.cpp, and of the folder of inputs
  int (*fuzz)(const std::uint8_t*, std::size_t);  // its LLVMFuzzerTestOneInput
};

std::vector<FuzzedReader> fuzzed_readers();

}  // namespace lapwing
