// SPDX-License-Identifier: Apache-2.0
// The verifier's own reading of a constraint that a script states: the operations that the plan
// holds, one after the other. trajectory/README.md says what each gives.
//
// Internal to this room.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/trajectory/plan.h"
#include "framework/verify/judged_shape.h"
#include "framework/verify/motion.h"

namespace lapwing {

// The flight at one time, as a constraint reads it.
struct ConstraintPoint {
  MotionPoint motion;
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // m, where the plan has one
  double step = 0;                                   // s, from its sample to the next
};

// What a distance is measured to.
struct ConstraintSurroundings {
  const Environment& environment;
  const std::vector<std::unique_ptr<JudgedShape>>& shapes;  // of its obstacles
};

// Why the constraint cannot be evaluated for this plan: operations that do not exist or read what
// comes later, numbers that are not finite, blocks, subjects or obstacles that the plan lacks.
// Empty where it can.
std::string problem_of(const StatedConstraint& constraint, const Plan& plan);

class ConstraintEvaluation {
 public:
  // Of a constraint without problems; keeps references to all of it.
  ConstraintEvaluation(const StatedConstraint& constraint, const Trajectory& trajectory,
                       const ConstraintSurroundings& surroundings);

  // Samples that it reads, its own one included.
  int window() const { return window_; }

  // `points[k]`: the flight k samples later. Writes one number for each result.
  void evaluate(std::span<const ConstraintPoint> points, std::span<double> results);

 private:
  double value_of(std::size_t operation, std::span<const ConstraintPoint> points) const;
  double input_value(std::size_t operation, const ConstraintPoint& point) const;
  double distance_of(const ConstraintStep& step, const Eigen::Vector3d& p_W, double time) const;

  const StatedConstraint& constraint_;
  ConstraintSurroundings surroundings_;
  int window_ = 1;
  std::vector<double (*)(const ConstraintPoint&, int)> readers_;  // of inputs; else null
  std::vector<int> columns_;  // of inputs that are columns of the motion: their place; else -1
  std::vector<const Subject*> subjects_;  // of subjects; else null
  std::vector<double> values_;            // of all operations
};

}  // namespace lapwing
