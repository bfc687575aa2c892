// SPDX-License-Identifier: Apache-2.0
// Where plugins are looked for.

#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/library_path.h"
#include "framework/core/log.h"
#include "framework/plugin/registry.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

void add_from_environment(std::vector<fs::path>& folders) {
  std::string list = environment("LAPWING_PLUGIN_PATH");
  while (!list.empty()) {
    const std::size_t end = list.find(':');
    const std::string folder = list.substr(0, end);
    list = end == list.npos ? "" : list.substr(end + 1);
    if (folder.empty()) continue;
    if (!fs::is_directory(folder)) {
      logging::warning("LAPWING_PLUGIN_PATH names '" + folder + "', which is not a folder");
    }
    folders.push_back(folder);
  }
}

void add_from_user(std::vector<fs::path>& folders) {
  fs::path data = environment("XDG_DATA_HOME");
  const std::string home = environment("HOME");
  // The XDG rule: a relative path is invalid and counts as unset.
  if (!data.is_absolute()) data = home.empty() ? fs::path() : fs::path(home) / ".local" / "share";
  if (!data.empty()) folders.push_back(data / "lapwing" / "plugins");
}

// An install keeps plugins apart from other projects' libraries, in <libdir>/lapwing/plugins.
void add_from_tree(std::vector<fs::path>& folders) {
  const fs::path folder = library_folder();
  if (folder.empty()) return;
  std::error_code code;
  const fs::path installed = folder / "lapwing" / "plugins";
  folders.push_back(fs::is_directory(installed, code) ? installed : folder / "plugins");
}

}  // namespace

std::vector<fs::path> plugin_search_path(const std::vector<fs::path>& from_command_line) {
  std::vector<fs::path> folders;
  for (const fs::path& folder : from_command_line) {
    std::error_code code;
    if (!fs::is_directory(folder, code)) {
      throw InputError("--plugin-path: '" + folder.string() + "' is not a folder");
    }
    folders.push_back(folder);
  }
  add_from_environment(folders);
  add_from_user(folders);
  add_from_tree(folders);
  return folders;
}

}  // namespace lapwing
