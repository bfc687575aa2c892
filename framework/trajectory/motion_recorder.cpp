// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/motion_recorder.h"

#include "framework/core/error.h"

namespace lapwing {

RecordedNumber MotionRecorder::input(const std::string& name, int component) {
  ConstraintStep step;
  step.op = ConstraintOp::input;
  step.name = name;
  step.component = component;
  table_.operations.push_back(step);
  return {*this, static_cast<int>(table_.operations.size()) - 1};
}

RecordedNumber MotionRecorder::constant(double number) {
  return apply(ConstraintOp::constant, {}, number);
}

RecordedNumber MotionRecorder::apply(ConstraintOp op,
                                     std::initializer_list<RecordedNumber> operands,
                                     double number) {
  if (static_cast<int>(operands.size()) != operand_count(op))
    throw Error(std::string("a recorded '") + name_of(op) + "' takes " +
                std::to_string(operand_count(op)) + " operands");
  ConstraintStep step;
  step.op = op;
  step.number = number;
  int place = 0;
  for (const RecordedNumber& operand : operands) {
    if (&operand.recorder() != this) throw Error("an operand of another recorder");
    step.operands[place++] = operand.operation();
  }
  table_.operations.push_back(step);
  return {*this, static_cast<int>(table_.operations.size()) - 1};
}

void MotionRecorder::rate(const std::string& name, int component, RecordedNumber value) {
  if (&value.recorder() != this) throw Error("a derivative of another recorder");
  table_.rates.push_back({name, component, value.operation()});
}

}  // namespace lapwing
