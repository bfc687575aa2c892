// SPDX-License-Identifier: Apache-2.0
// An upright cone: roofs, tents, fir trees.
//
//   { type = "cone", base = {0, 0, 0}, radius = 2, height = 9 }
#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class ConeForm final : public DifferentiableShape<ConeForm> {
 public:
  static constexpr PluginText kText{"cone", "1.0.0", "an upright cone", "own"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("base", 3, "m", "centre of its base, world", between(-1e6, 1e6))
        .required_number("radius", "m", "radius of its base", {0, 1e6, true})
        .required_number("height", "m", "height from base to tip", {0, 1e6, true});
  }
  explicit ConeForm(const Parameters& parameters)
      : base_(parameters.numbers("base").data()),
        radius_(parameters.number("radius")),
        height_(parameters.number("height")) {}

  // In the half plane through the axis and p the cone is a triangle: its slope runs from the rim
  // (radius, 0) to the tip (0, height), and out of it points (height, radius). The nearest part is
  // chosen by value; on the axis, where the distance has a kink, the gradient has no part across.
  template <class T>
  T core(const T* p) const {
    using std::sqrt;
    const T x = p[0] - base_.x(), y = p[1] - base_.y(), up = p[2] - base_.z();
    const T across = sqrt(x * x + y * y);
    const double slant = std::hypot(radius_, height_);
    const T side = ((across - radius_) * height_ + up * radius_) * (1 / slant);
    const double a = value_of(across), z = value_of(up);
    // From the rim towards the tip.
    const double along = ((radius_ - a) * radius_ + z * height_) / slant;
    if (z <= 0 && a <= radius_) return -up;
    if (value_of(side) <= 0 && z > 0) return z < -value_of(side) ? -up : side;
    if (along <= 0) return sqrt((across - radius_) * (across - radius_) + up * up);
    if (along >= slant) return sqrt(across * across + (up - height_) * (up - height_));
    return side;
  }

  bool convex() const override { return true; }
  Eigen::AlignedBox3d bounds() const override {
    return {base_ - Vector3d(radius_, radius_, 0), base_ + Vector3d(radius_, radius_, height_)};
  }
  TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d&) const override {
    return turned_surface({{radius_, 0}, {0, height_}}, chords_of(radius_, tolerance), base_);
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

LAPWING_PLUGINS(lapwing::ConeForm)
