// SPDX-License-Identifier: Apache-2.0
// Pictures and depth images as PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lapwing {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows from the top, three bytes (sRGB) a pixel
};

// One number of 16 bits a pixel, rows from the top: depth in millimetres, say.
struct Grey16 {
  int width = 0, height = 0;
  std::vector<std::uint16_t> pixels;
};

// The bytes of a PNG file; equal pictures give equal bytes with one version of zlib. Throws Error
// when the picture has no pixel or its bytes do not fit its size.
std::string encode_png(const Picture& picture);
std::string encode_grey16_png(const Grey16& picture);

// Throws InputError, beginning with `name`, when the bytes are no whole PNG of one 16-bit channel,
// or of more than 100 million pixels.
Grey16 decode_grey16_png(const std::string& bytes, const std::string& name);

}  // namespace lapwing
