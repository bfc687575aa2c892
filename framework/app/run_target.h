// SPDX-License-Identifier: Apache-2.0
// The folder that a run writes: whose it is, and what is said of an older run in it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/app/command_line.h"
#include "framework/core/file_set.h"
#include "framework/export/run_folder.h"

namespace lapwing {

// Claimed while it lives: another run into the same folder is refused.
class RunTarget {
 public:
  // InputError where the folder cannot be written, is another run's at the moment, holds files that
  // no run wrote, or, unless it was named by --out, holds the run of another mission.
  RunTarget(const std::string& mission, const Invocation& invocation);

  const std::filesystem::path& folder() const { return folder_; }
  void write(const RunFiles& files);

  // "", "replaces the run that was there", "the run that was there is kept in 'out/shot.1'".
  std::string old_run_in_words() const;
  // Keys `replaced` and `kept`, where there was an older run.
  void add_to(Value& object) const;

 private:
  std::filesystem::path folder_, kept_;
  std::optional<FolderClaim> claim_;
  std::optional<std::string> old_;  // the mission whose run was there
  std::string mission_;
  bool keep_ = false;
};

}  // namespace lapwing
