// SPDX-License-Identifier: Apache-2.0
// How a run of a mapping mission ends: there is a map instead of a plan.
#pragma once

#include "framework/app/command_line.h"
#include "framework/app/run_target.h"
#include "framework/core/log.h"
#include "framework/mission/mission.h"

namespace lapwing {

struct MappingOutcome {
  const MissionResult& result;  // with a mapping
  RunTarget& target;
  double seconds = 0;  // wall clock, all of it
};

// Writes map.ot, report.html and run.log, and prints the summary or the JSON object.
ExitStatus finish_mapping(const MappingOutcome& outcome, const Invocation& invocation,
                          const logging::Capture& capture);

}  // namespace lapwing
