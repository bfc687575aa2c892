// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/tape_function.h"

#include <algorithm>

#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

template <class Base>
class OfTape : public Base {
 public:
  explicit OfTape(TapeFunction function) : function_(std::move(function)) {}

  FunctionShape bind(const ProblemSetting& setting) override {
    FunctionShape shape{.blocks = {},
                        .window = function_.window,
                        .rows = function_.tape->rows(),
                        .times = function_.times,
                        .integral = function_.integral,
                        .affine = function_.affine,
                        .row_names = function_.row_names};
    for (const std::string& block : function_.blocks)
      shape.blocks.push_back(setting.layout.index(block));
    ask_within(shape, setting.horizon, function_.spans, function_.except);
    return shape;
  }

  void evaluate(InstanceRange range, const double* inputs, double* values, double* jacobian,
                Workspace& workspace) const override {
    function_.tape->evaluate(range.count, inputs, function_.parameters->data(), values, jacobian,
                             workspace);
  }

  void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                 double* hessian, Workspace& workspace) const override {
    function_.tape->curvature(range.count, inputs, function_.parameters->data(), multipliers,
                              hessian, workspace);
  }

  std::string written_at() const override { return function_.written_at; }

 private:
  TapeFunction function_;
};

class TapeConstraint final : public OfTape<Constraint> {
 public:
  TapeConstraint(TapeFunction function, std::vector<double> lower, std::vector<double> upper)
      : OfTape(std::move(function)), lower_(std::move(lower)), upper_(std::move(upper)) {}

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      lower = std::copy(lower_.begin(), lower_.end(), lower);
      upper = std::copy(upper_.begin(), upper_.end(), upper);
    }
  }

 private:
  std::vector<double> lower_, upper_;
};

}  // namespace

std::unique_ptr<CostTerm> tape_cost(TapeFunction function) {
  return std::make_unique<OfTape<CostTerm>>(std::move(function));
}

std::unique_ptr<Constraint> tape_constraint(TapeFunction function, std::vector<double> lower,
                                            std::vector<double> upper) {
  return std::make_unique<TapeConstraint>(std::move(function), std::move(lower), std::move(upper));
}

}  // namespace lapwing
