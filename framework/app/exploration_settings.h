// What figures and samples of explorations were made with, as it is kept beside them.
#pragma once

#include "framework/app/exploration_worlds.h"

namespace lapwing {

// SHA-256 of the files that an exploration depends on: by world, and by utility its model (a
// parameter that names a file, else NAME.model beside its library). `parameters` are by utility.
Value checksums_of(const std::vector<WorldName>& worlds, const std::vector<std::string>& utilities,
                   const Value& parameters, const Registry& registry);

// The first setting that differs, in words; empty where all agree. Of "files" only those that both
// name: other worlds and utilities may join.
std::string settings_difference(const Value& there, const Value& here);

}  // namespace lapwing
