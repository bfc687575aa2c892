// SPDX-License-Identifier: Apache-2.0
// A quadratic program that is much like one solved before, from the bounds that held there.
//
// Primal-dual active sets (Hintermueller, Ito and Kunisch, SIAM J. Optim. 13, 2003): bounds that
// push are taken as equations, all others left out, and one linear system gives point and
// multipliers. Bounds that the point breaks are then taken in, those that pull are let go, until
// the set stays as it is: the point is then optimal. This is Newton's method on the conditions of
// optimality. Near an earlier solution it takes one to three systems, where an interior point takes
// ten or more, and far from one it may never settle: then nothing is returned.
//
// A set may ask for more than there are variables, when a keyframe between bounds that all pushed
// was moved. Its bounds are then asked for softly, by a quadratic penalty: those that pull are let
// go by their signs as before, and the next system is exact again.
#pragma once

#include <optional>
#include <vector>

#include "framework/solve/equilibration.h"
#include "framework/solve/interior_point.h"
#include "framework/solve/kkt_system.h"

namespace lapwing {

// Not thread-safe; one per thread. Keeps memory between solves.
class ActiveSet {
 public:
  // `near` has a number for every variable and row. The result is optimal, with residuals within
  // the tolerance of the options; nothing where the set does not settle, or on cancellation.
  std::optional<QuadraticResult> solve(const QuadraticProgram& problem,
                                       const InteriorPointOptions& options,
                                       const QuadraticWarmStart& near);

 private:
  enum class Hold : char { none, lower, upper };  // of a variable or a row: which bound is taken
  void begin(const QuadraticProgram& problem, const QuadraticWarmStart& near);
  void choose_first(const Eigen::VectorXd& bound_multipliers);
  bool step();
  bool soft_step();
  void choose_next();
  std::optional<QuadraticResult> result(const QuadraticProgram& problem, double tolerance) const;

  Equilibration scaling_;
  KktSystem kkt_;
  QuadraticProgram p_;  // scaled
  std::vector<char> always_fixed_, fixed_;
  std::vector<RowKind> kinds_, taken_;
  std::vector<Hold> of_variables_, of_rows_;
  Eigen::VectorXd x_, y_;  // scaled
  double broken_ = 0;      // scaled: what the point breaks a bound by, at most
  int changes_ = 0;        // of the set, after the last system
};

}  // namespace lapwing
