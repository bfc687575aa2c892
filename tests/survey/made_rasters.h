// SPDX-License-Identifier: Apache-2.0
// GeoTIFF files that tests make: one band of floats, or a picture; one strip, without compression.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/survey/made_clouds.h"

namespace lapwing {

struct MadeRaster {
  int width = 40, height = 40;             // pixels
  double left = 0, upper = 40, pixel = 1;  // in the raster's coordinates; rows go down
  int system = 0;                          // EPSG of a projected one; 0: none
  bool geographic = false;                 // the EPSG code is that of a geographic system
  bool placed = true;                      // with georeferencing
  std::function<float(double x, double y)> height_at = [](double, double) { return 0.0f; };
};

// Bands of bytes or of 16 bits, side by side.
struct MadePicture {
  int width = 40, height = 40;  // pixels
  int bands = 3, bits = 8;
  bool opacity = false;  // the last band is that
  // x = t[0] + column t[1] + row t[2], y = t[3] + column t[4] + row t[5].
  std::array<double, 6> transform{0, 1, 0, 40, 0, -1};
  int system = 0;  // EPSG; 0: none
  bool geographic = false;
  std::string empty;  // the value that is no data
  std::function<int(int column, int row, int band)> value_at = [](int, int, int) { return 0; };
};

class MadeTiff {
 public:
  MadeTiff(int width, int height, std::string values) : values_(std::move(values)) {
    add(256, static_cast<std::uint16_t>(width));
    add(257, static_cast<std::uint16_t>(height));
    add_long(273, kHead);
    add(278, static_cast<std::uint16_t>(height));
    add_long(279, static_cast<std::uint32_t>(values_.size()));
  }
  void add(std::uint16_t tag, std::uint16_t value) { entries_.push_back({tag, 3, 1, value}); }
  void add_long(std::uint16_t tag, std::uint32_t value) { entries_.push_back({tag, 4, 1, value}); }
  void add_shorts(std::uint16_t tag, const std::vector<std::uint16_t>& values) {
    if (values.size() == 1) return add(tag, values[0]);
    // Two of them fit in an entry.
    if (values.size() == 2)
      return entries_.push_back({tag, 3, 2, values[0] | std::uint32_t{values[1]} << 16});
    entries_.push_back({tag, 3, static_cast<std::uint32_t>(values.size()), far()});
    for (const std::uint16_t value : values) numbers_.put(value);
  }
  void add_doubles(std::uint16_t tag, const std::vector<double>& values) {
    entries_.push_back({tag, 12, static_cast<std::uint32_t>(values.size()), far()});
    for (const double value : values) numbers_.put(value);
  }
  // Of four bytes and more.
  void add_text(std::uint16_t tag, const std::string& text) {
    entries_.push_back({tag, 2, static_cast<std::uint32_t>(text.size() + 1), far()});
    numbers_.text(text).put(char{0});
  }
  void add_system(int code, bool geographic) {
    if (code == 0) return;
    const std::uint16_t model = geographic ? 2 : 1, key = geographic ? 2048 : 3072;
    add_shorts(34735, {1, 1, 0, 3, 1024, 0, 1, model, 1025, 0, 1, 1, key, 0, 1,
                       static_cast<std::uint16_t>(code)});
  }
  std::string bytes() {
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return a.tag < b.tag; });
    MadeBytes bytes;
    bytes.text("II").put<std::uint16_t>(42).put(far());
    bytes.text(values_).text(numbers_.str());
    bytes.put(static_cast<std::uint16_t>(entries_.size()));
    for (const Entry& e : entries_) bytes.put(e.tag).put(e.type).put(e.count).put(e.value);
    bytes.put<std::uint32_t>(0);
    return bytes.str();
  }

 private:
  struct Entry {
    std::uint16_t tag, type;
    std::uint32_t count, value;
  };
  static constexpr std::uint32_t kHead = 8;
  std::uint32_t far() const {
    return kHead + static_cast<std::uint32_t>(values_.size() + numbers_.size());
  }

  std::string values_;
  MadeBytes numbers_;  // what does not fit in an entry
  std::vector<Entry> entries_;
};

// NaN values become -9999, which the file states to be no data.
inline std::string tiff_bytes(const MadeRaster& made) {
  MadeBytes values;
  for (int row = 0; row < made.height; ++row)
    for (int column = 0; column < made.width; ++column) {
      const float z = made.height_at(made.left + (column + 0.5) * made.pixel,
                                     made.upper - (row + 0.5) * made.pixel);
      values.put(std::isnan(z) ? -9999.0f : z);
    }
  MadeTiff tiff(made.width, made.height, values.str());
  tiff.add(258, 32);
  tiff.add(259, 1);
  tiff.add(262, 1);
  tiff.add(277, 1);
  tiff.add(339, 3);
  if (made.placed) {
    tiff.add_doubles(33550, {made.pixel, made.pixel, 0});
    tiff.add_doubles(33922, {0, 0, 0, made.left, made.upper, 0});
  }
  tiff.add_system(made.system, made.geographic);
  tiff.add_text(42113, "-9999");
  return tiff.bytes();
}

inline std::string tiff_bytes(const MadePicture& made) {
  MadeBytes values;
  for (int row = 0; row < made.height; ++row)
    for (int column = 0; column < made.width; ++column)
      for (int band = 0; band < made.bands; ++band) {
        const int value = made.value_at(column, row, band);
        if (made.bits == 16)
          values.put(static_cast<std::uint16_t>(value));
        else
          values.put(static_cast<std::uint8_t>(value));
      }
  MadeTiff tiff(made.width, made.height, values.str());
  const auto bands = static_cast<std::uint16_t>(made.bands);
  tiff.add_shorts(258, std::vector<std::uint16_t>(bands, static_cast<std::uint16_t>(made.bits)));
  tiff.add(259, 1);
  tiff.add(262, made.bands < 3 ? 1 : 2);
  tiff.add(277, bands);
  if (made.opacity) tiff.add(338, 2);
  const auto& t = made.transform;
  tiff.add_doubles(34264, {t[1], t[2], 0, t[0], t[4], t[5], 0, t[3], 0, 0, 0, 0, 0, 0, 0, 1});
  tiff.add_system(made.system, made.geographic);
  if (!made.empty.empty()) tiff.add_text(42113, made.empty);
  return tiff.bytes();
}

// The heights of house_on_slope, and no data at its north-eastern corner.
inline float house_height(double x, double y) {
  if (x > 15 && y > 15) return std::numeric_limits<float>::quiet_NaN();
  const bool house = std::abs(x) < 4 && std::abs(y) < 3;
  const bool canopy = std::abs(x) < 4 && y <= -3 && y > -5;
  return static_cast<float>(house ? 5 : canopy ? 3 : slope_height(x));
}

}  // namespace lapwing
