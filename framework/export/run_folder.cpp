#include "framework/export/run_folder.h"

#include <algorithm>
#include <system_error>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

constexpr std::size_t kLongestName = 200;  // most file systems allow 255 bytes

void remove_old(const std::filesystem::path& path) {
  std::error_code code;
  std::filesystem::remove(path, code);
  if (code) throw InputError(path.string() + ": cannot remove: " + code.message());
}

// obstacle_N.ply, obstacle_N.ot and prior.ply of an earlier run.
void remove_old_obstacles(const std::filesystem::path& folder) {
  std::error_code code;
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    const std::string ending = entry.path().extension().string();
    if ((name.starts_with("obstacle_") && (ending == ".ply" || ending == ".ot")) ||
        name == "prior.ply")
      old.push_back(entry.path());
  }
  for (const auto& path : old) remove_old(path);
}

}  // namespace

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

void write_run_folder(const std::filesystem::path& folder, const RunFiles& files) {
  const std::pair<const char*, const std::optional<std::string>&> all[] = {
      {"run.log", files.log},
      {"map.ot", files.map},
      {"long_exposure.png", files.long_exposure},
      {"report.html", files.report},
      {"trajectory.csv", files.trajectory},
      {"plan.json", files.plan}};
  // The old plan goes first: were the run to end here, no plan would vouch for files of another.
  remove_old(folder / "plan.json");
  remove_old_obstacles(folder);
  for (const auto& [name, contents] : files.obstacles)
    write_file_atomically(folder / name, contents);
  for (const auto& [name, contents] : all) {
    const bool just_written =
        std::any_of(files.obstacles.begin(), files.obstacles.end(),
                    [&name = name](const auto& written) { return written.first == name; });
    if (just_written) continue;
    if (contents) {
      write_file_atomically(folder / name, *contents);
    } else {
      remove_old(folder / name);
    }
  }
}

}  // namespace lapwing
