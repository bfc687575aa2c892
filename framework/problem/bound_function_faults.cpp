// SPDX-License-Identifier: Apache-2.0
// Numbers of functions that are none: whose fault, where, and what to write instead.
#include <cmath>

#include "framework/core/number_text.h"
#include "framework/problem/bound_function.h"

namespace lapwing {
namespace {

// "position = {0, 0, 2}, yaw[1] = 0.3": what an instance reads.
std::string inputs_text(const StageLayout& layout, const FunctionShape& shape,
                        const double* inputs) {
  std::string text;
  for (int w = 0; w < shape.window; ++w)
    for (const int index : shape.blocks) {
      const BlockSpec& block = layout.block(index);
      text += (text.empty() ? "" : ", ") + block.name;
      if (w > 0) text += "[" + std::to_string(w) + "]";
      text += block.size > 1 ? " = {" : " = ";
      for (int i = 0; i < block.size; ++i) text += (i ? ", " : "") + plain_number(*inputs++);
      if (block.size > 1) text += "}";
    }
  return text;
}

}  // namespace

std::string BoundFunction::fault_of(const StageLayout& layout, int instance, int row,
                                    const char* what, const double* inputs) const {
  return written_at_ + ": " + what + " of result " + std::to_string(row + 1) + " is " +
         "not a finite number at " + plain_number(nominal_[instance]) + " s, where " +
         inputs_text(layout, shape_, inputs) +
         ": keep roots, powers, logarithms and quotients off 0; write lapwing.sqrt(lapwing.max(x, "
         "0) + 1e-6) for lapwing.sqrt(x), and lapwing.max(x, 0) + 1e-6 likewise in x ^ p, "
         "lapwing.log(x) and 1 / x";
}

// Where a problem is linearised every number counts: one that is not finite is named here, and not
// found in a matrix later.
void BoundFunction::expect_finite(const StageLayout& layout, InstanceRange range,
                                  const double* inputs, const double* values,
                                  const double* derivatives) const {
  const int m = rows(), n = derivatives ? inputs_ : 0, count = range.count * m;
  bool finite = true;
  for (int k = 0; k < count; ++k) finite &= values[k] - values[k] == 0;
  for (int k = 0; k < count * n; ++k) finite &= derivatives[k] - derivatives[k] == 0;
  if (finite) return;
  for (int k = 0; k < count; ++k) {
    bool fine = std::isfinite(values[k]);
    const char* const what = fine ? "a derivative" : "a value";
    for (int i = 0; i < n; ++i) fine &= std::isfinite(derivatives[k * n + i]);
    if (fine) continue;
    const int instance = range.first + k / m;
    if (!written_at_.empty())
      throw InputError(fault_of(layout, instance, k % m, what, inputs + k / m * inputs_));
    throw plugin_failure(
        plugin_name(), "evaluate",
        std::string(what) + " of " + row_name(instance, k % m) + " is not a finite number");
  }
}

// A row that has a value at `inputs` and, a hair to one side, none or one that leads there ever
// more steeply: as a root does at 0. -1: none.
int BoundFunction::row_without_slope(double* inputs, Workspace& workspace) const {
  constexpr double kHairs[] = {1e-6, 1e-10};
  constexpr double kSteeper = 20;  // a root's: 100
  const int m = rows();
  std::vector<double> here(m), there(m), slope(m);
  function_->evaluate({0, 1}, inputs, here.data(), nullptr, workspace);
  for (int i = 0; i < inputs_; ++i)
    for (const double side : {-1.0, 1.0}) {
      const double kept = inputs[i];
      std::fill(slope.begin(), slope.end(), 0.0);
      for (const double hair : kHairs) {
        inputs[i] = kept + side * hair;
        const double moved = std::abs(inputs[i] - kept);
        function_->evaluate({0, 1}, inputs, there.data(), nullptr, workspace);
        inputs[i] = kept;
        for (int r = 0; r < m && moved > 0; ++r) {
          if (std::isfinite(here[r]) && !std::isfinite(there[r])) return r;
          const double now = std::abs(there[r] - here[r]) / moved;
          if (hair < kHairs[0] && now > 1 && now > kSteeper * slope[r]) return r;
          slope[r] = now;
        }
      }
    }
  return -1;
}

std::string BoundFunction::fault_at(const StageColumns& columns, const Stages& at) const {
  if (written_at_.empty()) return "";
  Workspace workspace;
  std::vector<double> inputs(inputs_);
  for (int k = 0; k < instances(); ++k) {
    gather(columns, at, k, inputs.data(), nullptr);
    const int row = row_without_slope(inputs.data(), workspace);
    if (row >= 0) return fault_of(columns.layout, k, row, "the derivative", inputs.data());
  }
  return "";
}

}  // namespace lapwing
