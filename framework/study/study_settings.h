// SPDX-License-Identifier: Apache-2.0
// The settings that a study was made with, as maps, and how two of them differ; names of files.
#pragma once

#include <string>

#include "framework/core/value.h"

namespace lapwing {

// A name as part of a file's: letters, digits, '-', '.', and '_' for all else.
std::string file_text(std::string name);

// "step 0.7, clear 2": a map of settings on one line.
std::string settings_text(const Value& settings);

// The first setting that differs, in words; empty where all agree. Of "files" only those that both
// name: other worlds and utilities may join. `moves` are those of every world that `world_moves`
// does not name.
std::string settings_difference(const Value& there, const Value& here);

}  // namespace lapwing
