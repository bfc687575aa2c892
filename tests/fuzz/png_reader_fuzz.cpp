// SPDX-License-Identifier: Apache-2.0
// Depth images: whatever the bytes, as many pixels as the picture is large, or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "framework/core/error.h"
#include "framework/core/png.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const Grey16 image =
        decode_grey16_png(std::string(reinterpret_cast<const char*>(data), size), "input");
    if (image.width <= 0 || image.height <= 0) std::abort();
    const auto pixels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (image.pixels.size() != pixels) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
