// The environment as scripts state it.
#pragma once

#include "framework/core/parameters.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// {spheres = {{name, center, radius}}, boxes = {{name, lower, upper}},
//  zones = {{name, corners = {x1, y1, x2, y2, ...}, floor, ceiling}},
//  subjects = {{name, height, width, track = {{time, position}}}}, margin}
ParameterTable environment_table();

// Throws InputError for what contradicts itself: a box or zone without inside, corners that are no
// pairs, a track whose times do not rise, two subjects of one name.
Environment environment_of(const Parameters& given);

}  // namespace lapwing
