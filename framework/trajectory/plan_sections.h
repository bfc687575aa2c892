// SPDX-License-Identifier: Apache-2.0
// The larger sections of plan.json. Internal to this room; callers include plan.h.
#pragma once

#include "framework/core/fields.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

inline Value list_of(std::initializer_list<double> numbers) {
  return Value(Value::List(numbers.begin(), numbers.end()));
}
inline Value list_of(const Eigen::Vector3d& v) {
  return list_of({v.x(), v.y(), v.z()});
}

// A list of subjects that is empty has no key. `format`: of the document, 1 or Plan::kFormat.
Value environment_to_value(const Environment& environment);
Environment environment_from(Fields fields, int format);

Value home_to_value(const Home& home);
Home home_from(Fields fields);

Value spans_to_value(const std::vector<TimeSpan>& cuts);
std::vector<TimeSpan> spans_from(std::vector<Fields> entries);

// Operations on earlier ones, in their order. `format`: of the document.
Value operations_to_value(const std::vector<ConstraintStep>& operations);
std::vector<ConstraintStep> operations_from(std::vector<Fields> entries, int format);

// The motion: one that has a name alone, or its columns, what follows it, and its table.
Value motion_to_value(const Trajectory& trajectory);
// Without samples.
Trajectory motion_from(Fields fields);
Value sample_to_value(const Trajectory& trajectory, const Sample& sample);
Sample sample_from(const Trajectory& trajectory, Fields fields);

// Those of the script, in its order.
Value constraints_to_value(const std::vector<StatedConstraint>& constraints);
// In format 1 a distance is to an obstacle of a kind, whose name the step keeps.
std::vector<StatedConstraint> constraints_from(std::vector<Fields> entries, int format);

// A task that asks for no framing has neither of its keys.
Value task_to_value(const Task& task);
Task task_from(Fields fields);

Value scan_to_value(const ScanTask& scan);
ScanTask scan_from(Fields fields);

}  // namespace lapwing
