// SPDX-License-Identifier: Apache-2.0
// Programs that read files in a process of their own, by libraries that would double the time that
// every command takes to start. Damaged files end that process alone. A program lies beside the
// library, where it was built.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lapwing {

struct ReaderProgram {
  std::string file;     // its name: "lapwing_raster"
  std::string library;  // that reads: "GDAL"
  std::string reads;    // "rasters"
  std::string package;  // of Debian, with which it is built: "libgdal-dev"

  std::filesystem::path path() const;
  bool is_installed() const;
};

// What the program prints when it is asked: the first word, the file, the other words. InputError,
// naming the file: the program is not there (with the package and the commands that cure it), no
// such file, or what the program says of it with exit status 2; a program that fails in another
// way, or is silent for two minutes, has met a damaged file.
std::string answer_of_program(const ReaderProgram& program, const std::filesystem::path& file,
                              const std::vector<std::string>& question);

}  // namespace lapwing
