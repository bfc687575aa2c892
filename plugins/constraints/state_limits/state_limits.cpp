// SPDX-License-Identifier: Apache-2.0
// Limits of the flight: speed across, climb, descent, yaw rate, acceleration, and a box to stay in.
//
//   d_k . v_xy  <= cos(pi/n) speed_across           d_k: n directions around a circle, so that the
//   d_k . F_xy  <= cos(pi/n) m acceleration_across  polygon lies inside the circle of the limit
//   or d_k . a_xy <= cos(pi/n) acceleration_across  of a model whose state has an acceleration
//   -descent <= v_z <= climb,  |yaw_rate| <= its limit,  lower <= position <= upper
//
// Limits are the vehicle's; a parameter may tighten one, never loosen it. Velocity is linear
// between stages as long as forces are held, so what holds at the stages holds between them;
// position is a parabola there and may pass its box by up to h^2 a / 8.
//
//   p:add_constraint { type = "state_limits", speed_across = 5, lower = {-50, -50, 0} }
#include <numbers>
#include <optional>

#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class StateLimits final : public DifferentiableConstraint<StateLimits, 10> {
 public:
  static constexpr PluginText kText{"state_limits", "1.0.0",
                                    "bounds speed, acceleration and position", "thesis 3.5.1"};
  static ParameterTable parameters() {
    const std::string tighter = ", if tighter than the vehicle's";
    return ParameterTable{}
        .integer("sides", 16, "sides of the polygon for horizontal limits; even", between(4, 64))
        .optional_number("speed_across", "m/s", "horizontal speed" + tighter, above(0))
        .optional_number("climb_speed", "m/s", "climb speed" + tighter, above(0))
        .optional_number("descent_speed", "m/s", "descent speed" + tighter, above(0))
        .optional_number("yaw_rate", "rad/s", "yaw rate" + tighter, above(0))
        .optional_number("acceleration_across", "m/s^2", "horizontal acceleration" + tighter,
                         above(0))
        .optional_numbers("lower", 3, "m", "lower corner of the position box, world")
        .optional_numbers("upper", 3, "m", "upper corner of the position box, world");
  }

  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTime, nullptr}};
    return all;
  }
  explicit StateLimits(const Parameters& parameters)
      : given_(parameters), sides_(static_cast<int>(parameters.integer("sides"))) {
    if (sides_ % 2 != 0)
      throw InputError(parameters.origin("sides"),
                       "sides: expected an even number, got " + std::to_string(sides_));
    for (int k = 0; k < sides_ / 2; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / sides_;
      directions_.emplace_back(std::cos(angle), std::sin(angle));
    }
  }

  FunctionShape declare(const ProblemSetting& setting) {
    const Vehicle& vehicle = setting.vehicle;
    mass_ = vehicle.mass;
    inside_ = given_.has("lower") || given_.has("upper");
    lower_.clear(), upper_.clear(), names_.clear();
    const double inscribed = std::cos(std::numbers::pi / sides_);
    FunctionShape shape{.affine = true};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("velocity"), {}, {}, {}, {}};
    if (reads.has("yaw_rate")) in_.yaw_rate = reads.add("yaw_rate");
    if (reads.has("force")) {
      in_.force = reads.add<3>("force");
    } else if (reads.has("acceleration")) {
      in_.acceleration = reads.add<3>("acceleration");
    }
    if (inside_) in_.position = reads.add<3>("position");
    polygon("speed_across", inscribed * limit("speed_across", vehicle.speed_across_max));
    row("climb", -limit("descent_speed", vehicle.descent_speed_max),
        limit("climb_speed", vehicle.climb_speed_max));
    const double yaw_rate = limit("yaw_rate", vehicle.yaw_rate_max);
    if (in_.yaw_rate) row("yaw_rate", -yaw_rate, yaw_rate);
    if (in_.force) {
      polygon("acceleration_across",
              inscribed * limit("acceleration_across", vehicle.acceleration_across_max));
      row("acceleration_up", -vehicle.acceleration_down_max.value_or(kInfinity),
          vehicle.acceleration_up_max.value_or(kInfinity));
    }
    if (in_.acceleration) {
      polygon("acceleration_across",
              inscribed * limit("acceleration_across", vehicle.acceleration_across_max));
      row("acceleration_up", -vehicle.largest_acceleration_down(),
          vehicle.largest_acceleration_up());
    }
    if (inside_) place();
    shape.rows = static_cast<int>(names_.size());
    shape.row_names = names_;
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto velocity = stage(in_.velocity);
    int r = 0;
    for (const Eigen::Vector2d& d : directions_)
      rows[r++] = d.x() * velocity.x() + d.y() * velocity.y();
    rows[r++] = velocity.z();
    if (in_.yaw_rate) rows[r++] = stage(*in_.yaw_rate);
    if (in_.force) {
      const auto force = stage(*in_.force);
      for (const Eigen::Vector2d& d : directions_)
        rows[r++] = (d.x() * force.x() + d.y() * force.y()) / mass_;
      rows[r++] = force.z() / mass_ - kGravity;
    }
    if (in_.acceleration) {
      const auto acceleration = stage(*in_.acceleration);
      for (const Eigen::Vector2d& d : directions_)
        rows[r++] = d.x() * acceleration.x() + d.y() * acceleration.y();
      rows[r++] = acceleration.z();
    }
    if (!inside_) return;
    const auto position = stage(in_.position);
    for (int i = 0; i < 3; ++i) rows[r++] = position[i];
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      lower = std::copy(lower_.begin(), lower_.end(), lower);
      upper = std::copy(upper_.begin(), upper_.end(), upper);
    }
  }

 private:
  double limit(const char* name, double of_vehicle) const {
    if (!given_.has(name)) return of_vehicle;
    const double given = given_.number(name);
    if (given <= of_vehicle) return given;
    throw InputError(given_.origin(name), std::string(name) + ": " + std::to_string(given) +
                                              " exceeds the limit of the vehicle, " +
                                              std::to_string(of_vehicle));
  }
  void row(std::string name, double low, double high) {
    names_.push_back(std::move(name));
    lower_.push_back(low);
    upper_.push_back(high);
  }
  void polygon(const std::string& name, double half) {
    for (int k = 0; k < sides_ / 2; ++k) row(name + "." + std::to_string(k), -half, half);
  }
  void place() {
    for (int i = 0; i < 3; ++i) {
      const double low = given_.has("lower") ? given_.numbers("lower")[i] : -kInfinity;
      const double high = given_.has("upper") ? given_.numbers("upper")[i] : kInfinity;
      const char axis[] = {static_cast<char>('x' + i), '\0'};
      if (low > high)
        throw InputError(given_.origin("lower"),
                         std::string("lower and upper: no position lies between them in ") + axis);
      row(std::string("position.") + axis, low, high);
    }
  }

  Parameters given_;
  int sides_;
  double mass_ = 1;
  bool inside_ = false;
  struct {
    VectorHandle velocity;
    std::optional<NumberHandle> yaw_rate;      // of models that have one
    std::optional<VectorHandle> force;         // likewise
    std::optional<VectorHandle> acceleration;  // of models without a force
    VectorHandle position;                     // where it is limited
  } in_;
  std::vector<Eigen::Vector2d> directions_;
  std::vector<std::string> names_;
  std::vector<double> lower_, upper_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::StateLimits)
