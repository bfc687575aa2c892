// SPDX-License-Identifier: Apache-2.0
// Keeps the path inside every flight zone of the environment, the margin away from its faces, along
// the whole path and not at the stages alone (problem/path_clearance.h).
//
//   -d(p_i) >= margin + a h^2/8                      convex zones: chords stay inside
//   -d(p_i) >= sqrt((margin + a h^2/8)^2 + L_i^2/4)   others
//
//   p:add_constraint { type = "flight_zone" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/path_clearance.h"
#include "framework/problem/zone_prism.h"

namespace lapwing {
namespace {

class FlightZone final : public DifferentiableConstraint<FlightZone, 7> {
 public:
  static constexpr PluginText kText{"flight_zone", "1.0.0",
                                    "the path stays inside the environment's flight zones", ""};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTime, nullptr}};
    return all;
  }
  explicit FlightZone(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    prisms_.clear();
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"})};
    for (const Zone& zone : setting.environment.flight_zones) {
      if (zone.corners.size() < 3)
        throw InputError("flight zone '" + zone.name + "' has fewer than three corners");
      prisms_.emplace_back(zone);
      shape.row_names.push_back(zone.name.empty() ? std::to_string(prisms_.size()) : zone.name);
    }
    shape.rows = static_cast<int>(prisms_.size());
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const PathReach<T> reach = clearance_.around<T>(stage.template vector<3>(1), stage.scalar(2));
    for (std::size_t k = 0; k < prisms_.size(); ++k) {
      const T inside = -prisms_[k].distance(stage.data(0));
      rows[static_cast<int>(k)] = prisms_[k].convex() ? T(inside - reach.bulge - margin_)
                                                      : T(inside - reach.asked(margin_));
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * prisms_.size(), 0.0);
    std::fill_n(upper, range.count * prisms_.size(), std::numeric_limits<double>::infinity());
  }

 private:
  std::vector<ZonePrism> prisms_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::FlightZone)
