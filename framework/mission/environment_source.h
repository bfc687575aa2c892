// SPDX-License-Identifier: Apache-2.0
// The environment as scripts state it.
#pragma once

#include "framework/core/parameters.h"
#include "framework/mission/run.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// {spheres = {{name, center, radius}}, boxes = {{name, lower, upper}},
//  zones = {{name, corners = {x1, y1, x2, y2, ...}, floor, ceiling}}, flight_zones = likewise,
//  meshes = {{name, file}}, maps = {{name, file, lower, upper, type}},
//  subjects = {{name, height, width, track = {{time, position}}}}, margin}
ParameterTable environment_table();

// What of it needs no file: spheres, boxes, zones, flight_zones.
ParameterTable shapes_table();
// Of parameters that were checked against a table with these. InputError as environment_of has it.
Environment shapes_of(const Parameters& given);

// Throws InputError for what contradicts itself: a box or zone without inside, corners that are no
// pairs, a track whose times do not rise, two subjects of one name; and for files of meshes and
// maps that the script may not read or that hold something else. The run keeps copies of them.
Environment environment_of(const Parameters& given, MissionRun& run);

}  // namespace lapwing
