// SPDX-License-Identifier: Apache-2.0
// All points within a radius of the line between two points: poles, cables, branches. Its core is
// the line.
//
//   { type = "capsule", from = {0, 0, 0}, to = {0, 0, 9}, radius = 0.3 }
#include <numbers>

#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class CapsuleForm final : public DifferentiableShape<CapsuleForm> {
 public:
  static constexpr PluginText kText{"capsule", "1.0.0",
                                    "all points within a radius of a line segment", "own"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("from", 3, "m", "one end of the line, world", between(-1e6, 1e6))
        .required_numbers("to", 3, "m", "other end of the line, world", between(-1e6, 1e6))
        .required_number("radius", "m", "radius", {0, 1e6, true});
  }
  explicit CapsuleForm(const Parameters& parameters)
      : from_(parameters.numbers("from").data()),
        axis_(Vector3d(parameters.numbers("to").data()) - from_),
        radius_(parameters.number("radius")) {}

  // On the line itself the way out is aside of it.
  template <class T>
  T core(const T* p) const {
    using std::sqrt;
    constexpr double kLine = 1e-4;  // m
    const double length2 = axis_.squaredNorm();
    T away[3], along = T(0.0);
    for (int i = 0; i < 3; ++i) {
      away[i] = p[i] - from_(i);
      if (length2 > 0) along += away[i] * (axis_(i) / length2);
    }
    if (value_of(along) < 0) along = T(0.0);
    if (value_of(along) > 1) along = T(1.0);
    T squared = T(0.0);
    for (int i = 0; i < 3; ++i) {
      away[i] = away[i] - along * axis_(i);
      squared += away[i] * away[i];
    }
    if (value_of(squared) >= kLine * kLine) return sqrt(squared);
    const Vector3d aside = length2 > 0 ? Vector3d(axis_.unitOrthogonal()) : Vector3d::UnitZ();
    T out = T(kLine);
    for (int i = 0; i < 3; ++i) out += aside(i) * (away[i] - value_of(away[i]));
    return out;
  }
  double rounding() const override { return radius_; }

  bool convex() const override { return true; }
  Eigen::AlignedBox3d bounds() const override {
    Eigen::AlignedBox3d box(from_);
    box.extend(Vector3d(from_ + axis_));
    const Vector3d around = Vector3d::Constant(radius_);
    return {box.min() - around, box.max() + around};
  }

  TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d&) const override {
    const int chords = chords_of(radius_, tolerance / 2), steps = (chords + 3) / 4;
    const double length = axis_.norm();
    std::vector<Eigen::Vector2d> profile;
    for (int k = 0; k <= steps; ++k) {
      const double angle = std::numbers::pi / 2 * k / steps;
      profile.emplace_back(k == 0 ? 0 : radius_ * std::sin(angle), -radius_ * std::cos(angle));
    }
    for (int k = steps; k >= 0; --k) {
      if (k == steps && !(length > 0)) continue;  // a ball has one equator
      profile.emplace_back(profile[static_cast<std::size_t>(k)].x(),
                           length - profile[static_cast<std::size_t>(k)].y());
    }
    const Eigen::Matrix3d R = Eigen::Quaterniond::FromTwoVectors(
                                  Vector3d::UnitZ(), length > 0 ? axis_ : Vector3d::UnitZ())
                                  .toRotationMatrix();
    return turned_surface(profile, chords, from_, R);
  }

  Value record() const override {
    const Vector3d to = from_ + axis_;
    Value value = Value::map();
    value.set("from", Value(Value::List{from_.x(), from_.y(), from_.z()}));
    value.set("to", Value(Value::List{to.x(), to.y(), to.z()}));
    value.set("radius", radius_);
    return value;
  }

 private:
  Vector3d from_, axis_;
  double radius_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::CapsuleForm)
