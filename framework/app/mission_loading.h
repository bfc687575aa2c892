// SPDX-License-Identifier: Apache-2.0
// A mission as the command line asks for it: loaded, configured and checked, nothing solved.
#pragma once

#include <filesystem>

#include "framework/app/command_line.h"
#include "framework/mission/mission.h"

namespace lapwing {

struct ScanWork;
struct TourDefinition;

// Who looks on while a mission plans; each may be missing. What they throw ends the plan, and comes
// out of it.
struct MissionObservers {
  // The surface that a first flight looks at, which planning itself never sees.
  std::function<void(std::shared_ptr<const MeshScene>)> surface;
  // Every tour problem before it is solved.
  std::function<void(const ScanWork&, const TourDefinition&)> tour;
  bool steps = false;  // as MissionSettings::record_steps
};

// What missions are loaded with, limits and observers apart. InputError when a data folder is none.
// `registry` outlives the missions.
MissionSettings mission_settings(const Invocation& invocation, const Registry& registry);

// InputError when the file is something else than a script, and says what it is for.
void require_script(const std::filesystem::path& script);

// InputError when script, configurations, overrides or data folders are wrong. `registry`, and what
// `cancellation` and `progress` point to, outlive the mission.
std::unique_ptr<Mission> load_mission(const std::filesystem::path& script,
                                      const Invocation& invocation, const Registry& registry,
                                      const CancellationToken* cancellation = nullptr,
                                      Progress* progress = nullptr,
                                      std::function<void()> before_print = {},
                                      const MissionObservers& observers = {});

}  // namespace lapwing
