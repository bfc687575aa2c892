// SPDX-License-Identifier: Apache-2.0
// The environment of a flight as a space to plan ways in.
#pragma once

#include <memory>

#include "framework/path/free_space.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// Free where spheres, boxes, zones, meshes, maps and the faces of flight zones are farther than the
// environment's margin and `more` metres; subjects are no obstacles. Bodies that move are grown by
// half their diagonal; boxes at rest are judged to 0.15 m. Copies what it needs.
std::unique_ptr<FreeSpace> free_space_of(const Environment& environment, double more);

}  // namespace lapwing
