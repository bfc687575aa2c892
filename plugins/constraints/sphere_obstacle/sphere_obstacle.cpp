// SPDX-License-Identifier: Apache-2.0
// Keeps the path outside every sphere of the environment, grown by the margin (thesis 3.6; reading
// 3.6), along the whole path and not at the stages alone (problem/path_clearance.h).
//
//   |p_i - c| - sqrt((R + margin + a h^2/8)^2 + L_i^2/4) >= 0,   L_i = |v_i| h + a h^2/2
//
//   p:add_constraint { type = "sphere_obstacle" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/path_clearance.h"

namespace lapwing {
namespace {

class SphereObstacle final : public DifferentiableConstraint<SphereObstacle, 7> {
 public:
  static constexpr PluginText kText{"sphere_obstacle", "1.0.0",
                                    "the path stays outside the environment's spheres",
                                    "thesis 3.6, obstacle avoidance"};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTime, nullptr}};
    return all;
  }
  explicit SphereObstacle(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    spheres_ = setting.environment.spheres;
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"}),
                        .rows = static_cast<int>(spheres_.size())};
    for (const Sphere& sphere : spheres_)
      shape.row_names.push_back(sphere.name.empty() ? std::to_string(shape.row_names.size() + 1)
                                                    : sphere.name);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto position = stage.template vector<3>(0);
    const PathReach<T> reach = clearance_.around<T>(stage.template vector<3>(1), stage.scalar(2));
    for (std::size_t k = 0; k < spheres_.size(); ++k) {
      const Sphere& sphere = spheres_[k];
      rows[static_cast<int>(k)] =
          distance<T>(position, sphere.center) - reach.asked(sphere.radius + margin_);
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * spheres_.size(), 0.0);
    std::fill_n(upper, range.count * spheres_.size(), std::numeric_limits<double>::infinity());
  }

 private:
  // From the very centre the way out is up.
  template <class T>
  static T distance(const Eigen::Matrix<T, 3, 1>& p, const Eigen::Vector3d& center) {
    using std::sqrt;
    constexpr double kCentre = 1e-4;  // m
    T d[3], squared = T(0.0);
    for (int i = 0; i < 3; ++i) {
      d[i] = p(i) - center(i);
      squared += d[i] * d[i];
    }
    if (value_of(squared) < kCentre * kCentre) return d[2] - value_of(d[2]) + kCentre;
    return sqrt(squared);
  }

  std::vector<Sphere> spheres_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::SphereObstacle)
