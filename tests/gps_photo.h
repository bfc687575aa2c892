// SPDX-License-Identifier: Apache-2.0
// A photograph of a header alone, whose EXIF data state where it was taken.
#pragma once

#include <cmath>
#include <cstring>
#include <string>

#include "framework/geometry/geodetic.h"

namespace lapwing {

// Little-endian TIFF with a GPS directory, by the EXIF standard; north and east, above the sea.
inline std::string gps_photo(const GeodeticPoint& point) {
  const auto put16 = [](std::string& to, std::uint16_t v) {
    to.append(reinterpret_cast<const char*>(&v), 2);
  };
  const auto put32 = [](std::string& to, std::uint32_t v) {
    to.append(reinterpret_cast<const char*>(&v), 4);
  };
  const auto entry = [&](std::string& to, std::uint16_t tag, std::uint16_t type,
                         std::uint32_t count, std::uint32_t value) {
    put16(to, tag), put16(to, type), put32(to, count), put32(to, value);
  };
  constexpr std::uint32_t kData = 26 + 2 + 6 * 12 + 4;
  std::string tiff = std::string("II*\0", 4);
  put32(tiff, 8), put16(tiff, 1);
  entry(tiff, 0x8825, 4, 1, 26);
  put32(tiff, 0), put16(tiff, 6);
  entry(tiff, 1, 2, 2, 'N'), entry(tiff, 2, 5, 3, kData);
  entry(tiff, 3, 2, 2, 'E'), entry(tiff, 4, 5, 3, kData + 24);
  entry(tiff, 5, 1, 1, 0), entry(tiff, 6, 5, 1, kData + 48);
  put32(tiff, 0);
  const auto rational = [&](double value, std::uint32_t below) {
    put32(tiff, static_cast<std::uint32_t>(std::lround(value * below))), put32(tiff, below);
  };
  for (const double degrees : {point.latitude_deg, point.longitude_deg}) {
    const double whole = std::floor(degrees), minutes = std::floor(60 * (degrees - whole));
    rational(whole, 1), rational(minutes, 1);
    rational(60 * (60 * (degrees - whole) - minutes), 1'000'000);
  }
  rational(point.altitude, 1000);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const std::size_t length = body.size() + 2;
  return std::string("\xff\xd8\xff\xe1", 4) + static_cast<char>(length >> 8) +
         static_cast<char>(length & 255) + body + "\xff\xd9";
}

}  // namespace lapwing
