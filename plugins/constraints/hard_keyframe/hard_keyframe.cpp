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
    return ParameterTable{}
        .text("block", "position", "constrained block: position, yaw, target, ...")
        .number("tolerance", 0.0, "", "largest distance from the value, in the block's unit",
                at_least(0))
        .tables("keyframes",
                ParameterTable{}
                    .required_number("time", "s", "time from the start; need not be on a stage",
                                     at_least(0))
                    .required_numbers("value", 0, "", "value, in the block's unit"),
                "times and values; at least one", true);
  }

  explicit HardKeyframe(const Parameters& parameters)
      : block_(parameters.text("block")), tolerance_(parameters.number("tolerance")) {
    for (const Parameters& given : parameters.tables("keyframes")) {
      const auto value = given.numbers("value");
      times_.push_back(given.number("time"));
      values_.emplace_back(value.begin(), value.end());
    }
    if (times_.empty())
      throw InputError(parameters.origin("keyframes"), "keyframes: expected at least one");
  }

  FunctionShape declare(const ProblemSetting& setting) {
    const BlockSpec& block = setting.layout.block(setting.layout.index(block_));
    if (block.topology != Topology::line)
      throw InputError("block '" + block_ + "' is an orientation, which keyframes cannot hold");
    for (std::size_t j = 0; j < values_.size(); ++j)
      if (static_cast<int>(values_[j].size()) != block.size)
        throw InputError("keyframe " + std::to_string(j + 1) + " has " +
                         std::to_string(values_[j].size()) + " numbers, block '" + block_ +
                         "' has " + std::to_string(block.size));
    size_ = block.size;
    if (tolerance_ > 0) facets_ = facets(size_);
    FunctionShape shape{.blocks = setting.layout.indices({block_}),
                        .rows = facets_.empty() ? size_ : static_cast<int>(facets_.size()),
                        .times = times_,
                        .affine = true,
                        .identity = facets_.empty()};
    for (int i = 0; i < size_ && facets_.empty(); ++i)
      shape.row_names.push_back(size_ == 1 ? block_ : component_name(block, i));
    for (const std::vector<double>& facet : facets_) shape.row_names.push_back(name(facet, block));
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    for (int i = 0; i < size_ && facets_.empty(); ++i) rows[i] = stage.data(0)[i];
    for (std::size_t k = 0; k < facets_.size(); ++k) {
      T along = T(0.0);
      for (int i = 0; i < size_; ++i) along += facets_[k][i] * stage.data(0)[i];
      rows[static_cast<int>(k)] = along;
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      const std::vector<double>& value = values_[range.first + k];
      if (facets_.empty()) {
        lower = std::copy(value.begin(), value.end(), lower);
        upper = std::copy(value.begin(), value.end(), upper);
      }
      const double half = facet_distance(size_) * tolerance_;
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
    if (size_ == 1) return block_;
    std::string result;
    for (int i = 0; i < size_; ++i) {
      if (facet[i] == 0) continue;
      const std::string component = component_name(block, i);
      if (result.empty())
        result = component;
      else
        result += (facet[i] < 0 ? "-" : "+") + component.substr(component.rfind('.') + 1);
    }
    return result;
  }

  std::string block_;
  double tolerance_;
  std::vector<double> times_;
  std::vector<std::vector<double>> values_;
  std::vector<std::vector<double>> facets_;  // none: the block's numbers are equations
  int size_ = 0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::HardKeyframe)
