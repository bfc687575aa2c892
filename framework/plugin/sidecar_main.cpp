// SPDX-License-Identifier: Apache-2.0
// lapwing_sidecar LIBRARY OUT.json: writes a plugin library's sidecar. Run by the build.
#include <cstdio>
#include <exception>

#include "framework/core/files.h"
#include "framework/plugin/registry.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: lapwing_sidecar LIBRARY OUT.json\n");
    return 2;
  }
  try {
    lapwing::write_file_atomically(argv[2], lapwing::describe_library(argv[1]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lapwing_sidecar: %s\n", error.what());
    return 2;
  }
  return 0;
}
