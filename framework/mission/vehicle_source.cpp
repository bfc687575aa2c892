// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/vehicle_source.h"

#include "framework/config/lookup.h"

namespace lapwing {

Vehicle load_vehicle(const Value& source, const std::vector<std::filesystem::path>& folders) {
  ConfigSearch search;
  search.folders = folders;
  search.any_path = source.origin().source.starts_with("--set");
  Value given = source;
  std::string name = "vehicle";
  if (source.is_text()) {
    name = source.as_text();
    given = read_config(name, search, source.origin());
  } else if (!source.is_map()) {
    throw InputError(
        source.origin(),
        "vehicle: expected the name of a vehicle file or a table, got " + source.describe_type());
  }
  const Parameters vehicle = check(vehicle_table(), given);
  search.any_path = false;
  const Value camera_file = read_config(vehicle.text("camera"), search, vehicle.origin("camera"));
  return vehicle_from(vehicle, check(camera_table(), camera_file), name);
}

}  // namespace lapwing
