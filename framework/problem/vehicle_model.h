// SPDX-License-Identifier: Apache-2.0
// A vehicle model: which blocks are state and input, and how the state flows.
//
//   x+ = f(x, u, h)   with the inputs u held over h seconds (thesis 3.3)
//
// The kernel writes the rows x_{i+1} = f(x_i, u_i, h_i), and reads keyframes between two stages off
// the same flow. Models compose: a gimbal beside a quadrotor, each with blocks of its own.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/problem/constraint.h"
#include "framework/trajectory/trajectory.h"

namespace lapwing {

class VehicleModel : public PluginObject {
 public:
  using Interface = VehicleModel;
  static constexpr const char* kKind = "vehicle_model";
  virtual ~VehicleModel() = default;

  // Takes masses and the like from the vehicle. Called once, first; const and thread-safe after.
  virtual void bind(const Vehicle& vehicle) = 0;

  // State blocks first, then inputs; their order is that of `inputs` below.
  virtual std::vector<BlockSpec> blocks() const = 0;

  // Whether f is affine in (x, u) for a fixed step.
  virtual bool affine() const = 0;

  // With n numbers of state, m of input:
  //   inputs   [count][n + m + 1]  state, input, step
  //   next     [count][n]
  //   jacobian [count][n][n + m + 1], or null
  virtual void flow(InstanceRange range, const double* inputs, double* next, double* jacobian,
                    Workspace& workspace) const = 0;

  // hessian [count][n+m+1][n+m+1] += sum_n multipliers[count][n] d2 next_n.
  virtual void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                         double* hessian, Workspace& workspace) const = 0;

  // Between the model's blocks (in its order) and a sample of a trajectory. `to_sample` fills the
  // fields that the model knows, derivatives included, and the columns of its motion, and leaves
  // the others; `from_sample` is used for the initial guess, whose samples have no columns, and for
  // warm starts.
  virtual void to_sample(const double* state_and_input, Sample& sample) const = 0;
  virtual void from_sample(const Sample& sample, double* state_and_input) const = 0;

  // Values for every state and input number that nothing else bounds, to keep iterates finite, or
  // limits of the vehicle that are plain bounds: lower and upper, one number per state and input.
  virtual void bounds(double* lower, double* upper) const = 0;

  // Conditions on the model's own blocks that are no plain bounds, with their names: a lowest
  // speed. A problem holds them beside the constraints that it is given. Called once, after `bind`.
  virtual std::vector<std::pair<std::string, std::unique_ptr<Constraint>>> conditions() const {
    return {};
  }

  // Whether the vehicle can stand still in the air.
  virtual bool rests() const { return true; }

  // What the trajectory says of itself: its motion (trajectory/motion_record.h), whether inputs are
  // held, and whether it has a gimbal.
  virtual void describe(Trajectory& trajectory) const = 0;
};

}  // namespace lapwing
