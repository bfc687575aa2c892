// SPDX-License-Identifier: Apache-2.0
// Primal-dual interior point for trajectory problems that are not convex: free times, orientations.
//
// Of every quadratic model, with the exact curvature of the Lagrangian, one step of the interior
// point is taken before the model is made anew. In scaled numbers, s the slacks of rows that are no
// equations, at a barrier parameter mu:
//
//   [ W + D_x + delta   A'                 ] [ dx ]
//   [ A                 -D_s^-1 - D_e      ] [-dy ]
//
// W need not be positive: delta is raised until the factors have as many negative pivots as there
// are rows, so that the step descends (Waechter and Biegler, Math. Program. 106, 2006, 3.1). Steps
// are taken in the tangent space of the point, by the problem's `retract`; a filter on violation
// and barrier cost accepts them, with a second-order correction (3.2 to 3.4). Instead of a
// restoration phase all rows become elastic, with a penalty on the sum of violations p + q. Both
// are eliminated and add D_e = p / z_p + q / z_q to the diagonal of the rows: the system keeps its
// structure.
#pragma once

#include <string>

#include "framework/solve/solve_record.h"
#include "framework/solve/trajectory_solver.h"

namespace lapwing {

struct NonlinearOptions {
  int iteration_limit = 300;
  double tolerance = 1e-6;      // relative: gap to the optimum that complementarity leaves
  double feasibility = 1e-6;    // largest violation of a row, in its unit
  double first_barrier = 1e-1;  // in scaled numbers; smaller for a start near the answer
};

struct NonlinearOutcome {
  SolveStatus status = SolveStatus::numerical_error;
  std::string message;  // why, in one sentence; empty when optimal
  int iterations = 0;
  WarmStart point;  // the last iterate; where that is not feasible, the best one that was
};

// From the start that `record` gives. Every iteration is added to the record. Throws what the
// problem's terms throw, and nothing of its own: every outcome is a status.
NonlinearOutcome solve_nonlinear(const TrajectoryProblem& problem, const SolveRequest& request,
                                 const NonlinearOptions& options, SolveRecord& record);

}  // namespace lapwing
