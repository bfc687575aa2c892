// SPDX-License-Identifier: Apache-2.0
// Where a photograph says that it was taken.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/geometry/geodetic.h"

namespace lapwing {

struct PhotoPosition {
  std::string name;  // of the file
  // Its altitude is above what the camera means: the sea by the standard (EXIF 2.3, table 15), the
  // ellipsoid or the place of take-off in many drones.
  GeodeticPoint point;
};

// Whether this build reads positions (libexif).
bool reads_exif();

// The position in a JPEG; nothing where it states none, or no altitude. InputError naming the file
// that cannot be read or whose position is out of range, and, in a build without libexif, saying
// how to get it.
std::optional<PhotoPosition> exif_position(const std::filesystem::path& file);

// Of all JPEGs of a folder (.jpg, .jpeg in either case), in the order of their names; `without`
// counts those that state none.
std::vector<PhotoPosition> exif_positions(const std::filesystem::path& folder,
                                          std::size_t& without);

}  // namespace lapwing
