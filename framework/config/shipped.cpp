// SPDX-License-Identifier: Apache-2.0
#include "framework/config/shipped.h"

#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/library_path.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

bool holds_shipped_files(const fs::path& folder) {
  std::error_code code;
  return fs::is_directory(folder / "configs", code) || fs::is_directory(folder / "scripts", code);
}

}  // namespace

fs::path shipped_root() {
  if (const char* home = std::getenv("LAPWING_HOME"); home && *home) {
    if (holds_shipped_files(home)) return home;
    throw InputError(std::string("LAPWING_HOME is '") + home +
                     "', which has neither configs/ nor scripts/");
  }
  // <prefix>/lib/liblapwing.so, or one folder deeper: <prefix>/lib/x86_64-linux-gnu.
  fs::path prefix = library_folder();
  for (int up = 0; up < 2 && !prefix.empty(); ++up) {
    prefix = prefix.parent_path();
    const fs::path shared = prefix / "share" / "lapwing";
    if (holds_shipped_files(shared)) return shared;
  }
  if (holds_shipped_files(LAPWING_SOURCE_ROOT)) return LAPWING_SOURCE_ROOT;
  throw InputError(
      "the folders configs/ and scripts/ of Lapwing were not found; name the folder that holds "
      "them in the environment variable LAPWING_HOME");
}

fs::path shipped_folder(const std::string& name) {
  const fs::path folder = shipped_root() / name;
  if (fs::is_directory(folder)) return folder;
  throw InputError("'" + folder.string() +
                   "' is missing; LAPWING_HOME may name another folder that has " + name + "/");
}

}  // namespace lapwing
