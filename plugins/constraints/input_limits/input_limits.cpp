// SPDX-License-Identifier: Apache-2.0
// Limits of force and yaw torque (thesis 3.8.3 with reading 3.2): rotors keep within theirs for any
// allowed force together with any allowed yaw torque.
//
//   box:   |F_x|, |F_y| <= a,  lo <= F_z <= hi,  |M| <= M_max,  with the box inside the ball:
//          2 a^2 + hi^2 <= u_max^2,   lo >= u_min
//   norm:  |F|^2 <= u_max^2 and |F_xy|^2 <= (m a_max)^2 as they stand,  F_z >= lo
//
// The box leaves upwards at least half of the thrust above hovering, and its half width across is
// then as large as the ball and the vehicle's acceleration across allow. `across` says what the
// latter means for a box: "inscribed" holds the acceleration in every direction, so that along the
// axes it stops at 71 %; "extent" stops each axis at the limit and leaves the corners to
// state_limits, whose polygon follows the circle. `share` pulls every limit towards hovering, in
// reserve for the controller.
//
//   p:add_constraint { type = "input_limits", share = 0.95 }
#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class InputLimits final : public DifferentiableConstraint<InputLimits, 4> {
 public:
  static constexpr PluginText kText{"input_limits", "1.0.0",
                                    "bounds force and yaw torque by the limits of the rotors",
                                    "thesis 3.8.3"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .boolean("norm", false,
                 "bound the norm of the force: a larger set than the box, but curved rows")
        .choice("across", "inscribed", {"inscribed", "extent"},
                "box only: horizontal acceleration limit in every direction, or per axis")
        .number("share", 0.98, "", "used fraction of the limits, measured from hovering",
                {.minimum = 0, .maximum = 1, .minimum_excluded = true});
  }

  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTranslation, nullptr},
                                    {kInvariantToTime, nullptr}};
    return all;
  }
  explicit InputLimits(const Parameters& parameters)
      : norm_(parameters.boolean("norm")),
        inscribed_(parameters.text("across") == "inscribed"),
        share_(parameters.number("share")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    find_limits(setting.vehicle);
    FunctionShape shape{.rows = norm_ ? 6 : 4,
                        .affine = !norm_,
                        .identity = !norm_,
                        .row_names = {"force.x", "force.y", "force.z", "yaw_torque"}};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("force"), reads.add("yaw_torque")};
    if (norm_) shape.row_names.insert(shape.row_names.end(), {"force_norm", "force_across"});
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto force = stage(in_.force);
    for (int i = 0; i < 3; ++i) rows[i] = force[i];
    rows[3] = stage(in_.yaw_torque);
    if (!norm_) return;
    const T across = force.x() * force.x() + force.y() * force.y();
    rows[4] = (across + force.z() * force.z()) / (norm_max_ * norm_max_);
    rows[5] = across / (across_max_ * across_max_);
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      for (const double value : {-across_, -across_, low_, -torque_}) *lower++ = value;
      for (const double value : {across_, across_, high_, torque_}) *upper++ = value;
      if (!norm_) continue;
      for (const double value : {-kInfinity, -kInfinity}) *lower++ = value;
      for (const double value : {1.0, 1.0}) *upper++ = value;
    }
  }

 private:
  void find_limits(const Vehicle& vehicle) {
    const double hover = vehicle.mass * kGravity;
    const auto toward = [&](double limit) { return hover + share_ * (limit - hover); };
    const auto text = [](double newtons) { return std::to_string(newtons) + " N"; };
    if (!(vehicle.thrust_min() < hover && hover < vehicle.thrust_max()))
      throw InputError("the vehicle's rotors.thrust and yaw_share allow forces between " +
                       text(vehicle.thrust_min()) + " and " + text(vehicle.thrust_max()) +
                       ", which leaves no range around hovering: mass " +
                       std::to_string(vehicle.mass) + " kg needs " + text(hover));
    norm_max_ = toward(vehicle.thrust_max());
    across_max_ = share_ * vehicle.mass * vehicle.acceleration_across_max;
    if (!(across_max_ > 0))
      throw InputError("the vehicle's limits.acceleration_across must be above 0");
    low_ = toward(vehicle.thrust_min());
    high_ = norm_max_;
    if (vehicle.acceleration_down_max)
      low_ = std::max(low_, hover - share_ * vehicle.mass * *vehicle.acceleration_down_max);
    if (vehicle.acceleration_up_max)
      high_ = std::min(high_, hover + share_ * vehicle.mass * *vehicle.acceleration_up_max);
    if (!(low_ < hover && hover < high_))
      throw InputError(
          "the vehicle's limits.acceleration_up and acceleration_down must be above 0");
    torque_ = share_ * vehicle.yaw_torque_max();
    across_ = across_max_;
    if (norm_) return;
    const double squared = norm_max_ * norm_max_, middle = 0.5 * (hover + norm_max_);
    if (inscribed_) across_ /= std::sqrt(2.0);
    across_ = std::min(across_, std::sqrt((squared - middle * middle) / 2));
    high_ = std::min(high_, std::sqrt(squared - 2 * across_ * across_));
  }

  struct {
    VectorHandle force;
    NumberHandle yaw_torque;
  } in_;
  bool norm_, inscribed_;
  double share_;
  double low_ = 0, high_ = 0, across_ = 0, torque_ = 0;  // N, N, N, N m
  double norm_max_ = 1, across_max_ = 1;                 // N
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::InputLimits)
