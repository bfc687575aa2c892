// SPDX-License-Identifier: Apache-2.0
// What figures and samples of explorations were made with, as it is kept beside them.
#pragma once

#include "framework/app/exploration_worlds.h"

namespace lapwing {

// The moves of worlds whose scenes recommend others than the rest is explored by, by world.
struct WorldRecords {
  Value files = Value::map();
  Value moves = Value::map();  // by world: step, turn_deg, body, clear
};

// SHA-256 of what an exploration depends on: by world of its mesh file, or of the surface that its
// script makes; by utility of its library and its model (a parameter that names a file, else
// NAME.model beside it). `parameters` are by utility. InputError for a script that fails.
WorldRecords records_of(const std::vector<WorldName>& worlds,
                        const std::vector<std::string>& utilities, const Value& parameters,
                        const ExplorationSetup& setup, const Registry& registry,
                        const Invocation& invocation);

// The setup of one of the worlds.
ExplorationSetup setup_of(const ExplorationSetup& setup, const WorldRecords& records,
                          const std::string& world);

}  // namespace lapwing
