// SPDX-License-Identifier: Apache-2.0
#include "framework/core/folders.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/temporary_names.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw InputError("cannot write '" + folder.string() + "': " + why);
}

// Gone unless it was put in its place.
class NewFolder {
 public:
  explicit NewFolder(fs::path path) : path_(std::move(path)) {}
  ~NewFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

void write_folder_atomically(const fs::path& folder, const NamedContents& files) {
  fs::path target = folder.lexically_normal();
  if (target.filename().empty()) target = target.parent_path();
  if (target.filename().empty() || target.filename() == "." || target.filename() == "..") {
    refuse_folder(folder, "the path names no folder");
  }
  std::error_code code;
  const bool exists = fs::exists(fs::symlink_status(target, code));
  if (exists && (fs::is_symlink(target) || !fs::is_directory(target))) {
    refuse_folder(folder, "it exists and is not a folder");
  }
  if (exists) {
    for (const auto& item : fs::directory_iterator(target)) {
      const std::string name = item.path().filename().string();
      const bool ours = item.is_regular_file() &&
                        std::any_of(files.begin(), files.end(),
                                    [&](const auto& file) { return file.first == name; });
      if (!ours) refuse_folder(folder, "it holds '" + name + "', which would be lost");
    }
  }
  const fs::path parent = target.parent_path().empty() ? "." : target.parent_path();
  fs::create_directories(parent, code);
  if (code) refuse_folder(folder, code.message());
  clear_dead_temporaries(parent);
  const NewFolder made(parent / temporary_name(target.filename().string()));
  fs::create_directory(made.path(), code);
  if (code) refuse_folder(folder, code.message());
  for (const auto& [name, contents] : files) {
    if (name.empty() || fs::path(name).filename() != name) {
      throw Error("a file of a folder is named '" + name + "'");
    }
    write_file_atomically(made.path() / name, contents);
  }
  // Exchanged, the older one is what is removed at the end.
  const unsigned how = exists ? RENAME_EXCHANGE : RENAME_NOREPLACE;
  if (::renameat2(AT_FDCWD, made.path().c_str(), AT_FDCWD, target.c_str(), how) != 0) {
    refuse_folder(folder, std::strerror(errno));
  }
}

}  // namespace lapwing
