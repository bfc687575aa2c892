// SPDX-License-Identifier: Apache-2.0
// A plan's samples as comma-separated values, one row a sample.
//
//   lapwing export out/hello/plan.json --format csv -o hello.csv
#include <charconv>

#include "framework/export/exporter.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class Csv final : public Exporter {
 public:
  static constexpr PluginText kText{"csv", "1.0.0",
                                    "samples as comma-separated values, with names and units", ""};
  static ParameterTable parameters() { return {}; }
  explicit Csv(const Parameters&) {}

  std::string file_extension() const override { return ".csv"; }

  std::string write(const Plan& plan) const override {
    const std::vector<Column> columns = columns_of(plan.trajectory);
    std::string out;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      out += (k ? "," : "") + columns[k].name + " [" + columns[k].unit + "]";
    }
    out += '\n';
    for (const Sample& sample : plan.trajectory.samples) {
      for (std::size_t k = 0; k < columns.size(); ++k) {
        if (k) out += ',';
        append(out, columns[k].value(sample));
      }
      out += '\n';
    }
    return out;
  }

 private:
  struct Column {
    std::string name, unit;
    std::function<double(const Sample&)> value;
  };

  // The shortest text that reads back as the same number.
  static void append(std::string& out, double number) {
    char buffer[32];
    const auto result = std::to_chars(buffer, buffer + sizeof buffer, number);
    out.append(buffer, result.ptr);
  }

  static void add(std::vector<Column>& columns, const char* name, const char* unit,
                  double Sample::*member) {
    columns.push_back({name, unit, [member](const Sample& s) { return s.*member; }});
  }

  static void add(std::vector<Column>& columns, const std::string& name, const char* unit,
                  Eigen::Vector3d Sample::*member) {
    for (int axis = 0; axis < 3; ++axis) {
      columns.push_back({name + "_" + "xyz"[axis], unit,
                         [member, axis](const Sample& s) { return (s.*member)[axis]; }});
    }
  }

  // Those of the motion, with the units that it states.
  static void add_columns(std::vector<Column>& columns, const MotionRecord& motion) {
    for (const MotionColumn& column : motion.columns) {
      const std::vector<std::string> names = component_names(column);
      for (std::size_t i = 0; i < names.size(); ++i)
        columns.push_back({names[i], column.unit, [name = column.name, i](const Sample& s) {
                             const auto values = s.columns.find(name);
                             return i < values.size() ? values[i] : 0.0;
                           }});
    }
  }

  // Only what the plan has.
  static std::vector<Column> columns_of(const Trajectory& trajectory) {
    std::vector<Column> columns;
    const bool moves = trajectory.motion.moves;
    add(columns, "time", "s", &Sample::time);
    add(columns, "position", "m", &Sample::position);
    if (moves) add(columns, "velocity", "m/s", &Sample::velocity);
    if (moves) add(columns, "acceleration", "m/s^2", &Sample::acceleration);
    add(columns, "yaw", "rad", &Sample::yaw);
    if (moves) add(columns, "yaw_rate", "rad/s", &Sample::yaw_rate);
    add_columns(columns, trajectory.motion);
    if (trajectory.has_gimbal) {
      add(columns, "gimbal_yaw", "rad", &Sample::gimbal_yaw);
      add(columns, "gimbal_pitch", "rad", &Sample::gimbal_pitch);
      add(columns, "gimbal_yaw_rate", "rad/s", &Sample::gimbal_yaw_rate);
      add(columns, "gimbal_pitch_rate", "rad/s", &Sample::gimbal_pitch_rate);
    }
    if (trajectory.has_target) add(columns, "target", "m", &Sample::target);
    return columns;
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Csv)
