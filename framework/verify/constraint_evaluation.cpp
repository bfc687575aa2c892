// SPDX-License-Identifier: Apache-2.0
// How: a constraint of a script is a list of operations in the plan. An operation reads numbers,
// blocks of the motion, or results of earlier operations, so one pass from the front evaluates all
// of them: `values_` has one number per operation, and the results are picked from it. problem_of
// checks the list first: an operand that is not earlier, a block that the motion lacks or a number
// that is not finite is refused, and evaluation needs no further test. The constructor finds the
// reader of each block by name once.
//
// The solver evaluates the same function on a tape of its own (framework/problem/tape.h). The two
// share the list of operations and no code.
#include "framework/verify/constraint_evaluation.h"

#include <algorithm>
#include <cmath>

#include "framework/verify/operation_value.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

// A block of a stage, read off the motion.
struct BlockReader {
  const char* name;
  int size;
  bool (*in)(const Trajectory&);
  double (*read)(const ConstraintPoint&, int);
};

bool always(const Trajectory&) {
  return true;
}
bool of_force(const Trajectory& trajectory) {
  return trajectory.motion.name == force_motion().name;
}
bool of_rotors(const Trajectory& trajectory) {
  return trajectory.motion.name == rotors_motion().name;
}
bool with_inputs(const Trajectory& trajectory) {
  return trajectory.motion.moves;
}
bool with_gimbal(const Trajectory& trajectory) {
  return trajectory.has_gimbal;
}
bool with_target(const Trajectory& trajectory) {
  return trajectory.has_target;
}

using Point = const ConstraintPoint&;
constexpr BlockReader kBlocks[] = {
    {"time", 1, always, [](Point p, int) { return p.motion.time; }},
    {"step", 1, always, [](Point p, int) { return p.step; }},
    {"position", 3, always, [](Point p, int k) { return p.motion.position(k); }},
    {"yaw", 1, always, [](Point p, int) { return p.motion.yaw; }},
    {"velocity", 3, with_inputs, [](Point p, int k) { return p.motion.velocity(k); }},
    {"acceleration", 3, with_inputs, [](Point p, int k) { return p.motion.acceleration(k); }},
    {"yaw_rate", 1, with_inputs, [](Point p, int) { return p.motion.yaw_rate; }},
    {"force", 3, of_force, [](Point p, int k) { return p.motion.force(k); }},
    {"yaw_torque", 1, of_force, [](Point p, int) { return p.motion.yaw_torque; }},
    {"orientation", 4, of_rotors,
     [](Point p, int k) {
       const Eigen::Quaterniond& q = p.motion.orientation;
       return k == 0 ? q.w() : k == 1 ? q.x() : k == 2 ? q.y() : q.z();
     }},
    {"body_rates", 3, of_rotors, [](Point p, int k) { return p.motion.body_rates(k); }},
    {"rotor_thrusts", 4, of_rotors, [](Point p, int k) { return p.motion.rotor_thrusts(k); }},
    {"gimbal_yaw", 1, with_gimbal, [](Point p, int) { return p.motion.gimbal_yaw; }},
    {"gimbal_pitch", 1, with_gimbal, [](Point p, int) { return p.motion.gimbal_pitch; }},
    {"gimbal_yaw_rate", 1, with_gimbal, [](Point p, int) { return p.motion.gimbal_yaw_rate; }},
    {"gimbal_pitch_rate", 1, with_gimbal, [](Point p, int) { return p.motion.gimbal_pitch_rate; }},
    {"target", 3, with_target, [](Point p, int k) { return p.target(k); }},
};

const BlockReader* block_named(const std::string& name, const Trajectory& trajectory) {
  for (const BlockReader& block : kBlocks)
    if (name == block.name && block.in(trajectory)) return &block;
  return nullptr;
}

// Where the numbers of a motion's own column begin in a point; -1 where it has none of that name.
int column_place(const std::string& name, const Trajectory& trajectory) {
  if (named_motion(trajectory.motion.name)) return -1;  // points have fields for theirs
  int place = 0;
  for (const MotionColumn& column : trajectory.motion.columns) {
    if (column.name == name) return place;
    place += column.size;
  }
  return -1;
}

// Numbers of what an input reads; 0 where the motion does not have it.
int input_size(const std::string& name, const Trajectory& trajectory) {
  if (const BlockReader* block = block_named(name, trajectory)) return block->size;
  return column_place(name, trajectory) < 0 ? 0 : trajectory.motion.column(name)->size;
}

std::string place(std::size_t operation) {
  return ": operation " + std::to_string(operation) + " ";
}

// What is wrong with one operation, to be read after "operation 3 ".
std::string fault_of(const ConstraintStep& step, std::size_t at, const Plan& plan) {
  const auto kind = static_cast<std::size_t>(step.op);
  if (kind >= static_cast<std::size_t>(kConstraintOps)) return "is unknown";
  if (!std::isfinite(step.number)) return "holds a number that is not finite";
  for (int k = 0; k < operand_count(step.op); ++k)
    if (step.operands[k] < 0 || static_cast<std::size_t>(step.operands[k]) >= at)
      return "reads operation " + std::to_string(step.operands[k]) + ", which is not before it";
  const bool rounds = step.op == ConstraintOp::absolute || step.op == ConstraintOp::norm ||
                      step.op == ConstraintOp::maximum;
  if (rounds && step.number < 0) return "has a width below 0";
  if (step.op == ConstraintOp::input) {
    const int size = input_size(step.name, plan.trajectory);
    if (size == 0) return "reads '" + step.name + "', which the motion does not have";
    if (step.component < 0 || step.component >= size)
      return "reads component " + std::to_string(step.component) + " of '" + step.name + "'";
    if (step.later < 0 || step.later > StatedConstraint::kMostLater)
      return "reads a sample " + std::to_string(step.later) + " later";
  }
  if (step.op == ConstraintOp::subject) {
    const auto& subjects = plan.environment.subjects;
    if (std::none_of(subjects.begin(), subjects.end(),
                     [&](const Subject& subject) { return subject.name == step.name; }))
      return "reads the subject '" + step.name + "', which the environment lacks";
    if (step.component < 0 || step.component > 2) return "reads no component of a position";
  }
  if (step.op == ConstraintOp::distance) {
    if (!(step.number > 0)) return "has a reach that is not above 0";
    if (step.component < 0 ||
        static_cast<std::size_t>(step.component) >= plan.environment.obstacles.size())
      return "measures to obstacle " + std::to_string(step.component) +
             ", which the environment lacks";
  }
  return "";
}

