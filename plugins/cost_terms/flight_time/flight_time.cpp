// SPDX-License-Identifier: Apache-2.0
// How long the flight takes: the sum of all steps, in s.
//
//   E^T = sum_i h_i        the integral of 1^2: residual 1, weighted by the step
//
// Constant where the duration is given; to be made small where legs choose their own.
//
//   p:add_cost { type = "flight_time", weight = 1 }
#include <numeric>

#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"

namespace lapwing {
namespace {

class FlightTime final : public DifferentiableCost<FlightTime, 1> {
 public:
  static constexpr PluginText kText{"flight_time", "1.0.0", "the duration of the flight",
                                    "thesis 3.7.2"};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTranslation, nullptr},
                                    {kInvariantToRotationAboutZ, nullptr},
                                    {kInvariantToTime, nullptr}};
    return all;
  }
  explicit FlightTime(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.blocks = setting.layout.indices({"step"}),
                        .rows = 1,
                        .stages = std::vector<int>(setting.horizon.stages - 1),
                        .integral = true,
                        .affine = true};
    std::iota(shape.stages.begin(), shape.stages.end(), 0);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>&, Rows<T>& rows) const {
    rows[0] = T(1.0);
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::FlightTime)
