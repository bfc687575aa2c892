// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map_settings.h"

namespace lapwing {

ParameterTable map_parameters() {
  return ParameterTable{}
      .number("resolution", 0.2, "m", "edge of a voxel", between(0.001, 100))
      .choice("mode", "discretised", {"discretised", "exact"},
              "one ray per voxel that contains a point, or one per point")
      .number("hit", 0.7, "", "occupancy probability of a voxel with a measured point",
              between(0.501, 0.999))
      .number("miss", 0.4, "", "occupancy probability of a voxel that a ray passed",
              between(0.001, 0.499))
      .number("clamp_min", 0.1192, "", "lower clamp of the occupancy probability",
              between(0.001, 0.2))
      .number("clamp_max", 0.971, "", "upper clamp of the occupancy probability",
              between(0.8, 0.999))
      .number("free_below", 0.25, "", "a voxel with a lower probability is free", between(0.2, 0.5))
      .number("occupied_above", 0.75, "", "a voxel with a higher probability is occupied",
              between(0.5, 0.8))
      .optional_number("maximum_range", "m",
                       "range beyond which rays clear voxels and add no hit; absent: no limit",
                       above(0))
      .integer("pixel_step", 1, "use every n-th pixel of every n-th row of depth images",
               between(1, 64))
      .boolean("observations", false, "count the measurements of each voxel, for its uncertainty")
      .number("information", 0.5, "",
              "eta of (5.1): uncertainty is exp(-eta n) after n measurements", between(0.01, 10))
      .number("memory_limit", 4096, "", "largest memory of the map, MiB", between(16, 1048576));
}

MapSettings map_settings(const Parameters& parameters) {
  MapSettings settings;
  settings.resolution = parameters.number("resolution");
  settings.mode =
      parameters.text("mode") == "exact" ? IntegrationMode::exact : IntegrationMode::discretised;
  settings.hit = log_odds_of(parameters.number("hit"));
  settings.miss = log_odds_of(parameters.number("miss"));
  settings.clamp_min = log_odds_of(parameters.number("clamp_min"));
  settings.clamp_max = log_odds_of(parameters.number("clamp_max"));
  settings.free_below = log_odds_of(parameters.number("free_below"));
  settings.occupied_above = log_odds_of(parameters.number("occupied_above"));
  if (parameters.has("maximum_range")) settings.maximum_range = parameters.number("maximum_range");
  settings.pixel_step = static_cast<int>(parameters.integer("pixel_step"));
  settings.observations = parameters.boolean("observations");
  settings.information = parameters.number("information");
  settings.memory_limit = static_cast<std::size_t>(parameters.number("memory_limit")) << 20;
  Diagnostics errors;
  if (settings.clamp_min >= settings.free_below)
    errors.add(parameters.origin("clamp_min"), "clamp_min",
               "must be less than free_below, or no voxel can be free");
  if (settings.clamp_max <= settings.occupied_above)
    errors.add(parameters.origin("clamp_max"), "clamp_max",
               "must be more than occupied_above, or no voxel can be occupied");
  errors.throw_if_any();
  return settings;
}

}  // namespace lapwing
