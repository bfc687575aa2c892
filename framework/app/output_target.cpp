// SPDX-License-Identifier: Apache-2.0
#include "framework/app/output_target.h"

#include <fstream>
#include <string>
#include <string_view>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/export/run_folder.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::string beginning_of(const fs::path& file) {
  constexpr std::size_t kEnough = 4096;  // bytes
  std::string text(kEnough, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

// What `lapwing annotations` wrote is no script of the user's.
bool is_script(const fs::path& file, std::string_view beginning) {
  return file.extension() == ".lua" && !beginning.starts_with("---@meta");
}

bool is_plan(std::string_view beginning) {
  return beginning.starts_with("{") && beginning.find("\"format\":") != beginning.npos &&
         beginning.find("\"mission\":") != beginning.npos;
}

}  // namespace

void require_output(const fs::path& target, const std::vector<fs::path>& inputs) {
  const auto refuse = [&](const std::string& why) {
    throw InputError("'" + target.string() + "' " + why + "; give -o another name");
  };
  std::error_code code;
  for (const fs::path& input : inputs)
    if (fs::equivalent(input, target, code)) refuse("is read by this command");
  if (fs::is_regular_file(target, code)) {
    const std::string beginning = beginning_of(target);
    if (is_script(target, beginning)) refuse("is a script");
    if (is_plan(beginning)) refuse("is a plan");
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (names_run_file(target.filename().string()) && mission_in(folder))
      refuse("belongs to the run in '" + folder.string() + "'");
  }
  if (!fs::is_directory(target, code)) require_writable(target);
}

}  // namespace lapwing
