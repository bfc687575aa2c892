// SPDX-License-Identifier: Apache-2.0
// A fuzzer without libFuzzer: reads the files that are named, one after the other. An ordinary
// build makes these programs (CMakeLists.txt) to see that each list of sources links.
#include <cstddef>
#include <cstdint>

#include "framework/core/files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string bytes = lapwing::read_file(argv[k]);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
}
