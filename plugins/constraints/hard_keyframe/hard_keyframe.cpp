// SPDX-License-Identifier: Apache-2.0
// Keyframes that must be met: a block at given times, within a tolerance.
//
//   | d_k . (block(t_j) - value_j) | <= rho tolerance,   d_k: axes and diagonals of the cube
//
// The polytope lies inside the ball, with its corners on it, so that the distance itself stays
// within the tolerance and the rows stay affine; it leaves 11 % of the ball's radius unused at
// worst. With tolerance 0 the rows are the block's own numbers, as equations. Times are exact:
// between two stages the kernel reads the block off the vehicle model's flow (reading 3.1).
//
//   p:add_constraint { type = "hard_keyframe", tolerance = 0.5,
//                      keyframes = { { time = 2.5, value = {0, 0, 3} } } }
#include <numeric>

#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/timed_values.h"

namespace lapwing {
namespace {

// Axes and diagonals of the cube in n dimensions, one of each opposite pair, at unit length. Blocks
// of more than three numbers get the axes alone.
std::vector<std::vector<double>> facets(int n) {
  std::vector<std::vector<double>> result;
  int count = 1;
  for (int i = 0; i < n; ++i) count *= 3;
  for (int code = 0; n <= 3 && code < count; ++code) {
    std::vector<double> direction;
    double squares = 0;
    for (int i = 0, rest = code; i < n; ++i, rest /= 3) {
      direction.push_back(rest % 3 - 1);
      squares += std::abs(direction.back());
    }
    const auto first = std::find_if(direction.begin(), direction.end(), [](double d) { return d; });
    if (first == direction.end() || *first < 0) continue;
    for (double& d : direction) d /= std::sqrt(squares);
    result.push_back(std::move(direction));
  }
  for (int i = 0; n > 3 && i < n; ++i) {
    result.emplace_back(n, 0.0);
    result.back()[i] = 1.0;
  }
  return result;
}

// Distance of those facets from the middle when the corners are at distance 1: a corner is where
// the facets d_k of 1, ..., n coordinates (1,0,..), (1,1,0,..)/sqrt 2, ... meet.
double facet_distance(int n) {
  if (n > 3) return 1.0 / std::sqrt(n);
  double squares = 0;
  for (int k = 1; k <= n; ++k) squares += std::pow(std::sqrt(k) - std::sqrt(k - 1), 2);
  return 1.0 / std::sqrt(squares);
}

class HardKeyframe final : public DifferentiableConstraint<HardKeyframe> {
 public:
  static constexpr PluginText kText{"hard_keyframe", "1.0.0",
                                    "a block lies near given values at given times",
                                    "thesis 3.5.2, (3.4) as a constraint"};
  static ParameterTable parameters() {
    return TimedValues::table("constrained", TimedValues::entry())
        .number("tolerance", 0.0, "", "largest distance from the value, in the block's unit",
                at_least(0));
  }

  explicit HardKeyframe(const Parameters& parameters)
      : wanted_(parameters), tolerance_(parameters.number("tolerance")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.affine = true};
    block_ = wanted_.bind(setting, shape, "hold");
    if (tolerance_ > 0) facets_ = facets(block_.size());
    shape.rows = facets_.empty() ? block_.size() : static_cast<int>(facets_.size());
    shape.identity = facets_.empty();
    const BlockSpec& block = setting.layout.block(shape.blocks.front());
    for (int i = 0; i < block_.size() && facets_.empty(); ++i)
      shape.row_names.push_back(component_name(block, i));
    for (const std::vector<double>& facet : facets_) shape.row_names.push_back(name(facet, block));
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto at = stage(block_);
    for (int i = 0; i < block_.size() && facets_.empty(); ++i) rows[i] = at[i];
    for (std::size_t k = 0; k < facets_.size(); ++k) {
      T along = T(0.0);
      for (int i = 0; i < block_.size(); ++i) along += facets_[k][i] * at[i];
      rows[static_cast<int>(k)] = along;
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      const std::vector<double>& value = wanted_.value(range.first + k);
      if (facets_.empty()) {
        lower = std::copy(value.begin(), value.end(), lower);
        upper = std::copy(value.begin(), value.end(), upper);
      }
      const double half = facet_distance(block_.size()) * tolerance_;
      for (const std::vector<double>& facet : facets_) {
        const double along = std::inner_product(facet.begin(), facet.end(), value.begin(), 0.0);
        *lower++ = along - half;
        *upper++ = along + half;
      }
    }
  }

 private:
  // "position.x", "position.x-z": the direction, by its components.
  std::string name(const std::vector<double>& facet, const BlockSpec& block) const {
    if (block_.size() == 1) return wanted_.block();
    std::string result;
    for (int i = 0; i < block_.size(); ++i) {
      if (facet[i] == 0) continue;
      const std::string component = component_name(block, i);
      if (result.empty())
        result = component;
      else
        result += (facet[i] < 0 ? "-" : "+") + component.substr(component.rfind('.') + 1);
    }
    return result;
  }

  TimedValues wanted_;
  double tolerance_;
  AnyHandle block_;
  std::vector<std::vector<double>> facets_;  // none: the block's numbers are equations
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::HardKeyframe)
