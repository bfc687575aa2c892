// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/telemetry_log.h"

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr std::uint64_t kFlushEvery = 1'000'000;  // us

}  // namespace

TelemetryLog::TelemetryLog(const std::filesystem::path& path) : path_(path) {
  if (std::filesystem::exists(path))
    throw InputError("'" + path.string() +
                     "' is there already; the log of a flight is not replaced");
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  file_.open(path, std::ios::binary);
  if (!file_) throw InputError("cannot write '" + path.string() + "'");
}

void TelemetryLog::write(std::uint64_t microseconds, std::string_view packet) {
  char stamp[8];
  for (int i = 0; i < 8; ++i) stamp[i] = static_cast<char>(microseconds >> (56 - 8 * i) & 0xff);
  file_.write(stamp, sizeof stamp);
  file_.write(packet.data(), static_cast<std::streamsize>(packet.size()));
  if (microseconds - flushed_at_ < kFlushEvery) return;
  flushed_at_ = microseconds;
  file_.flush();
}

}  // namespace lapwing
