// SPDX-License-Identifier: Apache-2.0
// Sparse primal-dual interior point for convex quadratic programs.
//
// Mehrotra's predictor-corrector (SIAM J. Optim. 2(4), 1992) from an infeasible start, on the
// quasi-definite system
//
//   [ P + D_x + rho    A'              ] [ dx ]
//   [ A               -D_s^-1 - delta  ] [-dy ]
//
// factored as LDL^T (kkt_system.h, AMD ordering) after Ruiz equilibration. rho and delta are static
// regularisation, taken back by iterative refinement. The symbolic analysis is kept from one solve
// to the next while the sparsity stays the same.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "framework/core/progress.h"
#include "framework/solve/quadratic_program.h"

namespace lapwing {

struct InteriorPointOptions {
  int iteration_limit = 100;
  double tolerance = 1e-9;  // on all three relative residuals
  const CancellationToken* cancellation = nullptr;
  // Gets, before the end, the first point that is near the rows and bounds: to be drawn.
  std::function<void(const Eigen::VectorXd& x)> early = {};
};

// Where to begin instead of cold: an earlier solution of a similar problem. One that does not fit,
// or is not finite, is not used.
struct QuadraticWarmStart {
  Eigen::VectorXd x, row_multipliers, bound_multipliers;
};

// Not thread-safe; one per thread. Keeps memory between solves.
class InteriorPoint {
 public:
  InteriorPoint();
  ~InteriorPoint();
  InteriorPoint(InteriorPoint&&) noexcept;

  // Throws Error when dimensions disagree or numbers are not finite (a defect of the caller);
  // every outcome of the solve itself is a status.
  QuadraticResult solve(const QuadraticProgram& problem, const InteriorPointOptions& options = {},
                        const std::optional<QuadraticWarmStart>& warm_start = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapwing
