// SPDX-License-Identifier: Apache-2.0
// Functions of a few neighbouring stages: the form of every cost term and constraint.
//
//   y_k = f_k(x_i, ..., x_{i+window-1}),   k one *instance*, i its first stage
//
// Two layers. This is the virtual one: one call evaluates a range of instances, the kernel gathers
// the blocks that were asked for and scatters the small dense Jacobians. Authors mostly use the
// layer above, `differentiable.h`, and write only the formula.
//
// Life cycle: created from its parameters, bound once to a problem (`bind`), const afterwards.
// evaluate and curvature are called from several threads at once, each with its own Workspace; they
// neither allocate nor throw, and the values do not depend on whether derivatives were asked.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/problem/block.h"
#include "framework/problem/horizon.h"
#include "framework/trajectory/environment.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// What a function may look at when it is bound.
struct ProblemSetting {
  const StageLayout& layout;
  const Horizon& horizon;
  const Vehicle& vehicle;
  const Environment& environment;
};

struct FunctionShape {
  std::vector<int> blocks = {};  // layout indices of the blocks read, in the order gathered
  int window = 1;                // neighbouring stages read by one instance
  int rows = 0;                  // results of one instance; 0: it has nothing to say here at all
  // Which instances there are. Both empty: one for every window inside the horizon. `stages`: the
  // first stage of each. `times` (window 1 only): one at each time, in s; between two stages the
  // kernel reads states off the vehicle model's flow, inputs as held, free blocks linearly. Where
  // steps are free each must be the end of a leg by its first guess, and stays on that stage.
  std::vector<int> stages = {};
  std::vector<double> times = {};
  // A cost that stands for an integral over time: the kernel weights each instance by its step, so
  // that weights do not depend on the number of stages.
  bool integral = false;
  bool affine = false;  // the Jacobian is constant, the curvature zero
  // Constraints only: the results are the gathered inputs themselves, in order. The kernel turns
  // such rows into bounds on variables.
  bool identity = false;
  std::vector<std::string> row_names = {};  // "x", "y", "z"; empty: numbered
};

// Scratch memory of one thread: grows on first use, never shrinks.
class Workspace {
 public:
  // `count` doubles, uninitialised, valid until the next call with the same `slot`. A function has
  // slots 0 and 1 to itself; 2 and 3 are the kernel's, which keeps its arguments there.
  double* doubles(int slot, std::size_t count) {
    auto& buffer = buffers_[slot];
    if (buffer.size() < count) buffer.resize(count);
    return buffer.data();
  }

 private:
  std::vector<double> buffers_[4];
};

// Instances [first, first + count).
struct InstanceRange {
  int first = 0;
  int count = 0;
};

class StageFunction : public PluginObject {
 public:
  virtual ~StageFunction() = default;

  // Called once, before anything else. InputError when the parameters do not fit the problem.
  virtual FunctionShape bind(const ProblemSetting& setting) = 0;

  // With n = window * (sum of block sizes) inputs and m = rows, all row-major per instance:
  //   inputs   [count][n]  stage by stage, in each the blocks in the order of the shape
  //   values   [count][m]
  //   jacobian [count][m][n], or null; written whole, zeros included
  virtual void evaluate(InstanceRange range, const double* inputs, double* values, double* jacobian,
                        Workspace& workspace) const = 0;

  // hessian [count][n][n] += sum_m multipliers[count][m] d2 values_m / d inputs^2 (symmetric, both
  // halves). Called only where the shape is not affine.
  virtual void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                         double* hessian, Workspace& workspace) const = 0;

  // Of a function of a script where it stands and what it is, "shot.lua:12: cost 'keep_low'"; of a
  // plugin's nothing.
  virtual std::string written_at() const { return {}; }
};

}  // namespace lapwing
