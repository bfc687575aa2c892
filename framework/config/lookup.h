// SPDX-License-Identifier: Apache-2.0
// Finding configurations by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

struct ConfigSearch {
  std::vector<std::filesystem::path> folders;  // each searched in turn, links that leave it refused
  // Whether a path, as the command line may give one, is taken as well; a script may not.
  bool any_path = true;
};

// The file of configuration `name`: a path as typed, or "solvers/ipopt" in one of the folders; both
// with or without ".yaml". InputError, at `origin`, names the nearest configurations and the
// folders.
std::filesystem::path find_config(const std::string& name, const ConfigSearch& search,
                                  const Origin& origin = {});

// Finds and reads it. The root must be a map.
Value read_config(const std::string& name, const ConfigSearch& search, const Origin& origin = {});

}  // namespace lapwing
