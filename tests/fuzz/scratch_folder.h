// SPDX-License-Identifier: Apache-2.0
// A folder for readers that want files, in memory where the system has such a place.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace lapwing {

inline const std::filesystem::path& scratch_folder() {
  static const std::filesystem::path folder = [] {
    namespace fs = std::filesystem;
    const fs::path parent =
        fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    const fs::path made = parent / ("lapwing_fuzz_" + std::to_string(::getpid()));
    fs::create_directories(made);
    std::atexit([] { fs::remove_all(scratch_folder()); });
    return made;
  }();
  return folder;
}

}  // namespace lapwing
