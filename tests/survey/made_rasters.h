// SPDX-License-Identifier: Apache-2.0
// GeoTIFF files that tests make: one band of floats, one strip, without compression.
#pragma once

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

// NaN values become -9999, which the file states to be no data.
inline std::string tiff_bytes(const MadeRaster& made) {
  MadeBytes values;
  for (int row = 0; row < made.height; ++row)
    for (int column = 0; column < made.width; ++column) {
      const float z = made.height_at(made.left + (column + 0.5) * made.pixel,
                                     made.upper - (row + 0.5) * made.pixel);
      values.put(std::isnan(z) ? -9999.0f : z);
    }
  MadeBytes numbers;  // what does not fit in an entry
  struct Entry {
    std::uint16_t tag, type;
    std::uint32_t count, value;
  };
  constexpr std::uint16_t kAscii = 2, kShort = 3, kLong = 4, kDouble = 12;
  constexpr std::uint32_t kHead = 8;
  const auto far = [&] {
    return kHead + static_cast<std::uint32_t>(values.size() + numbers.size());
  };
  const auto size = static_cast<std::uint32_t>(values.size());
  std::vector<Entry> entries{{256, kShort, 1, static_cast<std::uint32_t>(made.width)},
                             {257, kShort, 1, static_cast<std::uint32_t>(made.height)},
                             {258, kShort, 1, 32},
                             {259, kShort, 1, 1},
                             {262, kShort, 1, 1},
                             {273, kLong, 1, kHead},
                             {277, kShort, 1, 1},
                             {278, kShort, 1, static_cast<std::uint32_t>(made.height)},
                             {279, kLong, 1, size},
                             {339, kShort, 1, 3}};
  if (made.placed) {
    entries.push_back({33550, kDouble, 3, far()});
    numbers.put(made.pixel).put(made.pixel).put(0.0);
    entries.push_back({33922, kDouble, 6, far()});
    numbers.put(0.0).put(0.0).put(0.0).put(made.left).put(made.upper).put(0.0);
  }
  if (made.system > 0) {
    const std::vector<std::uint16_t> keys{1,
                                          1,
                                          0,
                                          3,
                                          1024,
                                          0,
                                          1,
                                          static_cast<std::uint16_t>(made.geographic ? 2 : 1),
                                          1025,
                                          0,
                                          1,
                                          1,
                                          static_cast<std::uint16_t>(made.geographic ? 2048 : 3072),
                                          0,
                                          1,
                                          static_cast<std::uint16_t>(made.system)};
    entries.push_back({34735, kShort, static_cast<std::uint32_t>(keys.size()), far()});
    for (const std::uint16_t key : keys) numbers.put(key);
  }
  entries.push_back({42113, kAscii, 6, far()});
  numbers.text("-9999").put(char{0});
  MadeBytes bytes;
  bytes.text("II").put<std::uint16_t>(42).put(far());
  bytes.text(values.str()).text(numbers.str());
  bytes.put(static_cast<std::uint16_t>(entries.size()));
  for (const Entry& e : entries) bytes.put(e.tag).put(e.type).put(e.count).put(e.value);
  bytes.put<std::uint32_t>(0);
  return bytes.str();
}

// The heights of house_on_slope, and no data at its north-eastern corner.
inline float house_height(double x, double y) {
  if (x > 15 && y > 15) return std::numeric_limits<float>::quiet_NaN();
  const bool house = std::abs(x) < 4 && std::abs(y) < 3;
  const bool canopy = std::abs(x) < 4 && y <= -3 && y > -5;
  return static_cast<float>(house ? 5 : canopy ? 3 : slope_height(x));
}

}  // namespace lapwing
