// SPDX-License-Identifier: Apache-2.0
#include "framework/app/sweep_inputs.h"

#include <map>
#include <set>
#include <sstream>

#include "framework/config/read_note.h"
#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

constexpr const char* kInputs = "inputs.json";
constexpr std::size_t kLargest = std::size_t{4} << 30;  // bytes

// Runs read the same files: a large one is summed once, as long as it stays as it is.
std::string checksum_of_file(const fs::path& file) {
  struct Known {
    fs::file_time_type time;
    std::uintmax_t size;
    std::string sum;
  };
  static std::map<fs::path, Known> known;
  const auto time = fs::last_write_time(file);
  const auto size = fs::file_size(file);
  const auto found = known.find(file);
  if (found != known.end() && found->second.time == time && found->second.size == size)
    return found->second.sum;
  return (known[file] = {time, size, sha256(read_file(file, kLargest))}).sum;
}

// "" for what is not there or cannot be read.
std::string checksum_of(const fs::path& path) {
  try {
    if (fs::is_regular_file(path)) return checksum_of_file(path);
    if (!fs::is_directory(path)) return "";
    std::set<fs::path> files;
    for (const auto& item : fs::recursive_directory_iterator(path))
      if (item.is_regular_file()) files.insert(item.path());
    std::string all;
    for (const fs::path& file : files)
      all += file.lexically_relative(path).string() + " " + checksum_of_file(file) + "\n";
    return sha256(all);
  } catch (const InputError&) {
    return "";
  } catch (const fs::filesystem_error&) {
    return "";
  }
}

}  // namespace

void keep_inputs(const fs::path& run_folder) {
  std::error_code code;
  fs::remove(run_folder / kInputs, code);
  const fs::path log = run_folder / "run.log";
  if (!fs::is_regular_file(log, code)) return;
  Value sums = Value::map();
  for (const std::string& path : noted_reads(read_file(log))) {
    const std::string sum = checksum_of(path);
    if (sum.empty()) return;
    sums.set(path, sum);
  }
  write_file_atomically(run_folder / kInputs, to_json(sums) + "\n");
}

bool has_inputs(const fs::path& run_folder) {
  std::error_code code;
  return fs::is_regular_file(run_folder / kInputs, code);
}

std::string changed_input(const fs::path& run_folder) {
  const fs::path file = run_folder / kInputs;
  const Value sums = from_json(read_file(file), file.string());
  if (!sums.is_map()) throw InputError("'" + file.string() + "' is not a table of checksums");
  for (const auto& [path, sum] : sums.as_map())
    if (!sum.is_text() || checksum_of(path) != sum.as_text()) return path;
  return "";
}

}  // namespace lapwing
