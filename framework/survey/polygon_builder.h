// SPDX-License-Identifier: Apache-2.0
// What the readers of polygon files share. Internal to this room.
#pragma once

#include <string>
#include <vector>

#include "framework/survey/polygon_file.h"

namespace lapwing {

// A ring as files have it: the last corner is the first one again. It is left out. InputError,
// beginning with `place`, otherwise, and for fewer than three corners.
std::vector<Eigen::Vector2d> open_ring(std::vector<Eigen::Vector2d> ring, const std::string& place);

// Sets `from`, `to` or `weight` of a polygon from a property of that name, or floor and ceiling.
// False for another name. InputError where it is set already.
bool set_property(SurveyPolygon& polygon, const std::string& key, double number);
// Whether a property of that name is one of these.
bool is_polygon_property(const std::string& key);

// "it has heights in its coordinates (12 m at its corner 3), which could be above ...".
[[noreturn]] void refuse_heights(const std::string& place, double height, std::size_t corner,
                                 const std::string& above);

// Of a file that has been read: throws where nothing was found.
void require_polygons(const PolygonFile& file, const std::string& named, const std::string& what,
                      const std::vector<std::string>& names);

}  // namespace lapwing
