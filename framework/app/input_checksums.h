// SPDX-License-Identifier: Apache-2.0
// SHA-256 of what a command's results depend on, so that a later one can tell whether it is the
// same.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "framework/core/value.h"
#include "framework/plugin/registry.h"

namespace lapwing {

// Of a folder's files and their names, without documents (`.md`), which no result depends on;
// `left_out` are names of folders in it.
std::string checksum_of_folder(const std::filesystem::path& folder,
                               const std::set<std::string>& left_out = {});

// Sets the checksum of the script, and of its own modules as far as their names are written out,
// under their paths relative to `folder`, where they lie.
void add_script_checksums(const std::filesystem::path& script, const std::filesystem::path& folder,
                          Value& sums);

// Of the libraries that a command may load, by kind and name.
Value plugin_checksums(const Registry& registry);

// Of this program: its executable and liblapwing.
std::string program_checksum();

}  // namespace lapwing
