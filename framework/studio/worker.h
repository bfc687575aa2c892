// SPDX-License-Identifier: Apache-2.0
// The working process of a studio: solves, checks, flies, pictures, writes.
//
// One program for all of them: a studio has one process that solves, one that checks edits, and one
// for errands, so that none waits for another. Frames (frames.h) come on standard input, answers
// leave on descriptor 3. Every request has `do` and a `serial`, every answer `said` and the serial:
//
//   solve {layer}            answer {grade, message, seconds} [plan, certificate, document], world
//   drop                     the solve under way ends
//   check {layer, judge}     checked {document, mission} or refused {why, line}
//   describe                 described {schema, choices}
//   fly {conditions}         done {...} [samples]        of the plan document in the first part
//   picture, export, export_lua, save_report             done {...}, or failed {why}
#pragma once

#include <filesystem>

#include "framework/mission/mission.h"

namespace lapwing {

// Returns when standard input ends.
void run_studio_worker(const std::filesystem::path& script, const MissionSettings& settings);

}  // namespace lapwing
