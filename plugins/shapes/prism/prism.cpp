// SPDX-License-Identifier: Apache-2.0
// All points above a polygon on the ground, between two heights, of which each may be missing: what
// a zone is, to keep out of or inside of.
//
//   { type = "prism", corners = {{0, 0}, {9, 0}, {9, 5}}, floor = 0, ceiling = 12 }
#include "framework/geometry/polygon.h"
#include "framework/plugin/plugin.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"
#include "plugins/shapes/prism/prism_distance.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;

constexpr double kOpen = std::numeric_limits<double>::infinity();

std::vector<Vector2d> corners_of(const Parameters& parameters) {
  const auto numbers = parameters.numbers("corners");
  if (numbers.size() < 6 || numbers.size() % 2 != 0)
    throw InputError(parameters.origin("corners"), "corners: expected at least three pairs x, y");
  std::vector<Vector2d> corners;
  for (std::size_t i = 0; i < numbers.size(); i += 2)
    corners.emplace_back(numbers[i], numbers[i + 1]);
  if (!is_simple_polygon(corners))
    throw InputError(parameters.origin("corners"),
                     "its edges cross or touch, or corners coincide; list the corners in order");
  return corners;
}

class PrismForm final : public DifferentiableShape<PrismForm> {
 public:
  static constexpr PluginText kText{"prism", "1.0.0", "the prism over a polygon on the ground",
                                    "own"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("corners", 0, "m", "x and y of each corner, in order, world",
                          between(-1e6, 1e6))
        .optional_number("floor", "m", "lower end; absent: none")
        .optional_number("ceiling", "m", "upper end; absent: none");
  }
  static std::vector<Preset> presets() {
    return {{"no_fly_zone", "a zone closed to flight: another name for prism", Value::map()}};
  }
  explicit PrismForm(const Parameters& parameters)
      : corners_(corners_of(parameters)),
        floor_(parameters.has("floor") ? parameters.number("floor") : -kOpen),
        ceiling_(parameters.has("ceiling") ? parameters.number("ceiling") : kOpen),
        distance_(corners_, floor_, ceiling_),
        convex_(distance_.convex()) {
    if (!(floor_ < ceiling_))
      throw InputError(parameters.origin("ceiling"), "its ceiling must be above its floor");
  }

  template <class T>
  T core(const T* p) const {
    return distance_.distance(p);
  }

  bool convex() const override { return convex_; }
  Eigen::AlignedBox3d bounds() const override {
    Eigen::AlignedBox3d box;
    for (const Vector2d& corner : corners_) {
      box.extend(Eigen::Vector3d(corner.x(), corner.y(), floor_));
      box.extend(Eigen::Vector3d(corner.x(), corner.y(), ceiling_));
    }
    return box;
  }

  TriangleMesh triangles(double, const Eigen::AlignedBox3d& within) const override {
    const double low = std::isfinite(floor_) ? floor_ : std::min(within.min().z(), ceiling_ - 1);
    const double high = std::isfinite(ceiling_) ? ceiling_ : std::max(within.max().z(), low + 1);
    return prism_surface(corners_, low, high);
  }

  Value record() const override {
    Value value = Value::map(), corners = Value::list();
    for (const Vector2d& corner : corners_) {
      corners.push_back(corner.x());
      corners.push_back(corner.y());
    }
    value.set("corners", std::move(corners));
    if (std::isfinite(floor_)) value.set("floor", floor_);
    if (std::isfinite(ceiling_)) value.set("ceiling", ceiling_);
    return value;
  }

 private:
  std::vector<Vector2d> corners_;
  double floor_, ceiling_;  // m, perhaps infinite
  PrismDistance distance_;
  bool convex_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::PrismForm)
