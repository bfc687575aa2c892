// SPDX-License-Identifier: Apache-2.0
// The folder that a run leaves behind.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lapwing {

// The mission's name in lower case; every character but ASCII letters, digits and '-' becomes '_',
// a character of several bytes one '_'. Throws InputError when the name is empty or has more than
// 200 characters.
std::string run_folder_name(std::string_view mission);

// `base`/name, "out" by default.
std::filesystem::path run_folder(std::string_view mission,
                                 const std::filesystem::path& base = "out");

// Contents of the files; what is absent is not written, and a file of that name left by an earlier
// run is removed, so that a folder never mixes two runs.
struct RunFiles {
  std::optional<std::string> plan = {};           // plan.json
  std::optional<std::string> trajectory = {};     // trajectory.csv
  std::optional<std::string> report = {};         // report.html
  std::optional<std::string> report_data = {};    // report.json, as export/report_value.h says
  std::optional<std::string> log = {};            // run.log
  std::optional<std::string> map = {};            // map.ot
  std::optional<std::string> long_exposure = {};  // long_exposure.png
  // Meshes and maps that the plan names: obstacle_1.ply, obstacle_2.ot, ..., map.ot, prior.ply; and
  // the mesh of what a scan will show, prediction.ply and prediction.glb; and the
  // episode of an exploration, episode.json, episode_growth.bin and episode_sights.bin.
  std::vector<std::pair<std::string, std::string>> obstacles = {};
  std::optional<std::string> fleet = {};  // fleet.json
  // In place of plan and trajectory, of each tour of a fleet: plan_1.json, report_1.html,
  // trajectory_1.csv, plan_2.json, ...
  std::vector<std::pair<std::string, std::string>> tours = {};
};

// Whether runs give files of theirs this name: plan.json, obstacle_1.ply, ...
bool names_run_file(const std::string& name);

// The mission whose run a folder holds, as its run.log says; none where it holds no run.
std::optional<std::string> mission_in(const std::filesystem::path& folder);

// InputError where a folder holds files of a run's names that no run wrote: a run would replace
// them. Completes the files of a run that was ended over them (core/file_set.h).
void require_run_folder(const std::filesystem::path& folder);

// For who only reads a run's folder: completes such files, unless another process is writing there
// or what is there is not a run's. Then a sentence says so; else it is empty.
std::string complete_run_folder(const std::filesystem::path& folder);

// InputError where an older run's folder could not be renamed: it is named by its place alone
// ("."), or the folder that it lies in cannot be written.
void require_keepable(const std::filesystem::path& folder);

// Creates the folder and puts all files of a run into it at once, in place of an older run's: on
// any error, and after a kill, all of the old or all of the new ones are there. Other files stay.
// With `keep_old` an older run's folder becomes NAME.1, or the first number that is free, and that
// path is returned; else an empty one. A kill leaves a whole run under NAME, the old or the new
// one, where the file system can exchange folders (ext4, xfs, btrfs, tmpfs); elsewhere nothing
// bears the name for a moment. Throws InputError naming the path and the reason.
std::filesystem::path write_run_folder(const std::filesystem::path& folder, const RunFiles& files,
                                       bool keep_old = false);

}  // namespace lapwing
