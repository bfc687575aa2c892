// SPDX-License-Identifier: Apache-2.0
// A ball: all points within a radius of a centre. Its core is the centre.
//
//   { type = "sphere", center = {0, 0, 2}, radius = 5 }
#include <numbers>

#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class SphereForm final : public DifferentiableShape<SphereForm> {
 public:
  static constexpr PluginText kText{"sphere", "1.0.0", "a ball", "thesis 3.6"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("center", 3, "m", "world", between(-1e6, 1e6))
        .required_number("radius", "m", "radius", {0, 1e6, true});
  }
  explicit SphereForm(const Parameters& parameters)
      : center_(parameters.numbers("center").data()), radius_(parameters.number("radius")) {}

  // From the very centre the way out is up.
  template <class T>
  T core(const T* p) const {
    using std::sqrt;
    constexpr double kCentre = 1e-4;  // m
    T d[3], squared = T(0.0);
    for (int i = 0; i < 3; ++i) {
      d[i] = p[i] - center_(i);
      squared += d[i] * d[i];
    }
    if (value_of(squared) < kCentre * kCentre) return d[2] - value_of(d[2]) + kCentre;
    return sqrt(squared);
  }
  double rounding() const override { return radius_; }

  bool convex() const override { return true; }
  std::optional<SimpleForm> simple_form() const override {
    return SimpleForm{center_, Vector3d::Constant(radius_), true};
  }
  Eigen::AlignedBox3d bounds() const override {
    return {center_ - Vector3d::Constant(radius_), center_ + Vector3d::Constant(radius_)};
  }

  std::optional<SurfaceHit> hit(const Vector3d& origin, const Vector3d& direction) const override {
    constexpr double kNearest = 1e-9;  // m
    const Vector3d to_center = center_ - origin;
    const double along = to_center.dot(direction);
    const double half2 = radius_ * radius_ - (to_center - along * direction).squaredNorm();
    if (half2 < 0) return std::nullopt;
    const double half = std::sqrt(half2);
    const double distance = along - half > kNearest ? along - half : along + half;
    if (!(distance > kNearest)) return std::nullopt;
    const Vector3d normal = (origin + distance * direction - center_) / radius_;
    return SurfaceHit{distance, normal.dot(direction) > 0 ? Vector3d(-normal) : normal};
  }

  TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d&) const override {
    const int chords = chords_of(radius_, tolerance / 2);
    const int steps = (chords + 1) / 2;
    std::vector<Eigen::Vector2d> profile;
    for (int k = 0; k <= steps; ++k) {
      const double angle = std::numbers::pi * k / steps;
      profile.emplace_back(k == 0 || k == steps ? 0 : radius_ * std::sin(angle),
                           -radius_ * std::cos(angle));
    }
    return turned_surface(profile, chords, center_);
  }

  Value record() const override {
    Value value = Value::map();
    value.set("center", Value(Value::List{center_.x(), center_.y(), center_.z()}));
    value.set("radius", radius_);
    return value;
  }

 private:
  Vector3d center_;
  double radius_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::SphereForm)
