// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/motion_record.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace lapwing {
namespace {

// What samples and problems name already.
constexpr std::array<std::string_view, 15> kTakenNames{
    "time",     "step",       "position",     "velocity",        "acceleration",      "yaw",
    "yaw_rate", "gimbal_yaw", "gimbal_pitch", "gimbal_yaw_rate", "gimbal_pitch_rate", "target",
    "columns",  "model",      "inputs"};

bool is_snake_case(std::string_view name) {
  if (name.empty() || name.front() < 'a' || name.front() > 'z') return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

class RecordCheck {
 public:
  explicit RecordCheck(const MotionRecord& motion) : motion_(motion) {}

  std::vector<std::string> problems() {
    if (!is_snake_case(motion_.name)) add("its name '" + motion_.name + "' is not in snake_case");
    columns();
    if (motion_.table) operations(), rates();
    return std::move(problems_);
  }

 private:
  void add(std::string problem) { problems_.push_back(std::move(problem)); }

  void columns() {
    for (std::size_t i = 0; i < motion_.columns.size(); ++i) {
      const MotionColumn& column = motion_.columns[i];
      const std::string what = "column '" + column.name + "'";
      if (!is_snake_case(column.name)) add(what + " is not in snake_case");
      if (std::count(kTakenNames.begin(), kTakenNames.end(), column.name))
        add(what + " has a name that every sample has");
      for (std::size_t k = 0; k < i; ++k)
        if (motion_.columns[k].name == column.name) add(what + " stands there twice");
      if (column.size < 1 || column.size > MotionColumn::kLargest)
        add(what + " has " + std::to_string(column.size) + " numbers, expected 1 to " +
            std::to_string(MotionColumn::kLargest));
    }
  }

  // Of an input of an operation; 0 where there is none.
  int size_of(const std::string& name) const {
    if (name == "position" || name == "velocity") return 3;
    if (name == "yaw") return 1;
    const MotionColumn* column = motion_.column(name);
    return column ? column->size : 0;
  }

  void operations() {
    const auto& operations = motion_.table->operations;
    for (std::size_t i = 0; i < operations.size(); ++i) {
      const ConstraintStep& step = operations[i];
      const std::string what = "operation " + std::to_string(i) + " of its derivatives ";
      for (int k = 0; k < operand_count(step.op); ++k)
        if (step.operands[k] < 0 || static_cast<std::size_t>(step.operands[k]) >= i)
          add(what + "reads operation " + std::to_string(step.operands[k]) +
              ", which is not before it");
      if (!std::isfinite(step.number)) add(what + "holds a number that is not finite");
      if (step.op == ConstraintOp::subject || step.op == ConstraintOp::distance)
        add(what + "reads the environment, which a motion cannot");
      if (step.op != ConstraintOp::input) continue;
      if (size_of(step.name) == 0)
        add(what + "reads '" + step.name + "', which the motion does not have");
      else if (step.component < 0 || step.component >= size_of(step.name))
        add(what + "reads component " + std::to_string(step.component) + " of '" + step.name + "'");
      if (step.later != 0) add(what + "reads a later sample");
    }
  }

  void rates() {
    std::map<std::pair<std::string, int>, int> wanted;
    for (int i = 0; i < 3; ++i) wanted[{"acceleration", i}] = 0;
    wanted[{"yaw_rate", 0}] = 0;
    for (const MotionColumn& column : motion_.columns)
      for (int i = 0; i < column.size && !column.input; ++i) wanted[{column.name, i}] = 0;
    const auto count = static_cast<int>(motion_.table->operations.size());
    for (const MotionRate& rate : motion_.table->rates) {
      const std::string what =
          "derivative '" + rate.name + "', component " + std::to_string(rate.component) + ",";
      const auto found = wanted.find({rate.name, rate.component});
      if (found == wanted.end())
        add(what +
            " is not of a quantity that changes: expected acceleration, yaw_rate and the columns "
            "that are states");
      else if (found->second++ > 0)
        add(what + " stands there twice");
      if (rate.operation < 0 || rate.operation >= count)
        add(what + " is of operation " + std::to_string(rate.operation) + ", which does not exist");
    }
    for (const auto& [key, times] : wanted)
      if (times == 0)
        add("its derivatives lack '" + key.first + "', component " + std::to_string(key.second));
  }

  const MotionRecord& motion_;
  std::vector<std::string> problems_;
};

}  // namespace

const MotionColumn* MotionRecord::column(std::string_view wanted) const {
  for (const MotionColumn& column : columns)
    if (column.name == wanted) return &column;
  return nullptr;
}

std::vector<std::string> component_names(const MotionColumn& column) {
  if (column.size == 1) return {column.name};
  std::string axes = column.size == 3 ? "xyz" : column.name == "orientation" ? "wxyz" : "";
  std::vector<std::string> names;
  std::string one = column.name;  // of rotor_thrusts each is a rotor_thrust
  if (axes.empty() && one.size() > 1 && one.back() == 's') one.pop_back();
  for (int i = 0; i < column.size; ++i)
    names.push_back(
        one + "_" +
        (axes.empty() ? std::to_string(i + 1) : std::string(1, axes[static_cast<std::size_t>(i)])));
  return names;
}

const MotionRecord& force_motion() {
  static const MotionRecord motion{
      .name = "force",
      .columns = {{"force", "N", 3, true}, {"yaw_torque", "N m", 1, true}},
      .tracked = Tracking::force};
  return motion;
}

const MotionRecord& rotors_motion() {
  static const MotionRecord motion{.name = "rotors",
                                   .columns = {{"orientation", "1", 4, false},
                                               {"body_rates", "rad/s", 3, false},
                                               {"rotor_thrusts", "N", 4, true}},
                                   .tracked = Tracking::rotors};
  return motion;
}

const MotionRecord& path_motion() {
  static const MotionRecord motion{.name = "path", .moves = false};
  return motion;
}

const MotionRecord* named_motion(std::string_view name) {
  for (const MotionRecord* motion : {&force_motion(), &rotors_motion(), &path_motion()})
    if (motion->name == name) return motion;
  return nullptr;
}

std::vector<std::string> problems_of(const MotionRecord& motion) {
  return RecordCheck(motion).problems();
}

}  // namespace lapwing
