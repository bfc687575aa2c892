// SPDX-License-Identifier: Apache-2.0
// The points at which a recorded term is compared with what it was recorded from: plain numbers for
// every block and parameter that it reads.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "framework/core/random.h"
#include "framework/symbolic/term_formula.h"

namespace lapwing {

class TrialPoint {
 public:
  static constexpr int kSeeded = 32;

  // The formula outlives it.
  explicit TrialPoint(const TermFormula& formula) : formula_(formula) {}

  // The next point: one of `kSeeded` seeded ones, then with every number set to `literal`, or with
  // those of a stage of the guess (a column a stage).
  void begin(int point);
  void begin(int point, double literal);
  void begin(int point, const Eigen::MatrixXd& guess, int stage);

  // Of a block, `stage` places after the first of the window. Unit quaternions are of length 1.
  const std::vector<double>& numbers(int stage, int block);
  // Of all parameters, as TermParameters::values.
  const std::vector<double>& parameters() const { return point_parameters_; }
  // "position = {1 2 3}, yaw[1] = 0": every block that was asked for.
  std::string text() const;

 private:
  const TermFormula& formula_;
  std::map<std::pair<int, int>, std::vector<double>> numbers_;  // by stage and block
  std::vector<double> point_parameters_;
  Random random_{1};
  int point_ = 0;
  std::optional<double> literal_;           // every number of this point
  const Eigen::MatrixXd* guess_ = nullptr;  // the point is this stage of it, where that is one
  int guess_stage_ = -1;
};

// How the term at the point differs from `rows`, which it was recorded from, in words; empty where
// it does not. `finite` notes the rows that both have as finite numbers.
std::string difference_at(TrialPoint& point, const TermFormula& formula, const TapeFunction& term,
                          const SymbolicEntries& rows, std::vector<bool>& finite);

}  // namespace lapwing
