// SPDX-License-Identifier: Apache-2.0
#include "framework/core/png.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>

#include "framework/core/error.h"

namespace lapwing {
namespace {

std::string encoded(int width, int height, png_uint_32 format, const void* pixels, bool fits) {
  const std::string size_text = std::to_string(width) + " by " + std::to_string(height);
  if (width < 1 || height < 1 || !fits) {
    throw Error("a picture of " + size_text + " pixels does not fit what it holds");
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr) == 0) {
    throw Error(std::string("PNG: ") + image.message);
  }
  bytes.resize(size);
  return bytes;
}

// libpng leaves by longjmp, so nothing here may own anything: the functions that it may leave hold
// plain numbers and pointers alone.
struct PngBytes {
  const char* bytes;
  std::size_t size, at = 0;
  char message[128] = "";
};

void take_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto* source = static_cast<PngBytes*>(png_get_io_ptr(png));
  if (count > source->size - source->at) png_error(png, "it ends too early");
  std::memcpy(out, source->bytes + source->at, count);
  source->at += count;
}

[[noreturn]] void leave(png_structp png, png_const_charp message) {
  auto* source = static_cast<PngBytes*>(png_get_error_ptr(png));
  std::strncpy(source->message, message, sizeof source->message - 1);
  png_longjmp(png, 1);
}

void stay_silent(png_structp, png_const_charp) {}

struct PngHeader {
  png_uint_32 width, height;
  int depth, color;
};

bool read_header(png_structp png, png_infop info, PngBytes* source, PngHeader* header) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_read_fn(png, source, take_bytes);
  png_set_user_limits(png, 1'000'000, 1'000'000);
  png_read_info(png, info);
  png_get_IHDR(png, info, &header->width, &header->height, &header->depth, &header->color, nullptr,
               nullptr, nullptr);
  return true;
}

bool read_rows(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_swap(png);  // files hold the high byte first
  png_set_interlace_handling(png);
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& name)
      : source_{bytes.data(), bytes.size()}, name_(name) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, leave, stay_silent);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
    if (!info_) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw Error("libpng cannot be used");
    }
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  Grey16 read() {
    PngHeader header{};
    if (!read_header(png_, info_, &source_, &header)) fail(source_.message);
    if (header.depth != 16 || header.color != PNG_COLOR_TYPE_GRAY) {
      fail("expected one channel of 16 bits (depth in millimetres), got " +
           std::to_string(header.depth) + " bits and colour type " + std::to_string(header.color));
    }
    if (static_cast<double>(header.width) * header.height > 1e8) {
      fail("more than 100 million pixels");
    }
    Grey16 image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
    image.pixels.resize(std::size_t{header.width} * header.height);
    std::vector<png_bytep> rows(header.height);
    for (std::size_t y = 0; y < rows.size(); ++y) {
      rows[y] = reinterpret_cast<png_bytep>(image.pixels.data() + y * header.width);
    }
    if (!read_rows(png_, rows.data())) fail(source_.message);
    return image;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(name_ + ": not a PNG depth image: " + why);
  }

  PngBytes source_;
  const std::string& name_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

std::string encode_png(const Picture& picture) {
  const std::size_t pixels = static_cast<std::size_t>(std::max(0, picture.width)) *
                             static_cast<std::size_t>(std::max(0, picture.height));
  return encoded(picture.width, picture.height, PNG_FORMAT_RGB, picture.rgb.data(),
                 picture.rgb.size() == 3 * pixels);
}

std::string encode_grey16_png(const Grey16& picture) {
  const std::size_t pixels = static_cast<std::size_t>(std::max(0, picture.width)) *
                             static_cast<std::size_t>(std::max(0, picture.height));
  return encoded(picture.width, picture.height, PNG_FORMAT_LINEAR_Y, picture.pixels.data(),
                 picture.pixels.size() == pixels);
}

Grey16 decode_grey16_png(const std::string& bytes, const std::string& name) {
  return Reader(bytes, name).read();
}

}  // namespace lapwing
