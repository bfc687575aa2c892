// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/telemetry_log.h"

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

constexpr std::uint64_t kFlushEvery = 1'000'000;  // us

}  // namespace

std::optional<TelemetryLog> TelemetryLog::begin(const std::filesystem::path& path) {
  if (!create_file_atomically(path, "")) return std::nullopt;
  std::ofstream file(path, std::ios::binary);
  if (!file) throw InputError("cannot write '" + path.string() + "'");
  return TelemetryLog(std::move(file));
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