std::string fault_of(const ConstraintResult& result, std::size_t operations) {
  if (result.operation < 0 || static_cast<std::size_t>(result.operation) >= operations)
    return "is of operation " + std::to_string(result.operation) + ", which does not exist";
  for (const auto& bound : {result.lower, result.upper})
    if (bound && !std::isfinite(*bound)) return "has a bound that is not finite";
  if (!result.lower && !result.upper) return "has no bound";
  if (result.lower && result.upper && *result.lower > *result.upper)
    return "has its lower bound above its upper one";
  return "";
}

bool sound_time(double time) {
  return time >= 0 && time <= tolerances::kLargestNumber;
}

}  // namespace

std::string problem_of(const StatedConstraint& constraint, const Plan& plan) {
  if (constraint.name.empty()) return " has no name";
  if (!constraint.unjudged.empty()) return "";
  const std::size_t count = constraint.operations.size();
  if (count > StatedConstraint::kMostOperations)
    return " takes " + std::to_string(count) + " operations, more than " +
           std::to_string(StatedConstraint::kMostOperations);
  if (constraint.results.empty()) return " has no result";
  if (constraint.results.size() > StatedConstraint::kMostResults) return " has too many results";
  for (std::size_t i = 0; i < count; ++i)
    if (const std::string fault = fault_of(constraint.operations[i], i, plan); !fault.empty())
      return place(i) + fault;
  for (std::size_t r = 0; r < constraint.results.size(); ++r)
    if (const std::string fault = fault_of(constraint.results[r], count); !fault.empty())
      return ": result " + std::to_string(r) + " " + fault;
  for (const double time : constraint.times)
    if (!sound_time(time)) return " is evaluated at an invalid time";
  for (const auto* spans : {&constraint.spans, &constraint.except})
    for (const TimeSpan& span : *spans)
      if (!sound_time(span.start) || !sound_time(span.finish) || span.start > span.finish)
        return " is evaluated in a span that ends before it begins";
  return "";
}

ConstraintEvaluation::ConstraintEvaluation(const StatedConstraint& constraint,
                                           const Trajectory& trajectory,
                                           const ConstraintSurroundings& surroundings)
    : constraint_(constraint),
      surroundings_(surroundings),
      readers_(constraint.operations.size(), nullptr),
      columns_(constraint.operations.size(), -1),
      subjects_(constraint.operations.size(), nullptr),
      values_(constraint.operations.size(), 0.0) {
  for (std::size_t i = 0; i < constraint.operations.size(); ++i) {
    const ConstraintStep& step = constraint.operations[i];
    if (step.op == ConstraintOp::input) {
      if (const BlockReader* block = block_named(step.name, trajectory))
        readers_[i] = block->read;
      else
        columns_[i] = column_place(step.name, trajectory) + step.component;
      window_ = std::max(window_, step.later + 1);
    }
    if (step.op != ConstraintOp::subject) continue;
    for (const Subject& subject : surroundings.environment.subjects)
      if (subject.name == step.name) subjects_[i] = &subject;
  }
}

void ConstraintEvaluation::evaluate(std::span<const ConstraintPoint> points,
                                    std::span<double> results) {
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = value_of(i, points);
  for (std::size_t r = 0; r < results.size(); ++r)
    results[r] = values_[static_cast<std::size_t>(constraint_.results[r].operation)];
}

double ConstraintEvaluation::value_of(std::size_t operation,
                                      std::span<const ConstraintPoint> points) const {
  const ConstraintStep& step = constraint_.operations[operation];
  const auto operand = [&](int k) { return values_[static_cast<std::size_t>(step.operands[k])]; };
  switch (step.op) {
    case ConstraintOp::input:
      return input_value(operation, points[static_cast<std::size_t>(step.later)]);
    case ConstraintOp::subject:
      return subjects_[operation]->position(operand(0))(step.component);
    case ConstraintOp::distance:
      return distance_of(step, {operand(0), operand(1), operand(2)}, points[0].motion.time);
    default:
      return operation_value(step, values_);
  }
}

double ConstraintEvaluation::input_value(std::size_t operation,
                                         const ConstraintPoint& point) const {
  if (columns_[operation] < 0)
    return readers_[operation](point, constraint_.operations[operation].component);
  return point.motion.columns[static_cast<std::size_t>(columns_[operation])];
}

double ConstraintEvaluation::distance_of(const ConstraintStep& step, const Eigen::Vector3d& p_W,
                                         double time) const {
  if (!p_W.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const auto index = static_cast<std::size_t>(step.component);
  const double reach = step.number;
  const Obstacle& obstacle = surroundings_.environment.obstacles[index];
  return std::min(reach, surroundings_.shapes[index]->distance(p_W - obstacle.moved(time), reach));
}

}  // namespace lapwing
