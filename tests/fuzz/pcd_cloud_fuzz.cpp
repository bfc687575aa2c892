// SPDX-License-Identifier: Apache-2.0
// PCD files: text, binary, compressed.
#include <cstddef>

#include "tests/fuzz/cloud_points.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lapwing::read_all_points(data, size, ".pcd");
  return 0;
}
