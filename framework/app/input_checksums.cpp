// SPDX-License-Identifier: Apache-2.0
#include "framework/app/input_checksums.h"

#include <algorithm>
#include <map>
#include <regex>

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/library_path.h"

namespace lapwing {

namespace fs = std::filesystem;

std::string checksum_of_folder(const fs::path& folder, const std::set<std::string>& left_out) {
  std::set<fs::path> files;
  for (auto item = fs::recursive_directory_iterator(folder);
       item != fs::recursive_directory_iterator(); ++item) {
    if (item->is_directory() && left_out.contains(item->path().filename().string()))
      item.disable_recursion_pending();
    if (item->is_regular_file() && item->path().extension() != ".md") files.insert(item->path());
  }
  std::string all;
  for (const fs::path& file : files)
    all += file.lexically_relative(folder).string() + " " + sha256(read_file(file)) + "\n";
  return sha256(all);
}

void add_script_checksums(const fs::path& script, const fs::path& folder, Value& sums) {
  const std::string text = read_file(script);
  sums.set(script.lexically_relative(folder).string(), sha256(text));
  static const std::regex required("require\\s*\\(?\\s*[\"']([A-Za-z0-9_.]+)[\"']");
  for (std::sregex_iterator at(text.begin(), text.end(), required), end; at != end; ++at) {
    std::string name = (*at)[1];
    std::replace(name.begin(), name.end(), '.', '/');
    const fs::path module = folder / (name + ".lua");
    std::error_code code;
    if (fs::is_regular_file(module, code) && !sums.find(module.lexically_relative(folder).string()))
      add_script_checksums(module, folder, sums);
  }
}

Value plugin_checksums(const Registry& registry) {
  std::map<fs::path, std::string> sums;
  Value value = Value::map();
  for (const PluginEntry& entry : registry.entries()) {
    std::string& sum = sums[entry.library];
    if (sum.empty()) sum = sha256(read_file(entry.library));
    value.set(entry.kind + " " + entry.name, sum);
  }
  return value;
}

std::string program_checksum() {
  std::string all = sha256(read_file("/proc/self/exe"));
  if (const fs::path library = library_file(); !library.empty())
    all += " " + sha256(read_file(library));
  return sha256(all);
}

}  // namespace lapwing
