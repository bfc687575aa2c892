// SPDX-License-Identifier: Apache-2.0
// Keeps the path outside every zone of the environment, grown by the margin, along the whole path
// and not at the stages alone (problem/path_clearance.h). A zone is a prism over a polygon of any
// shape, between a floor and a ceiling, of which each may be missing.
//
//   d(p_i) - sqrt((margin + a h^2/8)^2 + L_i^2/4) >= 0,   L_i = |v_i| h + a h^2/2
//
// d: the distance from the prism; inside, minus that from the nearest of its faces.
//
//   p:add_constraint { type = "no_fly_zone" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/path_clearance.h"
#include "framework/problem/zone_prism.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class NoFlyZone final : public DifferentiableConstraint<NoFlyZone, 7> {
 public:
  static constexpr PluginText kText{"no_fly_zone", "1.0.0",
                                    "the path stays outside the environment's zones", ""};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTime, nullptr}};
    return all;
  }
  explicit NoFlyZone(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    prisms_.clear();
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"})};
    for (const Zone& zone : setting.environment.zones) {
      if (zone.corners.size() < 3)
        throw InputError("zone '" + zone.name + "' has fewer than three corners");
      prisms_.emplace_back(zone);
      shape.row_names.push_back(zone.name.empty() ? std::to_string(prisms_.size()) : zone.name);
    }
    shape.rows = static_cast<int>(prisms_.size());
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T asked =
        clearance_.around<T>(stage.template vector<3>(1), stage.scalar(2)).asked(margin_);
    for (std::size_t k = 0; k < prisms_.size(); ++k)
      rows[static_cast<int>(k)] = prisms_[k].distance(stage.data(0)) - asked;
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * prisms_.size(), 0.0);
    std::fill_n(upper, range.count * prisms_.size(), kInfinity);
  }

 private:
  std::vector<ZonePrism> prisms_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::NoFlyZone)
