// SPDX-License-Identifier: Apache-2.0
// Keeps the path away from the meshes and maps of the environment, by the margin, along the whole
// path and not at the stages alone (problem/path_clearance.h).
//
//   d(p_i) - sqrt((margin + a h^2/8)^2 + L_i^2/4) >= 0,   L_i = |v_i| h + a h^2/2
//
// d: the distance to the nearest triangle, or to the nearest voxel that is occupied or unknown. It
// comes with its gradient (geometry/distance_field.h), so that solvers see it linearised.
//
//   p:add_constraint { type = "clearance" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/path_clearance.h"

namespace lapwing {
namespace {

class Clearance final : public DifferentiableConstraint<Clearance, 7> {
 public:
  static constexpr PluginText kText{
      "clearance", "1.0.0", "the path keeps the margin from the environment's meshes and maps",
      "thesis 2.1, Collision"};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTime, nullptr}};
    return all;
  }
  explicit Clearance(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    fields_.clear();
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"})};
    const auto add = [&](const auto& source, const char* kind) {
      if (!source.distance)
        throw InputError(std::string(kind) + " '" + source.name +
                         "' has no distances: its file was not read");
      fields_.push_back(source.distance);
      shape.row_names.push_back(source.name.empty() ? std::to_string(fields_.size()) : source.name);
    };
    for (const MeshObstacle& mesh : setting.environment.meshes) add(mesh, "mesh");
    for (const MapObstacle& map : setting.environment.maps) add(map, "map");
    shape.rows = static_cast<int>(fields_.size());
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T asked =
        clearance_.around<T>(stage.template vector<3>(1), stage.scalar(2)).asked(margin_);
    for (std::size_t k = 0; k < fields_.size(); ++k)
      rows[static_cast<int>(k)] = distance(*fields_[k], stage.data(0)) - asked;
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * fields_.size(), 0.0);
    std::fill_n(upper, range.count * fields_.size(), std::numeric_limits<double>::infinity());
  }

 private:
  // The field's value, and as many of its derivatives as T carries.
  template <class T>
  static T distance(const DistanceField& field, const T* p) {
    const Eigen::Vector3d at(value_of(p[0]), value_of(p[1]), value_of(p[2]));
    if constexpr (std::is_same_v<T, double>) {
      return field.distance(at, nullptr);
    } else {
      Eigen::Vector3d gradient;
      T d = T(field.distance(at, &gradient));
      const T moved[3] = {p[0] - at.x(), p[1] - at.y(), p[2] - at.z()};
      for (int i = 0; i < 3; ++i) d += gradient(i) * moved[i];
      if constexpr (!std::is_same_v<decltype(d.v), double>) {
        const Eigen::Matrix3d curvature = field.curvature(at);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) d += (0.5 * curvature(i, j)) * moved[i] * moved[j];
      }
      return d;
    }
  }

  std::vector<std::shared_ptr<const DistanceField>> fields_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Clearance)
