// The environment of a flight as a space to plan ways in.
#pragma once

#include <memory>

#include "framework/path/free_space.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// Free where spheres, boxes and zones are farther than the environment's margin and `more` metres;
// subjects are no obstacles. Bodies are grown by half their diagonal. Copies what it needs.
std::unique_ptr<FreeSpace> free_space_of(const Environment& environment, double more);

}  // namespace lapwing
