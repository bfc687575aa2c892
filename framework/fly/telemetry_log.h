// SPDX-License-Identifier: Apache-2.0
// A log of packets as ground stations write it (.tlog): for each packet its time in microseconds
// since 1970, 8 bytes, the most significant first, and then its bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace lapwing {

class TelemetryLog {
 public:
  // A new file: InputError where there is one already, or where none can be made.
  explicit TelemetryLog(const std::filesystem::path& path);

  // On disk within a second of the log, so that a crash leaves what was before it.
  void write(std::uint64_t microseconds, std::string_view packet);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t flushed_at_ = 0;
};

}  // namespace lapwing
