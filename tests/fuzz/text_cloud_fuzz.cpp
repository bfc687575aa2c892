// SPDX-License-Identifier: Apache-2.0
// Texts of points; the first byte selects whether columns are stated.
#include <cstddef>

#include "tests/fuzz/cloud_points.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  lapwing::CloudFileOptions options;
  if (data[0] & 1) options.columns = "- y x z nx ny nz class";
  lapwing::read_all_points(data + 1, size - 1, ".xyz", options);
  return 0;
}
