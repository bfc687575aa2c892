// SPDX-License-Identifier: Apache-2.0
// Tracks of GPX files.
//
//   lapwing compare out/hello/plan.json track.gpx
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/plugin.h"
#include "plugins/flight_logs/gpx/gpx_log.h"

namespace lapwing {
namespace {

class Gpx final : public FlightLogReader {
 public:
  static constexpr PluginText kText{"gpx", "1.0.0", "tracks of receivers and map programs (.gpx)",
                                    "https://www.topografix.com/GPX/1/1/"};
  static ParameterTable parameters() {
    return ParameterTable{}.number("rate", 0, "1/s",
                                   "points per second of a track without times; 0: it is refused",
                                   between(0, 1000));
  }
  explicit Gpx(const Parameters& parameters) : rate_(parameters.number("rate")) {}

  bool recognizes(std::string_view bytes) const override { return gpx_log::recognizes(bytes); }
  FlightLog read(std::string_view bytes) const override { return gpx_log::read(bytes, rate_); }

  std::string example() const override {
    std::string text =
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"example\"><trk><trkseg>\n";
    for (int k = 0; k <= 4; ++k)
      text += "<trkpt lat=\"46.51910" + std::to_string(k) + "\" lon=\"6.5668\"><ele>" +
              std::to_string(400 + k) + "</ele><time>2024-05-12T09:30:0" + std::to_string(k) +
              "Z</time></trkpt>\n";
    return text + "</trkseg></trk></gpx>\n";
  }

 private:
  double rate_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Gpx)
