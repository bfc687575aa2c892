// SPDX-License-Identifier: Apache-2.0
// What files look like without reading them, so that changes on disk are seen.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <string>

namespace lapwing {

// Changes with the file, or with the list of a folder's entries; "" where there is none.
inline std::string look_of(const std::filesystem::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return "";
  return std::to_string(found.st_ino) + " " + std::to_string(found.st_size) + " " +
         std::to_string(found.st_mtim.tv_sec) + "." + std::to_string(found.st_mtim.tv_nsec);
}

template <class Files>
std::string looks_of(const Files& files) {
  std::string looks;
  for (const std::filesystem::path& file : files) looks += "\n" + look_of(file);
  return looks;
}

}  // namespace lapwing
