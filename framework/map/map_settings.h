// SPDX-License-Identifier: Apache-2.0
// What every map is told when it is made, whichever backend holds it.
#pragma once

#include <cstddef>
#include <limits>

#include "framework/core/parameters.h"
#include "framework/map/voxel.h"

namespace lapwing {

// How a scan becomes rays (reading 2.3): one for every point, or one for every voxel that holds a
// point, towards its centre.
enum class IntegrationMode { exact, discretised };

struct MapSettings {
  double resolution = 0.2;  // m, edge of a voxel
  IntegrationMode mode = IntegrationMode::discretised;
  float hit = 0, miss = 0;             // log odds that a measurement adds
  float clamp_min = 0, clamp_max = 0;  // log odds
  float free_below = 0;                // log odds; free is less
  float occupied_above = 0;            // log odds; occupied is more
  double maximum_range = std::numeric_limits<double>::infinity();  // m
  int pixel_step = 1;         // of depth images, every n-th pixel of every n-th row
  bool observations = false;  // count how often each voxel was measured
  double information = 0.5;   // eta of (5.1)
  std::size_t memory_limit = std::size_t{4096} << 20;  // bytes

  VoxelState state(float log_odds) const {
    return log_odds < free_below       ? VoxelState::free
           : log_odds > occupied_above ? VoxelState::occupied
                                       : VoxelState::unknown;
  }
};

// The parameters of every plugin of kind `map`.
ParameterTable map_parameters();

// InputError naming the parameters that contradict each other: a clamp that keeps voxels from ever
// being free or occupied.
MapSettings map_settings(const Parameters& parameters);

}  // namespace lapwing
