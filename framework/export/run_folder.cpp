// SPDX-License-Identifier: Apache-2.0
#include "framework/export/run_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "framework/core/error.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/temporary_names.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 200;  // most file systems allow 255 bytes
constexpr int kMostKept = 10000;           // older runs beside one folder

// run.log first: a folder with it is known for a run's. The plan last.
constexpr const char* kRunFiles[] = {"run.log",     "map.ot",      "long_exposure.png",
                                     "report.html", "report.json", "trajectory.csv",
                                     "fleet.json",  "plan.json"};
constexpr std::string_view kMissionLine = "info: mission ";
constexpr std::string_view kSeed = ", seed ";

// Whether a name is the stem, a number and one of the endings.
bool is_numbered(const std::string& name, std::string_view stem,
                 std::initializer_list<std::string_view> endings) {
  if (!name.starts_with(stem)) return false;
  const std::size_t end = name.find_first_not_of("0123456789", stem.size());
  return end != std::string::npos && end > stem.size() &&
         std::find(endings.begin(), endings.end(), name.substr(end)) != endings.end();
}

// obstacle_12.ply, obstacle_1.ot, prior.ply, prediction.ply, prediction.glb; of an episode
bool names_obstacle(const std::string& name) {
  return name == "prior.ply" || name == "prediction.ply" || name == "prediction.glb" ||
         name == "episode.json" || name == "episode_growth.bin" || name == "episode_sights.bin" ||
         is_numbered(name, "obstacle_", {".ply", ".ot"});
}

// plan_1.json, report_12.html, trajectory_3.csv
bool names_tour(const std::string& name) {
  return is_numbered(name, "plan_", {".json"}) || is_numbered(name, "report_", {".html"}) ||
         is_numbered(name, "trajectory_", {".csv"});
}

// What of the folder bears names that runs give their files.
std::vector<std::string> run_files_in(const fs::path& folder) {
  std::vector<std::string> found;
  std::error_code code;
  for (fs::directory_iterator item(folder, code); !code && item != fs::directory_iterator();
       item.increment(code)) {
    const std::string name = item->path().filename().string();
    if (names_run_file(name)) found.push_back(name);
  }
  std::sort(found.begin(), found.end());
  return found;
}

FileSet set_of(const fs::path& folder, const RunFiles& files) {
  FileSet set{files.obstacles, run_files_in(folder), names_run_file};
  set.files.insert(set.files.end(), files.tours.begin(), files.tours.end());
  const std::optional<std::string>* contents[] = {
      &files.log,         &files.map,        &files.long_exposure, &files.report,
      &files.report_data, &files.trajectory, &files.fleet,         &files.plan};
  for (std::size_t i = 0; i < std::size(kRunFiles); ++i) {
    const bool listed =
        std::any_of(files.obstacles.begin(), files.obstacles.end(),
                    [&](const auto& written) { return written.first == kRunFiles[i]; });
    if (*contents[i] && !listed) set.files.emplace_back(kRunFiles[i], **contents[i]);
  }
  return set;
}

fs::path with_name(const fs::path& folder) {
  fs::path named = folder.lexically_normal();
  if (named.filename().empty()) named = named.parent_path();
  const std::string name = named.filename().string();
  if (name.empty() || name == "." || name == "..")
    throw InputError("'" + folder.string() +
                     "' cannot be kept under another name: its path has no name");
  return named;
}

fs::path free_name_beside(const fs::path& folder) {
  for (int k = 1; k <= kMostKept; ++k) {
    fs::path kept = folder;
    kept += "." + std::to_string(k);
    std::error_code code;
    if (!fs::exists(fs::symlink_status(kept, code))) return kept;
  }
  throw InputError("'" + folder.string() + "': too many older runs are kept beside it");
}

// What of Linux's renames a file system does.
enum class Renamed { done, unknown };

// `how`: RENAME_EXCHANGE, RENAME_NOREPLACE or 0.
Renamed rename_folder(const fs::path& from, const fs::path& to, unsigned how) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), how) == 0) return Renamed::done;
  if (how != 0 && (errno == EINVAL || errno == ENOSYS)) return Renamed::unknown;
  throw InputError("cannot rename '" + from.string() + "' to '" + to.string() +
                   "': " + std::strerror(errno));
}

