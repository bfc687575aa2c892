// SPDX-License-Identifier: Apache-2.0
#include "framework/app/run_target.h"

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {

RunTarget::RunTarget(const std::string& mission, const Invocation& invocation)
    : mission_(mission), keep_(invocation.keep) {
  const bool named = !invocation.out.empty();
  folder_ = named ? invocation.out : run_folder(mission);
  require_writable(folder_ / "plan.json");
  if (keep_) require_keepable(folder_);
  claim_.emplace(folder_);
  require_run_folder(folder_);
  old_ = mission_in(folder_);
  if (!named && old_ && *old_ != mission)
    throw InputError("'" + folder_.string() + "' contains the run of mission '" + *old_ +
                     "', whose name gives the same folder as '" + mission +
                     "'; name another folder with --out, or rename one of the two");
}

void RunTarget::write(const RunFiles& files) {
  kept_ = write_run_folder(folder_, files, keep_);
}

std::string RunTarget::old_run_in_words() const {
  if (!old_) return "";
  const std::string of = *old_ == mission_ ? "" : " of '" + *old_ + "'";
  if (!kept_.empty()) return "the run" + of + " that was there is kept in '" + kept_.string() + "'";
  return "replaces the run" + of + " in this folder; --keep keeps it";
}

void RunTarget::add_to(Value& object) const {
  if (!old_) return;
  if (kept_.empty())
    object.set("replaced", folder_.string());
  else
    object.set("kept", kept_.string());
}

}  // namespace lapwing
