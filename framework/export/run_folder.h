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
  std::optional<std::string> log = {};            // run.log
  std::optional<std::string> map = {};            // map.ot
  std::optional<std::string> long_exposure = {};  // long_exposure.png
  // Meshes and maps that the plan names: obstacle_1.ply, obstacle_2.ot, ..., map.ot, prior.ply.
  std::vector<std::pair<std::string, std::string>> obstacles = {};
};

// Creates the folder and writes each file whole or not at all; plan.json last, so that a folder
// with a plan has everything else of the same run. Throws InputError naming the path and the
// reason.
void write_run_folder(const std::filesystem::path& folder, const RunFiles& files);

}  // namespace lapwing
