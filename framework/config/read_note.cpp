// SPDX-License-Identifier: Apache-2.0
#include "framework/config/read_note.h"

#include <system_error>

#include "framework/core/log.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kReads = "reads ";
constexpr std::string_view kDebug = "debug: ";

thread_local const std::function<void(const fs::path&)>* listener = nullptr;

}  // namespace

void note_read(const fs::path& path) {
  std::error_code code;
  const fs::path whole = fs::weakly_canonical(path, code);
  logging::debug(std::string(kReads) + (code ? path : whole).string());
  if (listener) (*listener)(code ? path : whole);
}

ReadListener::ReadListener(std::function<void(const fs::path&)> hear)
    : hear_(std::move(hear)), before_(listener) {
  listener = &hear_;
}

ReadListener::~ReadListener() {
  listener = before_;
}

std::set<std::string> noted_reads(std::string_view log) {
  std::set<std::string> paths;
  while (!log.empty()) {
    std::string_view line = log.substr(0, log.find('\n'));
    log.remove_prefix(std::min(log.size(), line.size() + 1));
    if (!line.starts_with(kDebug)) continue;
    line.remove_prefix(kDebug.size());
    if (line.starts_with(kReads)) paths.emplace(line.substr(kReads.size()));
  }
  return paths;
}

}  // namespace lapwing
