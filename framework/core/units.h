// SPDX-License-Identifier: Apache-2.0
// Units. Inside, everything is SI and radians; degrees live at the edges, and then in the name.
#pragma once

#include <numbers>
#include <optional>
#include <string_view>

namespace lapwing {

inline constexpr double kGravity = 9.80665;  // m/s^2, standard gravity

constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}
constexpr double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

// Reads "36 km/h", "250 ms", "2.5", "-90 deg" into `unit`. No unit in the text means `unit` itself.
// Empty when the text is no number or names a unit of another dimension.
std::optional<double> parse_quantity(std::string_view text, std::string_view unit);

}  // namespace lapwing
