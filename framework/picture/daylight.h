// SPDX-License-Identifier: Apache-2.0
// What rendered pictures share: one sun, a sky, haze, and their size. Internal to this room.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace lapwing {

using Light = Eigen::Array3d;  // linear red, green, blue

inline constexpr double kHaze = 900;  // m, over which all but 1/e is lost

// The unit vector towards the sun.
const Eigen::Vector3d& towards_sun();

// What falls on a surface: `sun` is the share of sunlight that reaches it.
Light daylight(const Eigen::Vector3d& normal, double sun);
Light sky_light(const Eigen::Vector3d& direction);
// Light from `distance` metres away, through the haze.
Light through_haze(const Light& light, double distance);

double linear_light(double srgb);
// Linear light, 0 to 1 in 4096 steps, as a byte of sRGB.
std::uint8_t encoded_light(double light);

// Throws InputError for a picture without a pixel, or of more than 100 million.
void check_picture_size(int width, int height);

}  // namespace lapwing
