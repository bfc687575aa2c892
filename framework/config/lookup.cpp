// SPDX-License-Identifier: Apache-2.0
#include "framework/config/lookup.h"

#include <algorithm>

#include "framework/config/read_note.h"
#include "framework/config/shipped.h"
#include "framework/config/yaml.h"
#include "framework/core/parameters.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

// `path` or `path`.yaml, whichever is a file; empty if neither is.
fs::path existing_file(const fs::path& path) {
  std::error_code code;
  if (fs::is_regular_file(path, code)) return path;
  fs::path with_extension = path;
  with_extension += ".yaml";
  return fs::is_regular_file(with_extension, code) ? with_extension : fs::path();
}

bool lies_within(const fs::path& file, const fs::path& folder) {
  std::error_code code;
  const fs::path inner = fs::canonical(file, code);
  const fs::path outer = fs::canonical(folder, code);
  if (code) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

bool climbs(const fs::path& path) {
  return path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
}

// "solvers/ipopt" for every file in the folders.
std::vector<std::string> known_names(const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  for (const fs::path& folder : folders) {
    std::error_code code;
    fs::recursive_directory_iterator it(folder, code);
    for (; !code && it != fs::recursive_directory_iterator(); it.increment(code)) {
      if (it->path().extension() != ".yaml") continue;
      names.push_back(it->path().lexically_relative(folder).replace_extension().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string not_found(const std::string& name, const ConfigSearch& search) {
  std::string stem = name;
  if (stem.ends_with(".yaml")) stem.resize(stem.size() - 5);
  const std::vector<std::string> known = known_names(search.folders);
  const fs::path wanted(stem);
  std::string nearest;
  std::string siblings;
  std::vector<std::string> sibling_names;  // a long folder must not make every name look near
  for (const std::string& candidate : known) {
    const fs::path path(candidate);
    if (path.filename() == wanted.filename()) nearest = candidate;  // right but for its folder
    if (path.parent_path() != wanted.parent_path()) continue;
    sibling_names.push_back(path.filename().string());
    siblings += (siblings.empty() ? "" : ", ") + candidate;
  }
  const std::string sibling = nearest_name(wanted.filename().string(), sibling_names);
  if (!sibling.empty()) nearest = (wanted.parent_path() / sibling).string();
  if (sibling_names.empty() && nearest.empty()) nearest = nearest_name(stem, known);
  std::string message = "no configuration '" + name + "'";
  if (!nearest.empty())
    message += "; did you mean '" + nearest + "'?";
  else if (!siblings.empty())
    message += "; known: " + siblings;
  message += "; searched";
  for (const fs::path& folder : search.folders) message += " '" + folder.string() + "'";
  if (search.folders.empty()) message += " no folder";
  return message;
}

}  // namespace

fs::path find_config(const std::string& name, const ConfigSearch& search, const Origin& origin) {
  if (name.empty()) throw InputError(origin, "the name of a configuration is empty");
  if (search.any_path) {
    const fs::path file = existing_file(name);
    if (!file.empty()) return file;
  } else if (climbs(name)) {
    throw InputError(origin, "configuration '" + name +
                                 "' must be a name inside the configuration folders, without '..'");
  }
  for (const fs::path& folder : search.folders) {
    if (climbs(name)) break;
    const fs::path file = existing_file(folder / name);
    if (file.empty()) continue;
    if (lies_within(file, folder)) return file;
    throw InputError(
        origin, "configuration '" + name + "' is a link that leaves '" + folder.string() + "'");
  }
  throw InputError(origin, not_found(name, search));
}

Value read_config(const std::string& name, const ConfigSearch& search, const Origin& origin) {
  const fs::path file = find_config(name, search, origin);
  if (!lies_within(file, shipped_folder("configs"))) note_read(file);
  Value value = read_yaml(file);
  if (!value.is_map()) {
    throw InputError(value.origin(), "expected keys and values, got " + value.describe_type());
  }
  return value;
}

}  // namespace lapwing
