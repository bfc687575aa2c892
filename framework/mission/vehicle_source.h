// SPDX-License-Identifier: Apache-2.0
// A vehicle from what a mission says of it: the name of a vehicle file, or its contents.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/core/value.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// `source`: a text such as "vehicles/solo", looked up in `folders` (any path, where the user typed
// it on the command line), or a map with the keys of a vehicle file. The camera file that it names
// is looked up likewise. InputError as config and vehicle_from have them.
Vehicle load_vehicle(const Value& source, const std::vector<std::filesystem::path>& folders);

}  // namespace lapwing
