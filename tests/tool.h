// SPDX-License-Identifier: Apache-2.0
// Programs that a test calls. They are looked for when it runs, never when CMake configures: what
// is installed later counts, and a test without its tool is skipped with the package to install.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace lapwing {

// The first of the programs that PATH has, whole; "" where it has none.
inline std::string tool_on_path(const std::vector<std::string>& names) {
  const char* path = std::getenv("PATH");
  for (const std::string& name : names) {
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      const std::filesystem::path file = std::filesystem::path(folder) / name;
      std::error_code code;
      if (!folder.empty() && std::filesystem::is_regular_file(file, code) &&
          ::access(file.c_str(), X_OK) == 0)
        return file.string();
    }
  }
  return "";
}

}  // namespace lapwing
