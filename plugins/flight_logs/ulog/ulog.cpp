// SPDX-License-Identifier: Apache-2.0
// Logs of PX4: ULog.
//
//   lapwing compare out/hello/plan.json flight.ulg
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/plugin.h"
#include "plugins/flight_logs/ulog/ulog_file.h"
#include "plugins/flight_logs/ulog/ulog_log.h"

namespace lapwing {
namespace {

class Ulog final : public FlightLogReader {
 public:
  static constexpr PluginText kText{"ulog", "1.0.0", "logs of PX4 (.ulg)",
                                    "https://docs.px4.io/main/en/dev_log/ulog_file_format.html"};
  static ParameterTable parameters() { return {}; }
  explicit Ulog(const Parameters&) {}

  bool recognizes(std::string_view bytes) const override { return ulog::is_ulog(bytes); }
  FlightLog read(std::string_view bytes) const override { return ulog::read(bytes); }
  std::string example() const override { return ulog::example(); }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Ulog)
