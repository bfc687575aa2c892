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
//  subjects = {{name, height, width, track = {{time, position}}}}, region = {lower, upper}, margin}
ParameterTable environment_table();

// What of it needs no file: spheres, boxes, zones, flight_zones.
ParameterTable shapes_table();
// Obstacles of parameters that were checked against a table with these, without their shapes.
std::vector<Obstacle> shapes_of(const Parameters& given);

// What every obstacle has beside the parameters of its plugin: name, side, opaque, track.
ParameterTable obstacle_table();
// An obstacle of a table {type, name, side, opaque, track, and the plugin's parameters}, without
// its shape; `what` stands in messages.
Obstacle obstacle_from(const Value& given, const std::string& what);

// Opens the shapes of obstacles that have none, by the plugins of their types, and records them.
// A type that the verifier has no distance of is recorded by its triangles. InputError as the
// plugins have it, and for what has no inside and is to be stayed in.
void open_shapes(Environment& environment, const Eigen::AlignedBox3d& region, MissionRun& run);
// The same for pictures of an environment that was read from a plan document whose files lie in
// `folder`; maps, which no picture of a path shows, stay closed.
void open_recorded_shapes(Environment& environment, const Registry& registry,
                          const std::filesystem::path& folder);

// `obstacles`: a list of tables as `obstacle_from` takes them, or null. Throws InputError for what
// contradicts itself: a track whose times do not rise, two subjects of one name; as `open_shapes`;
// and for files that the script may not read or that hold something else. The run keeps copies of
// them.
Environment environment_of(const Parameters& given, const Value& obstacles, MissionRun& run);

}  // namespace lapwing
