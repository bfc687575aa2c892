// SPDX-License-Identifier: Apache-2.0
// The controller of thesis 3.8.2: a linear quadratic regulator with integral action for the place,
// (3.14), and the attitude law of Lee, Leok, McClamroch (CDC 2010) on SO(3).
//
//   controller = "thesis"
#include "framework/plugin/plugin.h"
#include "framework/vehicle/flight_controller.h"

namespace lapwing {
namespace {

class Thesis final : public Controller {
 public:
  static constexpr PluginText kText{"thesis", "1.0.0",
                                    "regulator of the position; attitude from force and heading",
                                    "thesis 3.8.2"};
  static ParameterTable parameters() {
    const ControllerWeights usual;
    return ParameterTable{}
        .number("position", usual.position, "m", "position error of the same cost as 2 m/s^2",
                between(0.001, 10))
        .number("velocity", usual.velocity, "m/s", "velocity error of the same cost as 2 m/s^2",
                between(0.01, 100))
        .number("integral", usual.integral, "m s",
                "integral of the position error of the same cost as 2 m/s^2", between(0.001, 100))
        .number("tilt_bandwidth", usual.tilt_bandwidth, "rad/s", "largest bandwidth about x and y",
                between(1, 100))
        .number("heading_bandwidth", usual.heading_bandwidth, "rad/s", "largest bandwidth about z",
                between(0.1, 100));
  }
  explicit Thesis(const Parameters& parameters)
      : law_({parameters.number("position"), parameters.number("velocity"),
              parameters.number("integral"), parameters.number("tilt_bandwidth"),
              parameters.number("heading_bandwidth")}) {}

  void follow(const Vehicle& vehicle, const BodyReference& reference) override {
    law_.follow(vehicle, reference);
  }
  std::unique_ptr<ControlledFlight> begin() const override { return law_.begin(); }

 private:
  ThesisController law_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Thesis)
