// SPDX-License-Identifier: Apache-2.0
// How a flight begins and ends: at rest, moving, or freely.
//
//   rest:    v = 0, yaw_rate = 0, force = (0, 0, m g), yaw_torque = 0, acceleration = 0: neither
//            speed nor acceleration
//   moving:  v = the given velocity
//   free:    nothing, but a position or a yaw where one is given
//
// All of it is bounds on the first and the last stage. A model without forces is at rest when its
// velocities are zero; one with an orientation is level then, with any heading, and its body rates
// are zero: rows, because the components of an orientation are no columns.
//
//   p:add_constraint { type = "boundary_state", start = "rest", finish = "free" }
#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class BoundaryState final : public DifferentiableConstraint<BoundaryState> {
 public:
  static constexpr PluginText kText{"boundary_state", "1.0.0",
                                    "fixes the state at the start and the finish", "thesis 3.5.2"};
  static ParameterTable parameters() {
    ParameterTable table;
    for (const std::string end : {"start", "finish"})
      table.choice(end, "rest", {"rest", "moving", "free"}, "state at the " + end)
          .optional_numbers(end + "_velocity", 3, "m/s",
                            "velocity at the " + end + ", world; only with 'moving'")
          .optional_numbers(end + "_position", 3, "m", "position at the " + end + ", world")
          .optional_number(end + "_yaw", "rad", "yaw at the " + end);
    return table;
  }

  explicit BoundaryState(const Parameters& parameters)
      : ends_{read(parameters, "start"), read(parameters, "finish")} {}

  FunctionShape declare(const ProblemSetting& setting) {
    const StageLayout& layout = setting.layout;
    const bool whole = layout.find("yaw") < 0;
    std::vector<int> blocks = whole ? layout.indices({"position", "velocity", "orientation"})
                                    : layout.indices({"position", "yaw", "velocity"});
    for (const End& end : ends_)
      if (whole && !end.yaw.empty())
        throw InputError(end.name + "_yaw: this model has an orientation instead of a yaw");
    for (const char* name : {"yaw_rate", "force", "yaw_torque", "body_rates", "acceleration"})
      if (layout.find(name) >= 0 && (whole || std::string(name) != "body_rates"))
        blocks.push_back(layout.find(name));
    FunctionShape shape{.blocks = blocks,
                        .stages = {0, setting.horizon.stages - 1},
                        .affine = true,
                        .identity = true};
    for (const int b : blocks) {
      const BlockSpec& block = layout.block(b);
      for (int i = 0; i < block.size; ++i)
        shape.row_names.push_back(block.topology == Topology::line ? component_name(block, i)
                                                                   : block.name + "." + "wxyz"[i]);
    }
    shape.rows = rows_ = static_cast<int>(shape.row_names.size());
    for (End& end : ends_) fix_numbers(setting, blocks, end);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    for (int i = 0; i < rows_; ++i) rows[i] = stage.data(0)[i];  // gathered in the order of rows
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k)
      for (const double value : ends_[range.first + k].values) {
        *lower++ = std::isnan(value) ? -kInfinity : value;
        *upper++ = std::isnan(value) ? kInfinity : value;
      }
  }

 private:
  struct End {
    std::string name, kind;
    std::vector<double> velocity, position, yaw;  // empty: not given
    std::vector<double> values;                   // one per row; not a number: free
  };

  static End read(const Parameters& parameters, const std::string& name) {
    const auto given = [&](const std::string& key) -> std::vector<double> {
      if (!parameters.has(key)) return {};
      return {parameters.numbers(key).begin(), parameters.numbers(key).end()};
    };
    End end{name, parameters.text(name), given(name + "_velocity"), given(name + "_position"), {},
            {}};
    if (parameters.has(name + "_yaw")) end.yaw = {parameters.number(name + "_yaw")};
    const bool moving = end.kind == "moving";
    if (moving && end.velocity.empty())
      throw InputError(parameters.origin(name),
                       name + " = 'moving' needs " + name + "_velocity, three numbers in m/s");
    if (!moving && !end.velocity.empty())
      throw InputError(
          parameters.origin(name + "_velocity"),
          name + "_velocity applies to " + name + " = 'moving', not '" + end.kind + "'");
    return end;
  }

  static void fix_numbers(const ProblemSetting& setting, const std::vector<int>& blocks, End& end) {
    end.values.clear();
    for (const int b : blocks) {
      const BlockSpec& block = setting.layout.block(b);
      std::vector<double> value(block.size, std::numeric_limits<double>::quiet_NaN());
      if (end.kind == "rest" && block.name != "position" && block.name != "yaw")
        value.assign(block.size, 0.0);
      if (end.kind == "rest" && block.name == "orientation") {
        value.assign(block.size, std::numeric_limits<double>::quiet_NaN());
        value[1] = value[2] = 0.0;  // level, with any heading
      }
      if (end.kind == "rest" && block.name == "force") value[2] = setting.vehicle.mass * kGravity;
      if (block.name == "velocity" && !end.velocity.empty()) value = checked(setting.vehicle, end);
      if (block.name == "position" && !end.position.empty()) value = end.position;
      if (block.name == "yaw" && !end.yaw.empty()) value = end.yaw;
      end.values.insert(end.values.end(), value.begin(), value.end());
    }
  }

  static const std::vector<double>& checked(const Vehicle& vehicle, const End& end) {
    const auto& v = end.velocity;
    if (std::hypot(v[0], v[1]) > vehicle.speed_across_max || v[2] > vehicle.climb_speed_max ||
        -v[2] > vehicle.descent_speed_max)
      throw InputError(end.name + "_velocity exceeds the limits of the vehicle, " +
                       std::to_string(vehicle.speed_across_max) + " m/s across, " +
                       std::to_string(vehicle.climb_speed_max) + " m/s up and " +
                       std::to_string(vehicle.descent_speed_max) + " m/s down");
    return v;
  }

  std::array<End, 2> ends_;
  int rows_ = 0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::BoundaryState)
