// SPDX-License-Identifier: Apache-2.0
// An upright cylinder: silos, chimneys, towers.
//
//   { type = "cylinder", base = {0, 0, 0}, radius = 2, height = 9 }
#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class CylinderForm final : public DifferentiableShape<CylinderForm> {
 public:
  static constexpr PluginText kText{"cylinder", "1.0.0", "an upright cylinder", "own"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("base", 3, "m", "centre of its base, world", between(-1e6, 1e6))
        .required_number("radius", "m", "radius of its base", {0, 1e6, true})
        .required_number("height", "m", "height from base to top", {0, 1e6, true});
  }
  explicit CylinderForm(const Parameters& parameters)
      : base_(parameters.numbers("base").data()),
        radius_(parameters.number("radius")),
        height_(parameters.number("height")) {}

  // Beyond the wall and beyond the nearer end; inside, minus the way to the nearest of them.
  template <class T>
  T core(const T* p) const {
    using std::max, std::sqrt;
    const T x = p[0] - base_.x(), y = p[1] - base_.y(), up = p[2] - base_.z();
    const T wall = sqrt(x * x + y * y) - radius_, end = max(up - height_, -up);
    if (value_of(wall) > 0 && value_of(end) > 0) return sqrt(wall * wall + end * end);
    return max(wall, end);
  }

  bool convex() const override { return true; }
  Eigen::AlignedBox3d bounds() const override {
    return {base_ - Vector3d(radius_, radius_, 0), base_ + Vector3d(radius_, radius_, height_)};
  }
  TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d&) const override {
    return turned_surface({{radius_, 0}, {radius_, height_}}, chords_of(radius_, tolerance), base_);
  }

  Value record() const override {
    Value value = Value::map();
    value.set("base", Value(Value::List{base_.x(), base_.y(), base_.z()}));
    value.set("radius", radius_);
    value.set("height", height_);
    return value;
  }

 private:
  Vector3d base_;
  double radius_, height_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::CylinderForm)
