#include "framework/geometry/png.h"

#include <png.h>

#include "framework/core/error.h"

namespace lapwing {

std::string encode_png(const Picture& picture) {
  if (picture.width < 1 || picture.height < 1 ||
      picture.rgb.size() !=
          3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height)) {
    throw Error("a picture of " + std::to_string(picture.width) + " by " +
                std::to_string(picture.height) + " pixels holds " +
                std::to_string(picture.rgb.size()) + " bytes");
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) ==
      0) {
    throw Error(std::string("PNG: ") + image.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace lapwing
