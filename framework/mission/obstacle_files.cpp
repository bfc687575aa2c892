// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/obstacle_files.h"

#include <stdlib.h>

#include <algorithm>
#include <system_error>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {

namespace fs = std::filesystem;

struct ObstacleFiles::State {
  fs::path folder;
  std::vector<std::string> files;
  std::map<std::string, std::string> copies;  // their names, by ending and SHA-256
  std::map<std::string, std::shared_ptr<const Shape>> shapes;

  ~State() {
    std::error_code ignored;
    if (!folder.empty()) fs::remove_all(folder, ignored);
  }

  void make_folder() {
    if (folder.empty()) {
      std::string pattern = (fs::temp_directory_path() / "lapwing_obstacles_XXXXXX").string();
      if (!::mkdtemp(pattern.data()))
        throw InputError(pattern + ": cannot make a folder for copies of obstacles");
      folder = pattern;
    }
  }
};

ObstacleFiles::ObstacleFiles() : state_(std::make_unique<State>()) {}
ObstacleFiles::~ObstacleFiles() = default;
ObstacleFiles::ObstacleFiles(ObstacleFiles&&) noexcept = default;

std::shared_ptr<const Shape>& ObstacleFiles::shape(const std::string& key) {
  return state_->shapes[key];
}

std::string ObstacleFiles::keep(const std::string& name, const std::string& bytes) {
  state_->make_folder();
  write_file_atomically(state_->folder / name, bytes);
  if (std::find(state_->files.begin(), state_->files.end(), name) == state_->files.end())
    state_->files.push_back(name);
  return sha256(bytes);
}

KeptFile ObstacleFiles::keep_copy(const std::string& bytes, const std::string& ending) {
  const std::string hash = sha256(bytes);
  std::string& name = state_->copies[ending + hash];
  if (name.empty()) {
    name = "obstacle_" + std::to_string(state_->files.size() + 1) + ending;
    keep(name, bytes);
  }
  return {name, hash};
}

const fs::path& ObstacleFiles::folder() const {
  return state_->folder;
}
const std::vector<std::string>& ObstacleFiles::files() const {
  return state_->files;
}

}  // namespace lapwing
