// SPDX-License-Identifier: Apache-2.0
// The working process of a studio: solves, checks, flies, pictures, writes.
//
// One program for all of them: a studio has one process that solves, one that checks edits, and one
// for errands, so that none waits for another. Frames (frames.h) come on standard input, answers
// leave on descriptor 3. Every request has `do` and a `serial`, every answer `said` and the serial:
//
//   solve {layer, settled}   answer {grade, message, seconds} [plan, certificate, document], world;
//                            of several batteries also {tours}, and of each of them three parts
//                            more (its plan and document empty where they are those of the first)
//                            of a drag of a scan: estimate {estimate: {} or {tours, images,
//                            seconds, known, seen}}
//                            of a scan: first_flight [JSON: level, images], before it is flown
//   drop                     the solve under way ends
//   begin_at                 the next solve begins at the flight of the plan in the first part
//   check {layer, judge}     checked {document, mission, files} or refused {why, line, files}
//   describe                 described {schema, choices}
//   fly {conditions}         done {...} [samples]        of the plan document in the first part
//   picture, export, export_lua, save_report             done {...}, or failed {why}
//   backdrop {file}          done [members of the message, picture]; without parts: as before
//   race, stick              done {files} [state]        a race that is flown by hand
//   voxel, slice, left_out, view {folder}   done {blobs} [members of the answer, blobs], or failed;
//                            also while a plan is solved (worker_looks.h)
//   voxel, slice {folder, image}   likewise, of an exploration; without a folder of the one that is
//                            being planned
//   voxel, slice {run, image}      likewise, of a run's folder, among errands
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/mission/mission_editor.h"

namespace lapwing {

// What was judged of a fleet.
struct FleetVerdict {
  std::vector<Certificate> tours;  // of each plan
  std::vector<std::string> texts;  // the bytes of their documents
  Certificate all;                 // of the fleet
};
using JudgeFleet =
    std::function<FleetVerdict(MissionResult& result, const CancellationToken& cancellation)>;

// Returns when standard input ends. `judge` makes the certificate of a plan, as `lapwing run` does.
//
// What is dragged is solved from the last point. A film that is `settled` is shown so as well, and
// is then planned by its script from the beginning: that plan alone is judged, so that it is the
// flight of `lapwing run`, whatever was drawn before.
// `program`: name and version, as the folders of runs state them.
void run_studio_worker(const std::filesystem::path& script, const MissionSettings& settings,
                       MissionEditor::Judge judge, JudgeFleet judge_fleet, std::string program);

}  // namespace lapwing
