// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/data_files.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "framework/config/read_note.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = 64u << 20;  // bytes

bool lies_in(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

// The option that names a file.
struct NamedFile {
  std::string key;
  Origin origin;
};

std::optional<NamedFile> naming(const Value& options, const std::string& file,
                                const std::string& key = "") {
  if (options.is_text() && options.as_text() == file && !options.origin().source.empty() &&
      options.origin().source != "default")
    return NamedFile{key, options.origin()};
  if (options.is_map())
    for (const auto& [name, value] : options.as_map())
      if (auto found = naming(value, file, (key.empty() ? "" : key + ".") + name)) return found;
  if (options.is_list())
    for (std::size_t i = 0; i < options.as_list().size(); ++i)
      if (auto found = naming(options.as_list()[i], file, key + "[" + std::to_string(i + 1) + "]"))
        return found;
  return std::nullopt;
}

}  // namespace

DataFiles::DataFiles(std::vector<fs::path> folders) : folders_(std::move(folders)) {}

void DataFiles::allow(const fs::path& file) {
  std::error_code error;
  const fs::path canonical = fs::canonical(file, error);
  if (!error) allowed_.push_back(canonical);
}

fs::path DataFiles::found(const std::string& name, const std::string& inside, bool folder) const {
  try {
    return find_entry(name, inside, folder);
  } catch (const InputError& error) {
    const std::optional<NamedFile> option = options_ ? naming(*options_, name) : std::nullopt;
    if (!option) throw;
    throw InputError(option->origin, option->key + ": " + error.what());
  }
}

// Whoever finds a file reads it.
fs::path DataFiles::find(const std::string& name, const std::string& inside) const {
  const fs::path file = found(name, inside, false);
  note_read(file);
  return file;
}

fs::path DataFiles::find_folder(const std::string& name) const {
  const fs::path folder = found(name, "", true);
  note_read(folder);
  return folder;
}

fs::path DataFiles::find_entry(const std::string& name, const std::string& inside,
                               bool folder_wanted) const {
  if (name.empty() || name.find('\0') != std::string::npos) {
    throw InputError("a text that is empty or holds a NUL is not a file name");
  }
  const fs::path wanted(name);
  std::error_code error;
  const fs::path as_named = fs::canonical(wanted, error);
  if (!error && std::find(allowed_.begin(), allowed_.end(), as_named) != allowed_.end()) {
    if (folder_wanted == fs::is_directory(as_named, error)) return as_named;
    throw InputError("'" + name + "' is not a " + (folder_wanted ? "folder" : "regular file"));
  }
  for (const fs::path& part : wanted) {
    if (part == "..") {
      throw InputError("'" + name +
                       "': '..' is not allowed in the name of a data file; name its "
                       "folder with --data");
    }
  }
  std::string looked;
  for (const fs::path& folder : folders_) {
    const fs::path root = fs::canonical(folder, error);
    if (error) continue;
    std::vector<fs::path> candidates = {root / wanted};  // an absolute name replaces the root
    if (!inside.empty() && wanted.is_relative()) candidates.push_back(root / inside / wanted);
    for (const fs::path& candidate : candidates) {
      const fs::path file = fs::canonical(candidate, error);
      if (error) continue;
      if (lies_in(file, root)) {
        if (folder_wanted ? fs::is_directory(file, error) : fs::is_regular_file(file, error))
          return file;
        throw InputError("'" + name + "' is not a " + (folder_wanted ? "folder" : "regular file"));
      }
      if (wanted.is_relative()) {
        throw InputError("'" + name + "' leads out of " + folder.string());
      }
    }
    looked += (looked.empty() ? "" : ", ") + folder.string();
  }
  throw InputError("data " + std::string(folder_wanted ? "folder" : "file") + " '" + name +
                   "' not found in " + (looked.empty() ? "any folder" : looked) +
                   "; name its folder with --data DIR");
}

std::string DataFiles::read_text(const std::string& name, const std::string& inside) const {
  return read_file(find(name, inside), kLargestFile);
}

Value DataFiles::read_json(const std::string& name, const std::string& inside,
                           const HoldValues& hold) const {
  return from_json(read_text(name, inside), name, hold);
}

}  // namespace lapwing
