// SPDX-License-Identifier: Apache-2.0
// Logs of ArduPilot: DataFlash.
//
//   lapwing compare out/hello/plan.json 00000042.BIN
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/plugin.h"
#include "plugins/flight_logs/dataflash/dataflash_file.h"
#include "plugins/flight_logs/dataflash/dataflash_log.h"

namespace lapwing {
namespace {

class Dataflash final : public FlightLogReader {
 public:
  static constexpr PluginText kText{"dataflash", "1.0.0", "logs of ArduPilot (.bin)",
                                    "https://ardupilot.org/copter/docs/logmessages.html"};
  static ParameterTable parameters() { return {}; }
  explicit Dataflash(const Parameters&) {}

  bool recognizes(std::string_view bytes) const override { return dataflash::is_dataflash(bytes); }
  FlightLog read(std::string_view bytes) const override { return dataflash::read(bytes); }
  std::string example() const override { return dataflash::example(); }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Dataflash)
