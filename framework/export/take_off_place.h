// SPDX-License-Identifier: Apache-2.0
// Where the flight of a file begins on the ground, from which heights in the file count.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/export/earth_frame.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// What exporters say of their parameter `home_z`.
inline constexpr const char* kHomeParameter =
    "z of the take-off place, world; absent: that of the plan's home, else the ground if the "
    "origin has height_of = ground, otherwise 0";

// m, world: `home_z` where somebody states it, else the plan's home, else the ground where the
// origin tells it, else 0.
double take_off_z(const Plan& plan, std::optional<double> home_z);

// m, world: the plan's home, at take_off_z; without one below `first`, the first place of the file.
Eigen::Vector3d take_off_place(const Plan& plan, std::optional<double> home_z,
                               const Eigen::Vector3d& first);

// A place of a file, for messages.
struct FilePlace {
  double time = 0;                                     // s of the plan
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
};

// Throws InputError beginning with `format` for a place that is not above the ground, where the
// origin tells where that is.
void require_above_ground(const std::vector<FilePlace>& places, const EarthFrame& frame,
                          const std::string& format);
// A sentence for the user on places below the take-off place; empty where there are none.
std::string below_take_off(const std::vector<FilePlace>& places, const EarthFrame& frame,
                           const EarthPoint& home);
// m above the take-off place, to a millimetre, as files have it.
double height_above(const EarthPoint& home, const EarthFrame& frame,
                    const Eigen::Vector3d& position);

}  // namespace lapwing
