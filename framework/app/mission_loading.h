// A mission as the command line asks for it: loaded, configured and checked, nothing solved.
#pragma once

#include <filesystem>

#include "framework/app/command_line.h"
#include "framework/mission/mission.h"

namespace lapwing {

// InputError when script, configurations, overrides or data folders are wrong. `registry`, and what
// `cancellation` and `progress` point to, outlive the mission.
std::unique_ptr<Mission> load_mission(const std::filesystem::path& script,
                                      const Invocation& invocation, const Registry& registry,
                                      const CancellationToken* cancellation = nullptr,
                                      Progress* progress = nullptr,
                                      std::function<void()> before_print = {});

}  // namespace lapwing
