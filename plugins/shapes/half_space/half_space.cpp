// SPDX-License-Identifier: Apache-2.0
// All points behind a plane: slopes, facades, the ground.
//
//   { type = "half_space", point = {0, 0, 1}, normal = {0, 0, 1} }
#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class HalfSpaceForm final : public DifferentiableShape<HalfSpaceForm> {
 public:
  static constexpr PluginText kText{"half_space", "1.0.0", "all points behind a plane", "own"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("point", 3, "m", "point on the plane, world", between(-1e6, 1e6))
        .required_numbers("normal", 3, "", "normal that points out, of any length",
                          between(-1e6, 1e6));
  }
  explicit HalfSpaceForm(const Parameters& parameters)
      : point_(parameters.numbers("point").data()), normal_(parameters.numbers("normal").data()) {
    constexpr double kLeast = 1e-9;
    if (!(normal_.norm() > kLeast))
      throw InputError(parameters.origin("normal"), "normal: expected a vector that is not zero");
    unit_ = normal_.normalized();
  }

  template <class T>
  T core(const T* p) const {
    return unit_.x() * (p[0] - point_.x()) + unit_.y() * (p[1] - point_.y()) +
           unit_.z() * (p[2] - point_.z());
  }

  bool convex() const override { return true; }
  // Along an axis it ends only where the plane is at right angles to it.
  Eigen::AlignedBox3d bounds() const override {
    constexpr double kOpen = std::numeric_limits<double>::infinity();
    Eigen::AlignedBox3d box(Vector3d::Constant(-kOpen), Vector3d::Constant(kOpen));
    for (int i = 0; i < 3; ++i) {
      if (unit_(i) == 1) box.max()(i) = point_(i);
      if (unit_(i) == -1) box.min()(i) = point_(i);
    }
    return box;
  }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d& within) const override {
    return cut_box(within, point_, unit_);
  }

  Value record() const override {
    Value value = Value::map();
    value.set("point", Value(Value::List{point_.x(), point_.y(), point_.z()}));
    value.set("normal", Value(Value::List{normal_.x(), normal_.y(), normal_.z()}));
    return value;
  }

 private:
  Vector3d point_, normal_, unit_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::HalfSpaceForm)
