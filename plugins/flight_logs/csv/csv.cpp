// SPDX-License-Identifier: Apache-2.0
// Flight records as comma-separated values.
//
//   lapwing compare out/hello/plan.json record.csv --format csv:heights=sea
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/plugin.h"
#include "plugins/flight_logs/csv/csv_log.h"

namespace lapwing {
namespace {

class Csv final : public FlightLogReader {
 public:
  static constexpr PluginText kText{
      "csv", "1.0.0", "flight records as text: Lapwing, Airdata, Litchi, DJI, DatCon (.csv)",
      "own"};
  static ParameterTable parameters() {
    return ParameterTable{}.choice("heights", "take_off", {"take_off", "sea"},
                                   "which heights are read, where a record has both");
  }
  explicit Csv(const Parameters& parameters) : from_sea_(parameters.text("heights") == "sea") {}

  bool recognizes(std::string_view bytes) const override { return csv_log::recognizes(bytes); }
  FlightLog read(std::string_view bytes) const override { return csv_log::read(bytes, from_sea_); }

  std::string example() const override {
    std::string text =
        "time(millisecond),datetime(utc),latitude,longitude,height_above_takeoff(meters)\n";
    for (int k = 0; k <= 10; ++k)
      text += std::to_string(100 * k) + ",2024-05-12 09:30:0" + std::to_string(k / 10) +
              ",46.51910" + std::to_string(k % 10) + ",6.5668,10." + std::to_string(k % 10) + "\n";
    return text;
  }

 private:
  bool from_sea_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Csv)
