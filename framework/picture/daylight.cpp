// SPDX-License-Identifier: Apache-2.0
#include "framework/picture/daylight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "framework/core/error.h"

namespace lapwing {
namespace {

const Light kSunlight(1.0, 0.95, 0.86), kSkylight(0.42, 0.48, 0.58), kBounce(0.2, 0.19, 0.17);
const Light kZenith(0.13, 0.3, 0.62), kHorizon(0.68, 0.77, 0.86);

}  // namespace

const Eigen::Vector3d& towards_sun() {
  static const Eigen::Vector3d sun = Eigen::Vector3d(-0.45, -0.6, 0.9).normalized();
  return sun;
}

Light daylight(const Eigen::Vector3d& normal, double sun) {
  const double up = 0.5 + 0.5 * normal.z();
  return kBounce + up * (kSkylight - kBounce) +
         sun * std::max(normal.dot(towards_sun()), 0.0) * kSunlight;
}

Light sky_light(const Eigen::Vector3d& direction) {
  const double up = std::sqrt(std::max(direction.z(), 0.0));
  return kHorizon + up * (kZenith - kHorizon);
}

Light through_haze(const Light& light, double distance) {
  return kHorizon + std::exp(-distance / kHaze) * (light - kHorizon);
}

double linear_light(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

std::uint8_t encoded_light(double light) {
  static const auto table = [] {
    std::array<std::uint8_t, 4097> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const double v = static_cast<double>(i) / 4096;
      const double srgb = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
      bytes[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(srgb, 0.0, 1.0)));
    }
    return bytes;
  }();
  return table[static_cast<std::size_t>(4096 * std::clamp(light, 0.0, 1.0) + 0.5)];
}

void check_picture_size(int width, int height) {
  if (width < 1 || height < 1 || static_cast<double>(width) * height > 1e8) {
    throw InputError("a picture of " + std::to_string(width) + " by " + std::to_string(height) +
                     " pixels: expected at least one and at most 100 million");
  }
}

}  // namespace lapwing
