// SPDX-License-Identifier: Apache-2.0
// Instances of the orienteering problem, read from files: a tour problem whose score is a sum over
// views.
//
// TSPLIB-style (OPLib; TYPE: OP): NODE_COORD_SECTION or EDGE_WEIGHT_SECTION, NODE_SCORE_SECTION,
// DEPOT_SECTION with one depot, COST_LIMIT; distances are rounded as TSPLIB 95 says (EUC_2D,
// CEIL_2D, GEO, ATT, EXPLICIT as FULL_MATRIX, UPPER_ROW, LOWER_ROW, UPPER_DIAG_ROW,
// LOWER_DIAG_ROW). The tour is a loop from the depot. The plain format: a line `budget 1`, then
// lines `x y score`; from the first point to the second, by exact distances. Distances stand where
// a tour problem has seconds.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "framework/view/tour_problem.h"

namespace lapwing {

struct OrienteeringInstance {
  std::string name;  // from the file; "" in the plain format
  TourDefinition definition;
};

// InputError names the file, the line and what is wrong.
OrienteeringInstance read_orienteering(std::string_view text, const std::string& source);
OrienteeringInstance read_orienteering_file(const std::filesystem::path& path);

}  // namespace lapwing
