// SPDX-License-Identifier: Apache-2.0
// How a run of several batteries ends: there are several plans, and a fleet document over them.
#pragma once

#include "framework/app/command_line.h"
#include "framework/app/progress_line.h"
#include "framework/app/provenance.h"
#include "framework/app/run_target.h"
#include "framework/core/log.h"
#include "framework/mission/mission.h"

namespace lapwing {

struct FleetOutcome {
  MissionResult& result;  // with a fleet
  RunTarget& target;
  const CancellationToken& cancellation;
  ProgressLine& progress;
  double begin = 0;  // s, when the run began, by steady_seconds
};

// The tours of a fleet, judged one by one and together.
struct JudgedRun {
  std::vector<Certificate> certificates;  // of the plans
  std::vector<std::string> statuses;      // likewise
  std::vector<std::string> texts;         // the bytes of their files
  Certificate certificate;                // of the fleet
  std::string status;
};

// Completes the plans and the fleet document with what was judged. Cancelled when the judges are
// told to stop; `cancelled`: planning was.
JudgedRun judge_run(MissionResult& result, bool cancelled, const Judges& judges);

// Judges every plan and the fleet, writes plan_N.json, report_N.html and trajectory_N.csv of each
// tour, fleet.json, report.html and run.log, and prints the summary or the JSON object.
ExitStatus finish_fleet(const FleetOutcome& outcome, const Invocation& invocation,
                        const Registry& registry, const logging::Capture& capture);

}  // namespace lapwing
