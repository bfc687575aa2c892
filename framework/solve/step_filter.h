// SPDX-License-Identifier: Apache-2.0
// The filter of a line search: pairs of violation and barrier cost that a step must improve on in
// one of both (Waechter and Biegler 2006, 2.3). Internal to the room.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lapwing {

class StepFilter {
 public:
  // For a barrier cost with another parameter: nothing is remembered. `violation`: of the start.
  void reset(double violation) {
    entries_.clear();
    most_ = kMost * std::max(1.0, violation);
    little_ = kLittle * std::max(1.0, violation);
  }

  // Whether a step of length `alpha` is taken, from {violation, cost} to {new violation, new cost}.
  // `slope`: of the cost along the whole step. Remembers where it comes from, where it must.
  bool accept(double alpha, double slope, double violation, double cost, double new_violation,
              double new_cost) {
    if (!std::isfinite(new_violation) || !std::isfinite(new_cost) || new_violation > most_)
      return false;
    const double noise = kRounding * (1.0 + std::abs(cost));
    for (const auto& [v, c] : entries_)
      if (new_violation >= v && new_cost >= c + noise) return false;
    const bool descends = slope < 0 && alpha * std::pow(-slope, 2.3) > std::pow(violation, 1.1);
    if (violation <= little_ && descends) return new_cost <= cost + kArmijo * alpha * slope + noise;
    if (new_violation > (1 - kShare) * violation && new_cost > cost - kShare * violation + noise)
      return false;
    entries_.emplace_back((1 - kShare) * violation, cost - kShare * violation);
    return true;
  }

 private:
  static constexpr double kMost = 1e4, kLittle = 1e-4;  // times the first violation
  static constexpr double kShare = 1e-5;                // of the violation, that must be gained
  static constexpr double kArmijo = 1e-4;               // of the promised decrease
  static constexpr double kRounding = 1e-13;

  std::vector<std::pair<double, double>> entries_;
  double most_ = std::numeric_limits<double>::infinity(), little_ = 0;
};

}  // namespace lapwing
