// SPDX-License-Identifier: Apache-2.0
// The files that a script may read: those below the folders it is confined to.
//
// Names are relative to one of the folders, which are asked in order. Links are followed before the
// check, so that none leads out; "..", absolute names outside, folders and devices are refused.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/json.h"

namespace lapwing {

class DataFiles {
 public:
  explicit DataFiles(std::vector<std::filesystem::path> folders);

  // A file that the user named on the command line or in a configuration: allowed as it stands,
  // relative to the current folder.
  void allow(const std::filesystem::path& file);

  // The option whose value is the name of a file is blamed where that cannot be found. `options`
  // outlives this.
  void blame(const Value& options) { options_ = &options; }

  // `inside`: a sub-folder of the folders that is asked as well ("shots"). InputError says what was
  // looked for and where.
  std::filesystem::path find(const std::string& name, const std::string& inside = "") const;

  // A folder, found by the same rules.
  std::filesystem::path find_folder(const std::string& name) const;

  const std::vector<std::filesystem::path>& folders() const { return folders_; }

  // At most 64 MiB.
  std::string read_text(const std::string& name, const std::string& inside = "") const;
  // InputError with line and column for malformed or truncated text. `hold`: as of from_json.
  Value read_json(const std::string& name, const std::string& inside = "",
                  const HoldValues& hold = {}) const;

 private:
  std::filesystem::path find_entry(const std::string& name, const std::string& inside,
                                   bool folder) const;
  std::filesystem::path found(const std::string& name, const std::string& inside,
                              bool folder) const;

  std::vector<std::filesystem::path> folders_;
  std::vector<std::filesystem::path> allowed_;  // canonical
  const Value* options_ = nullptr;
};

}  // namespace lapwing
