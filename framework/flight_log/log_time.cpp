// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_log/log_time.h"

#include <chrono>
#include <cmath>
#include <cstdio>

namespace lapwing {
namespace {

constexpr double kDay = 86400;               // s
constexpr double kYear10000 = 253402300800;  // s since 1970

}  // namespace

std::string utc_text(double seconds, int decimals) {
  const double scale = std::pow(10.0, decimals);
  const double rounded = std::round(seconds * scale) / scale;
  if (!(rounded >= 0) || rounded >= kYear10000) return "";
  const double day = std::floor(rounded / kDay), within = rounded - kDay * day;
  const std::chrono::year_month_day date{
      std::chrono::sys_days{std::chrono::days{static_cast<int>(day)}}};
  const int minutes = static_cast<int>(within / 60);
  const auto ticks = static_cast<long long>(std::llround((within - 60.0 * minutes) * scale));
  const auto whole = static_cast<long long>(scale);
  char text[64];
  int length =
      std::snprintf(text, sizeof text, "%04d-%02u-%02u %02d:%02d:%02lld",
                    static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                    static_cast<unsigned>(date.day()), minutes / 60, minutes % 60, ticks / whole);
  std::string said(text, static_cast<std::size_t>(length));
  if (decimals > 0) {
    length = std::snprintf(text, sizeof text, ".%0*lld", decimals, ticks % whole);
    said.append(text, static_cast<std::size_t>(length));
  }
  return said + " UTC";
}

std::string moment_in_words(const FlightLog& log, double time, int decimals) {
  const std::string utc = log.utc ? utc_text(*log.utc + time, decimals) : "";
  if (log.utc && *log.utc == 0 && !utc.empty()) return utc;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f s of the log", decimals, time);
  return utc.empty() ? text : std::string(text) + " (" + utc + ")";
}

}  // namespace lapwing
