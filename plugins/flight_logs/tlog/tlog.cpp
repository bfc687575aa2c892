// SPDX-License-Identifier: Apache-2.0
// Telemetry logs: packets of MAVLink with their times.
//
//   lapwing compare out/shot/plan.json flights/take_1.tlog
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/plugin.h"
#include "plugins/flight_logs/tlog/tlog_file.h"
#include "plugins/flight_logs/tlog/tlog_log.h"

namespace lapwing {
namespace {

class Tlog final : public FlightLogReader {
 public:
  static constexpr PluginText kText{
      "tlog", "1.0.0", "telemetry logs of lapwing fly and ground stations (.tlog)",
      "https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/mavlink.html"};
  static ParameterTable parameters() { return {}; }
  explicit Tlog(const Parameters&) {}

  bool recognizes(std::string_view bytes) const override { return tlog::is_tlog(bytes); }
  FlightLog read(std::string_view bytes) const override { return tlog::read(bytes); }
  std::string example() const override { return tlog::example(); }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Tlog)
