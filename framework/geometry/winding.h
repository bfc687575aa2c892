// SPDX-License-Identifier: Apache-2.0
// Inside and outside of a closed surface.
#pragma once

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

// How often a closed surface winds about a point: 1 inside of one that is counter-clockwise as seen
// from outside, 0 outside. The sum of the solid angles of all triangles over 4 pi (Van Oosterom and
// Strackee 1983). No edge or corner is an exception.
double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& p_W);

}  // namespace lapwing
