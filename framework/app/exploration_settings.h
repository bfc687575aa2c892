// What figures and samples of explorations were made with, as it is kept beside them.
#pragma once

#include "framework/app/exploration_worlds.h"

namespace lapwing {

// SHA-256 of what an exploration depends on: by world of its mesh file, or of the surface that its
// script makes; by utility of its library and its model (a parameter that names a file, else
// NAME.model beside it). `parameters` are by utility. InputError for a script that fails.
Value checksums_of(const std::vector<WorldName>& worlds, const std::vector<std::string>& utilities,
                   const Value& parameters, const Registry& registry, const Invocation& invocation);

// The first setting that differs, in words; empty where all agree. Of "files" only those that both
// name: other worlds and utilities may join.
std::string settings_difference(const Value& there, const Value& here);

}  // namespace lapwing