// Where folders cannot be exchanged: for a moment nothing bears the folder's name. A kill then
// leaves the older set as NAME.1, and the new one as a temporary.
void take_place_by_turns(const fs::path& made, const fs::path& folder, const fs::path& kept) {
  rename_folder(folder, kept, 0);
  try {
    rename_folder(made, folder, 0);
  } catch (...) {
    rename_folder(kept, folder, 0);
    throw;
  }
}

// The new set gets the name that is free, then the two folders change places. A kill in between
// leaves the older set where it was, and the new one beside it.
void take_place(const fs::path& made, const fs::path& folder, const fs::path& kept) {
  if (rename_folder(made, kept, RENAME_NOREPLACE) == Renamed::unknown)
    return take_place_by_turns(made, folder, kept);
  Renamed exchanged = Renamed::unknown;
  try {
    exchanged = rename_folder(kept, folder, RENAME_EXCHANGE);
    if (exchanged == Renamed::unknown) rename_folder(kept, made, 0);
  } catch (...) {
    std::error_code ignored;
    fs::rename(kept, made, ignored);  // whoever made it removes it
    throw;
  }
  if (exchanged == Renamed::unknown) take_place_by_turns(made, folder, kept);
}

// The new files are written before the old folder is touched.
fs::path write_beside_old(const fs::path& given, const RunFiles& files) {
  const fs::path folder = with_name(given), kept = free_name_beside(folder);
  const fs::path made = folder.parent_path() / temporary_name(folder.filename().string());
  try {
    write_files_together(made, set_of(made, files));
    take_place(made, folder, kept);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(made, ignored);
    throw;
  }
  return kept;
}

}  // namespace

bool names_run_file(const std::string& name) {
  return names_obstacle(name) || names_tour(name) ||
         std::count(std::begin(kRunFiles), std::end(kRunFiles), name) > 0;
}

std::string run_folder_name(std::string_view mission) {
  std::string name;
  for (const char c : mission) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;  // not the first byte of a character
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    const bool upper = c >= 'A' && c <= 'Z';
    name += kept ? c : upper ? static_cast<char>(c - 'A' + 'a') : '_';
  }
  if (name.empty()) throw InputError("a mission needs a name");
  if (name.size() > kLongestName) {
    throw InputError("the mission's name has " + std::to_string(name.size()) +
                     " characters, at most " + std::to_string(kLongestName) + " can name a folder");
  }
  return name;
}

std::filesystem::path run_folder(std::string_view mission, const std::filesystem::path& base) {
  return base / run_folder_name(mission);
}

std::optional<std::string> mission_in(const std::filesystem::path& folder) {
  std::error_code code;
  const fs::path log = folder / "run.log";
  if (!fs::is_regular_file(log, code)) return std::nullopt;
  const std::string text = "\n" + read_file(log);
  const std::size_t line = text.find("\n" + std::string(kMissionLine));
  if (line == std::string::npos) return std::nullopt;
  const std::size_t from = line + 1 + kMissionLine.size();
  const std::string rest = text.substr(from, text.find('\n', from) - from);
  return rest.substr(0, rest.rfind(kSeed));
}

void require_run_folder(const std::filesystem::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) return;
  finish_exchange(folder, names_run_file);
  if (mission_in(folder)) return;
  const std::vector<std::string> found = run_files_in(folder);
  if (!found.empty())
    throw InputError("'" + folder.string() + "' holds '" + found.front() +
                     "', which no run wrote and which would be lost; choose another folder");
}

std::string complete_run_folder(const std::filesystem::path& folder) {
  return finish_exchange_to_read(folder, names_run_file);
}

void require_keepable(const std::filesystem::path& folder) {
  require_writable(with_name(folder).parent_path() / temporary_name("kept"));
}

std::filesystem::path write_run_folder(const std::filesystem::path& folder, const RunFiles& files,
                                       bool keep_old) {
  if (keep_old && !run_files_in(folder).empty()) return write_beside_old(folder, files);
  write_files_together(folder, set_of(folder, files));
  return {};
}

}  // namespace lapwing
