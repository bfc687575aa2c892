// SPDX-License-Identifier: Apache-2.0
// What a run says and writes of one planned flight.
#pragma once

#include <string>
#include <vector>

#include "framework/app/command_line.h"
#include "framework/export/report.h"
#include "framework/export/run_folder.h"
#include "framework/mission/mission.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// Sentences for the user, with those that stand in no plan.
std::vector<std::string> told_notes(const MissionResult& result);
// With what was tried on the way: for the report, the log and --json.
std::vector<std::string> all_notes(const MissionResult& result);

// ok, not_certified, infeasible, failed, cancelled.
std::string status_of(const MissionResult& result, const Certificate& certificate, bool cancelled);
ExitStatus exit_status_of(const std::string& status);

// For --json: {"name", "status", "iterations", "cost", "terms"}.
Value solver_figures(const MissionResult& result);

// Puts the certificate and the notes into the plan.
void complete_plan(MissionResult& result, const Certificate& certificate,
                   const std::string& status);

// The report of the plan, once it is complete; `own` come behind its summary. `viewer`: in place of
// one of its pictures.
Report report_of(const MissionResult& result, const std::string& status, std::vector<Section> own,
                 std::optional<Viewer> viewer = std::nullopt);

// report.html and, where it was asked for, report.json.
void add_report(const Report& report, const Invocation& invocation, RunFiles& files);

// The files that the environment of the plan names.
void add_obstacles(const MissionResult& result, RunFiles& files);

}  // namespace lapwing
