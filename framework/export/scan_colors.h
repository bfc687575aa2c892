// SPDX-License-Identifier: Apache-2.0
// Colours of the pictures of scans. Internal to the room.
#pragma once

#include <algorithm>

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

inline constexpr Rgb kPlainSurface = {176, 174, 168};
inline constexpr Rgb kNotSeen = {196, 70, 60}, kNeverSeen = {70, 70, 74};

// From dark violet over green to yellow (viridis, a few stops of it).
inline Rgb color_of_share(double share) {
  constexpr double kStops[5][3] = {
      {68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  const double at = std::clamp(share, 0.0, 1.0) * 4;
  const int k = std::min(3, static_cast<int>(at));
  Rgb color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] =
        static_cast<std::uint8_t>(kStops[k][c] + (at - k) * (kStops[k + 1][c] - kStops[k][c]));
  return color;
}

}  // namespace lapwing
