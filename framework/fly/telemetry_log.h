// SPDX-License-Identifier: Apache-2.0
// A log of packets as ground stations write it (.tlog): for each packet its time in microseconds
// since 1970, 8 bytes, the most significant first, and then its bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

namespace lapwing {

class TelemetryLog {
 public:
  // A new file; none where there is one already, also one of a process that begins at the same
  // time. InputError where none can be made.
  static std::optional<TelemetryLog> begin(const std::filesystem::path& path);

  // On disk within a second of the log, so that a crash leaves what was before it.
  void write(std::uint64_t microseconds, std::string_view packet);

 private:
  explicit TelemetryLog(std::ofstream file) : file_(std::move(file)) {}

  std::ofstream file_;
  std::uint64_t flushed_at_ = 0;
};

}  // namespace lapwing
