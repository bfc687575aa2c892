// SPDX-License-Identifier: Apache-2.0
// Recordings of Foxglove and robotics tools.
//
//   lapwing compare out/hello/plan.json flight.mcap --format mcap:vehicle=base_link
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/plugin.h"
#include "plugins/flight_logs/mcap/mcap_file.h"
#include "plugins/flight_logs/mcap/mcap_log.h"

namespace lapwing {
namespace {

class Mcap final : public FlightLogReader {
 public:
  static constexpr PluginText kText{"mcap", "1.0.0",
                                    "recordings of JSON messages in Foxglove's schemas (.mcap)",
                                    "https://mcap.dev/spec"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .text("vehicle", "", "frame of the vehicle; empty: vehicle, base_link, body or drone")
        .text("camera", "",
              "frame of the camera; empty: camera, camera_link, camera_optical or "
              "gimbal");
  }
  explicit Mcap(const Parameters& parameters)
      : vehicle_(parameters.text("vehicle")), camera_(parameters.text("camera")) {}

  bool recognizes(std::string_view bytes) const override { return mcap_log::is_mcap(bytes); }
  FlightLog read(std::string_view bytes) const override {
    return mcap_log::read(bytes, vehicle_, camera_);
  }
  std::string example() const override { return mcap_log::example(); }

 private:
  std::string vehicle_, camera_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Mcap)
