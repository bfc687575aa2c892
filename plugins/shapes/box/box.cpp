// SPDX-License-Identifier: Apache-2.0
// A box parallel to the axes of the world.
//
//   { type = "box", lower = {-1, -1, 0}, upper = {1, 1, 8} }
#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class BoxForm final : public DifferentiableShape<BoxForm> {
 public:
  static constexpr PluginText kText{"box", "1.0.0", "a box parallel to the axes", "own"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("lower", 3, "m", "lowest corner, world", between(-1e6, 1e6))
        .required_numbers("upper", 3, "m", "highest corner, world", between(-1e6, 1e6));
  }
  explicit BoxForm(const Parameters& parameters)
      : lower_(parameters.numbers("lower").data()), upper_(parameters.numbers("upper").data()) {
    if (!(lower_.array() < upper_.array()).all())
      throw InputError(parameters.origin("lower"), "lower must be below upper in x, y and z");
  }

  // Outside by the parts beyond each pair of faces, inside by the nearest face.
  template <class T>
  T core(const T* p) const {
    using std::max, std::sqrt;
    T deepest = T(-std::numeric_limits<double>::infinity()), squared = T(0.0);
    for (int i = 0; i < 3; ++i) {
      const T beyond = max(p[i] - upper_(i), lower_(i) - p[i]);
      deepest = max(deepest, beyond);
      if (value_of(beyond) > 0) squared += beyond * beyond;
    }
    return value_of(deepest) <= 0 ? deepest : sqrt(squared);
  }

  bool convex() const override { return true; }
  std::optional<SimpleForm> simple_form() const override {
    return SimpleForm{0.5 * (lower_ + upper_), 0.5 * (upper_ - lower_), false};
  }
  Eigen::AlignedBox3d bounds() const override { return {lower_, upper_}; }

  std::optional<SurfaceHit> hit(const Vector3d& origin, const Vector3d& direction) const override {
    constexpr double kNearest = 1e-9;  // m
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    int enter_axis = 0, leave_axis = 0;
    for (int i = 0; i < 3; ++i) {
      if (direction(i) == 0) {
        if (origin(i) < lower_(i) || origin(i) > upper_(i)) return std::nullopt;
        continue;
      }
      const double a = (lower_(i) - origin(i)) / direction(i);
      const double b = (upper_(i) - origin(i)) / direction(i);
      if (std::min(a, b) > enter) enter = std::min(a, b), enter_axis = i;
      if (std::max(a, b) < leave) leave = std::max(a, b), leave_axis = i;
    }
    const bool outside = enter > kNearest;
    const double distance = outside ? enter : leave;
    if (enter > leave || !(distance > kNearest)) return std::nullopt;
    const int axis = outside ? enter_axis : leave_axis;
    return SurfaceHit{distance, direction(axis) > 0 ? Vector3d(-Vector3d::Unit(axis))
                                                    : Vector3d(Vector3d::Unit(axis))};
  }

  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override {
    return box_surface(bounds());
  }

  Value record() const override {
    Value value = Value::map();
    value.set("lower", Value(Value::List{lower_.x(), lower_.y(), lower_.z()}));
    value.set("upper", Value(Value::List{upper_.x(), upper_.y(), upper_.z()}));
    return value;
  }

 private:
  Vector3d lower_, upper_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::BoxForm)
