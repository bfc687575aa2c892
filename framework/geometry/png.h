// Pictures as PNG files.
#pragma once

#include <string>

#include "framework/geometry/render.h"

namespace lapwing {

// The bytes of a PNG file; equal pictures give equal bytes with one version of zlib. Throws Error
// when the picture has no pixel or its bytes do not fit its size.
std::string encode_png(const Picture& picture);

}  // namespace lapwing
