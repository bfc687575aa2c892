// SPDX-License-Identifier: Apache-2.0
// What surrounds a flight, drawn: obstacles, zones and the outlines of meshes.
#pragma once

#include <filesystem>

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// Flight zones as their outlines, at floor and ceiling or, where one is missing, at the lowest and
// the highest of the path. Meshes as their sharp edges, from the files in `folder`; a mesh that
// cannot be read, or with more than 3000 such edges, is left out, and a map always is.
void add_surroundings(const Plan& plan, const std::filesystem::path& folder, Drawing& drawing);

}  // namespace lapwing
