// SPDX-License-Identifier: Apache-2.0
// Writes a differential equation down as the table of a motion: formulas in C++ become operations.
//
//   MotionRecorder motion;
//   const RecordedNumber v = motion.input("velocity", 0), push = motion.input("push", 0);
//   motion.rate("acceleration", 0, push - 0.1 * v * v);
//   ...
//   record.table = motion.table();
#pragma once

#include <string>

#include "framework/trajectory/motion_record.h"

namespace lapwing {

class MotionRecorder;

// The result of an operation that is not carried out yet. Of the recorder that made it, which must
// outlive it.
class RecordedNumber {
 public:
  int operation() const { return operation_; }
  MotionRecorder& recorder() const { return *recorder_; }

 private:
  friend class MotionRecorder;
  RecordedNumber(MotionRecorder& recorder, int operation)
      : recorder_(&recorder), operation_(operation) {}

  MotionRecorder* recorder_;
  int operation_;
};

class MotionRecorder {
 public:
  MotionRecorder() = default;
  MotionRecorder(const MotionRecorder&) = delete;
  MotionRecorder& operator=(const MotionRecorder&) = delete;

  // "position", "velocity", "yaw" or a column of the motion.
  RecordedNumber input(const std::string& name, int component = 0);
  RecordedNumber constant(double number);
  RecordedNumber apply(ConstraintOp op, std::initializer_list<RecordedNumber> operands,
                       double number = 0);
  // The derivative of one component: "acceleration", "yaw_rate", or a column that is a state.
  void rate(const std::string& name, int component, RecordedNumber value);

  const MotionTable& table() const { return table_; }

 private:
  MotionTable table_;
};

#define LAPWING_RECORDED_OPERATOR(symbol, op)                                 \
  inline RecordedNumber operator symbol(RecordedNumber a, RecordedNumber b) { \
    return a.recorder().apply(ConstraintOp::op, {a, b});                      \
  }                                                                           \
  inline RecordedNumber operator symbol(RecordedNumber a, double b) {         \
    return a symbol a.recorder().constant(b);                                 \
  }                                                                           \
  inline RecordedNumber operator symbol(double a, RecordedNumber b) {         \
    return b.recorder().constant(a) symbol b;                                 \
  }
LAPWING_RECORDED_OPERATOR(+, add)
LAPWING_RECORDED_OPERATOR(-, subtract)
LAPWING_RECORDED_OPERATOR(*, multiply)
LAPWING_RECORDED_OPERATOR(/, divide)
#undef LAPWING_RECORDED_OPERATOR

inline RecordedNumber operator-(RecordedNumber a) {
  return a.recorder().apply(ConstraintOp::negate, {a});
}
inline RecordedNumber sin(RecordedNumber a) {
  return a.recorder().apply(ConstraintOp::sin, {a});
}
inline RecordedNumber cos(RecordedNumber a) {
  return a.recorder().apply(ConstraintOp::cos, {a});
}
inline RecordedNumber sqrt(RecordedNumber a) {
  return a.recorder().apply(ConstraintOp::sqrt, {a});
}

}  // namespace lapwing
