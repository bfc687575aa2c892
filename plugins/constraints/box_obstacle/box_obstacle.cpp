// SPDX-License-Identifier: Apache-2.0
// Keeps the path outside every box of the environment, grown by the margin, along the whole path
// and not at the stages alone (problem/path_clearance.h).
//
//   d(p_i) - sqrt((margin + a h^2/8)^2 + L_i^2/4) >= 0,   L_i = |v_i| h + a h^2/2
//
// d: the distance from the box; inside, minus that from the nearest face.
//
//   p:add_constraint { type = "box_obstacle" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/path_clearance.h"

namespace lapwing {
namespace {

class BoxObstacle final : public DifferentiableConstraint<BoxObstacle, 7> {
 public:
  static constexpr PluginText kText{"box_obstacle", "1.0.0",
                                    "the path stays outside the environment's boxes",
                                    "thesis 3.6, obstacle avoidance, for boxes"};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTime, nullptr}};
    return all;
  }
  explicit BoxObstacle(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    boxes_ = setting.environment.boxes;
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"}),
                        .rows = static_cast<int>(boxes_.size())};
    for (const Box& box : boxes_)
      shape.row_names.push_back(box.name.empty() ? std::to_string(shape.row_names.size() + 1)
                                                 : box.name);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T asked =
        clearance_.around<T>(stage.template vector<3>(1), stage.scalar(2)).asked(margin_);
    for (std::size_t k = 0; k < boxes_.size(); ++k)
      rows[static_cast<int>(k)] = distance(boxes_[k], stage.data(0)) - asked;
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * boxes_.size(), 0.0);
    std::fill_n(upper, range.count * boxes_.size(), std::numeric_limits<double>::infinity());
  }

 private:
  template <class T>
  static T distance(const Box& box, const T* p) {
    using std::max, std::sqrt;
    T deepest = T(-std::numeric_limits<double>::infinity()), squared = T(0.0);
    for (int i = 0; i < 3; ++i) {
      const T beyond = max(p[i] - box.upper(i), box.lower(i) - p[i]);
      deepest = max(deepest, beyond);
      if (value_of(beyond) > 0) squared += beyond * beyond;
    }
    return value_of(deepest) <= 0 ? deepest : sqrt(squared);
  }

  std::vector<Box> boxes_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::BoxObstacle)
