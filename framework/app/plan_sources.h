// SPDX-License-Identifier: Apache-2.0
// Where a plan's vehicle and obstacles come from: the file that it names, its own configuration, or
// files of whoever judges it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// The vehicle as its source states it; absent where there is nothing that it could be read from.
struct VehicleSource {
  std::string name;                // "configs/vehicles/solo.yaml", "the plan's configuration"
  std::optional<Vehicle> vehicle;  // as it is there
  std::string problem = {};        // what contradicts it in the plan's own configuration
};

// The vehicle that a plan says it flies: a file of `configs` that it names, or the table that its
// configuration holds. Files that a script had elsewhere are not looked for: a verdict must not
// depend on the folder that it is asked for in.
VehicleSource vehicle_source_of(const Plan& plan, const std::filesystem::path& configs);

// A vehicle file of whoever judges: a path, or a name in `configs`. InputError when there is none
// or it holds no vehicle.
VehicleSource read_vehicle_file(const std::filesystem::path& file,
                                const std::filesystem::path& configs);

// The plan with the obstacles of a YAML file in place of its own: spheres, boxes, zones,
// flight_zones as an environment has them, meshes and maps {name, file} (files beside it),
// obstacles {type, name, side, opaque, track, parameters} of the types that the verifier has
// distances of, and `margin`, if stated. Subjects, and the map that a scan's views see in, stay.
// Where the files are comes to `elsewhere`, by the names that the plan then has for them.
// InputError with all errors.
Plan with_environment(Plan plan, const std::filesystem::path& file,
                      std::map<std::string, std::filesystem::path>& elsewhere);

// What differs between two tables, a sentence each: "limits.speed_across is 20 in the plan and 10
// in configs/...". Numbers count as equal to twelve digits.
std::vector<std::string> differences(const Value& plan, const Value& source,
                                     const std::string& source_name);

}  // namespace lapwing
