// SPDX-License-Identifier: Apache-2.0
// The motion and the samples in plan.json.
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

const std::vector<std::string> kInputs{"held", "linear"};
const std::vector<std::string> kRoles{"state", "input"};
const std::vector<std::string> kTracked{"none", "force", "rotors", "acceleration"};

Value table_to_value(const MotionTable& table) {
  Value value = Value::map();
  value.set("operations", operations_to_value(table.operations));
  Value& rates = value.set("rates", Value::list());
  for (const MotionRate& rate : table.rates) {
    Value one = Value::map();
    one.set("name", rate.name);
    one.set("component", rate.component);
    one.set("of", rate.operation);
    rates.push_back(std::move(one));
  }
  return value;
}

MotionTable table_from(Fields fields) {
  MotionTable table;
  table.operations = operations_from(fields.tables("operations"), Plan::kFormat);
  for (Fields& entry : fields.tables("rates")) {
    MotionRate rate;
    rate.name = entry.text("name");
    rate.component = entry.integer("component", 0, MotionColumn::kLargest - 1);
    rate.operation = entry.integer("of", 0, StatedConstraint::kMostOperations);
    table.rates.push_back(rate);
    entry.finish();
  }
  fields.finish();
  return table;
}

void columns_to_value(const MotionRecord& motion, Value& value) {
  Value& columns = value.set("columns", Value::list());
  for (const MotionColumn& column : motion.columns) {
    Value one = Value::map();
    one.set("name", column.name);
    one.set("unit", column.unit);
    one.set("size", column.size);
    one.set("role", kRoles[column.input ? 1 : 0]);
    columns.push_back(std::move(one));
  }
  value.set("tracked", kTracked[static_cast<std::size_t>(motion.tracked)]);
  if (motion.table) value.set("derivatives", table_to_value(*motion.table));
}

// Of a motion that is more than its name.
void columns_from(Fields& fields, MotionRecord& motion) {
  for (Fields& entry : fields.tables("columns")) {
    MotionColumn column;
    column.name = entry.text("name");
    column.unit = entry.text("unit");
    column.size = entry.integer("size", 1, MotionColumn::kLargest);
    column.input = entry.choice("role", kRoles) == 1;
    motion.columns.push_back(column);
    entry.finish();
  }
  motion.tracked = static_cast<Tracking>(fields.choice("tracked", kTracked));
  if (fields.has("derivatives")) motion.table = table_from(fields.table("derivatives"));
}

}  // namespace

Value motion_to_value(const Trajectory& trajectory) {
  Value value = Value::map();
  value.set("model", trajectory.motion.name);
  value.set("inputs", kInputs[trajectory.inputs_held ? 0 : 1]);
  value.set("gimbal", trajectory.has_gimbal);
  value.set("target", trajectory.has_target);
  if (!named_motion(trajectory.motion.name)) columns_to_value(trajectory.motion, value);
  return value;
}

Trajectory motion_from(Fields fields) {
  Trajectory trajectory;
  const std::string name = fields.text("model");
  trajectory.inputs_held = fields.choice("inputs", kInputs) == 0;
  trajectory.has_gimbal = fields.boolean("gimbal");
  trajectory.has_target = fields.boolean("target");
  if (const MotionRecord* known = named_motion(name)) {
    trajectory.motion = *known;
  } else {
    trajectory.motion = {.name = name};
    if (fields.has("model") && !fields.has("columns"))
      fields.add_error("model", "'" + name +
                                    "' is not force, rotors or path: another motion states its "
                                    "columns");
    else
      columns_from(fields, trajectory.motion);
    if (fields.has("columns"))
      for (const std::string& problem : problems_of(trajectory.motion))
        fields.add_error("columns", problem);
  }
  fields.finish();
  return trajectory;
}

Value sample_to_value(const Trajectory& trajectory, const Sample& s) {
  Value value = Value::map();
  value.set("time", s.time);
  value.set("position", list_of(s.position));
  if (trajectory.motion.moves) {
    value.set("velocity", list_of(s.velocity));
    value.set("acceleration", list_of(s.acceleration));
  }
  value.set("yaw", s.yaw);
  if (trajectory.motion.moves) value.set("yaw_rate", s.yaw_rate);
  for (const MotionColumn& column : trajectory.motion.columns) {
    std::vector<double> numbers(static_cast<std::size_t>(column.size), 0.0);
    const auto stated = s.columns.find(column.name);
    if (stated.size() == numbers.size()) numbers.assign(stated.begin(), stated.end());
    if (column.size == 1)
      value.set(column.name, numbers[0]);
    else
      value.set(column.name, Value(Value::List(numbers.begin(), numbers.end())));
  }
  if (trajectory.has_gimbal) {
    value.set("gimbal_yaw", s.gimbal_yaw);
    value.set("gimbal_pitch", s.gimbal_pitch);
    value.set("gimbal_yaw_rate", s.gimbal_yaw_rate);
    value.set("gimbal_pitch_rate", s.gimbal_pitch_rate);
  }
  if (trajectory.has_target) value.set("target", list_of(s.target));
  return value;
}

Sample sample_from(const Trajectory& trajectory, Fields fields) {
  Sample s;
  s.time = fields.number("time");
  s.position = fields.vector3("position");
  s.yaw = fields.number("yaw");
  if (trajectory.motion.moves) {
    s.velocity = fields.vector3("velocity");
    s.acceleration = fields.vector3("acceleration");
    s.yaw_rate = fields.number("yaw_rate");
  }
  for (const MotionColumn& column : trajectory.motion.columns) {
    if (column.size == 1)
      s.columns.set(column.name, fields.number(column.name));
    else
      s.columns.set(column.name, fields.numbers(column.name, column.size));
  }
  if (trajectory.has_gimbal) {
    s.gimbal_yaw = fields.number("gimbal_yaw");
    s.gimbal_pitch = fields.number("gimbal_pitch");
    s.gimbal_yaw_rate = fields.number("gimbal_yaw_rate");
    s.gimbal_pitch_rate = fields.number("gimbal_pitch_rate");
  }
  if (trajectory.has_target) s.target = fields.vector3("target");
  fields.finish();
  return s;
}

}  // namespace lapwing
