// SPDX-License-Identifier: Apache-2.0
// A gate to be flown through at the end of a leg (thesis 3.7.2).
//
//   n . (p - c) = 0,   m_k . (p - c) <= d_k - margin,   n . v >= speed     at the leg's last stage
//   |p - c|^2 <= (r - margin)^2                                            for a ball
//
// n is the direction of flight, m_k the outward normals of the opening's sides. With a tunnel the
// leg ends where the tunnel begins, the next leg ends where it ends, and every stage of that leg
// keeps within the opening: openings are convex, so chords between stages keep within too, and the
// margin is for the path's bulge.
//
//   p:add_constraint { type = "gate", leg = 3, shape = "rectangle", position = {9, 6, 1},
//                      direction = {1, 0, 0}, width = 2.4, height = 2.4, margin = 0.02 }
#include "framework/trajectory/gate.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Gate final : public DifferentiableConstraint<Gate> {
 public:
  static constexpr PluginText kText{"gate", "1.0.0", "the flight passes a gate at the end of a leg",
                                    "thesis 3.7.2"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("leg", 1,
                 "number of the leg that ends in the opening, or at the start of the tunnel",
                 at_least(0))
        .choice("shape", "ball", {"ball", "rectangle", "triangle", "pentagon", "hexagon"},
                "shape of the opening")
        .numbers("position", {0, 0, 0}, "m", "centre of the opening, world")
        .numbers("direction", {1, 0, 0}, "", "flight direction, world; not used for a ball")
        .numbers("up", {0, 0, 1}, "", "upward direction of the opening, world")
        .optional_number("width", "m", "width of a rectangle or a triangle", above(0))
        .optional_number("height", "m", "height of a rectangle or a triangle", above(0))
        .number("radius", 0.5, "m",
                "radius of a ball; circumradius of a pentagon or a hexagon, if `side` is absent",
                above(0))
        .optional_number("side", "m", "side of a pentagon or a hexagon", above(0))
        .number("tunnel_length", 0, "m", "length, half before and half behind the opening",
                at_least(0))
        .number("margin", 0, "m", "distance from the rim", at_least(0))
        .number("speed", 0.1, "m/s", "smallest speed along `direction`", at_least(0));
  }

  explicit Gate(const Parameters& given)
      : leg_(static_cast<int>(given.integer("leg"))),
        margin_(given.number("margin")),
        speed_(given.number("speed")) {
    const auto size = [&](const char* name) { return given.has(name) ? given.number(name) : 0.0; };
    const auto vector = [&](const char* name) -> Eigen::Vector3d {
      if (given.numbers(name).size() != 3)
        throw InputError(given.origin(name), std::string(name) + ": expected 3 numbers");
      return Eigen::Vector3d(given.numbers(name).data());
    };
    GateShape shape{given.text("shape"), size("width"), size("height"), 0, size("side")};
    const bool round =
        shape.shape == "ball" || shape.shape == "pentagon" || shape.shape == "hexagon";
    if (round && shape.side == 0) shape.radius = given.number("radius");
    gate_.corners = gate_corners(shape);
    gate_.radius = shape.radius;
    gate_.position = vector("position");
    gate_.tunnel_length = given.number("tunnel_length");
    if (gate_.ball()) {
      if (gate_.tunnel_length > 0)
        throw InputError(given.origin("tunnel_length"), "tunnel_length: a ball has no tunnel");
      if (!(margin_ < gate_.radius))
        throw InputError(given.origin("margin"), "margin: no part of the ball remains");
      return;
    }
    set_direction(gate_, vector("direction"), vector("up"));
    list_sides(given);
  }

  FunctionShape declare(const ProblemSetting& setting) {
    const int first = setting.horizon.end_of_leg(leg_);
    FunctionShape shape{.rows = gate_.ball() ? 1 : static_cast<int>(sides_.size()) + 2,
                        .affine = !gate_.ball()};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("position"), reads.add<3>("velocity")};
    last_ = gate_.tunnel_length > 0 ? setting.horizon.end_of_leg(leg_ + 1) - first : 0;
    for (int k = 0; k <= last_; ++k) shape.stages.push_back(first + k);
    if (gate_.ball()) {
      shape.row_names = {"distance"};
      return shape;
    }
    shape.row_names = {"along", "speed"};
    for (std::size_t k = 0; k < sides_.size(); ++k)
      shape.row_names.push_back("side_" + std::to_string(k + 1));
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    T from[3];
    for (int i = 0; i < 3; ++i) from[i] = stage(in_.position)[i] - gate_.position[i];
    if (gate_.ball()) {
      rows[0] = from[0] * from[0] + from[1] * from[1] + from[2] * from[2];
      return;
    }
    const auto along = [](const Eigen::Vector3d& d, const T* v) {
      return d.x() * v[0] + d.y() * v[1] + d.z() * v[2];
    };
    rows[0] = along(gate_.direction, from);
    rows[1] = along(gate_.direction, stage(in_.velocity).data());
    for (std::size_t k = 0; k < sides_.size(); ++k)
      rows[static_cast<int>(k) + 2] = along(sides_[k].outward, from);
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    const double half = 0.5 * gate_.tunnel_length;
    for (int k = range.first; k < range.first + range.count; ++k) {
      if (gate_.ball()) {
        *lower++ = -kInfinity;
        *upper++ = (gate_.radius - margin_) * (gate_.radius - margin_);
        continue;
      }
      const bool end = k == 0 || k == last_;
      *lower++ = k == 0 ? -half : k == last_ ? half : -half;
      *upper++ = k == 0 ? -half : half;
      *lower++ = end ? speed_ : -kInfinity;
      *upper++ = kInfinity;
      for (const Side& side : sides_) {
        *lower++ = -kInfinity;
        *upper++ = side.distance - margin_;
      }
    }
  }

 private:
  struct Side {
    Eigen::Vector3d outward;  // unit, world
    double distance;          // m, from the middle
  };

  void list_sides(const Parameters& given) {
    const std::size_t count = gate_.corners.size();
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector2d &a = gate_.corners[k], &b = gate_.corners[(k + 1) % count];
      const Eigen::Vector2d out = Eigen::Vector2d(b.y() - a.y(), a.x() - b.x()).normalized();
      sides_.push_back({out.x() * gate_.left() + out.y() * gate_.up, out.dot(a)});
      if (!(margin_ < 0.99 * sides_.back().distance))
        throw InputError(given.origin("margin"), "margin: no part of the opening remains");
    }
  }

  struct {
    VectorHandle position, velocity;
  } in_;
  int leg_, last_ = 0;
  double margin_, speed_;
  GateTask gate_;
  std::vector<Side> sides_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Gate)
