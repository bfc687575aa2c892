// SPDX-License-Identifier: Apache-2.0
// Whether the coordinates of a mesh file can be what they are taken for: metres near the origin.
#pragma once

#include <string>

#include "framework/geometry/mesh_file.h"

namespace lapwing {

// Throws InputError, beginning with `name`, for a mesh that reaches beyond 1e5 m: with where it
// lies and, as its size tells, whether an offset or a unit is to blame.
void require_near(const MeshFile& file, const std::string& name);

// What is odd about a mesh that can be read, in one sentence with what to do about it; "" where
// nothing is:
//   - it lies more than 5 km from the origin, and five times its own size: coordinates of a grid of
//     the land;
//   - nobody stated its unit, and walls make up a fifth of it that stand more than 250 m tall and
//   no
//     less than a quarter of its width: a building in centimetres or millimetres. A site in metres
//     is wider or lower, a landscape has no walls;
//   - nobody stated its unit, and it is less than 0.3 m large.
std::string doubt_of(const MeshFile& file);

}  // namespace lapwing
