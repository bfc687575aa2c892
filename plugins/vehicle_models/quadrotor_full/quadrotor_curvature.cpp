// SPDX-License-Identifier: Apache-2.0
// Apart from the step itself: each takes g++ as long as a source may take.
#include "plugins/vehicle_models/quadrotor_full/quadrotor_step.h"

namespace lapwing {

void add_curvature(const QuadrotorStep& step, const double* at, const double* lambda,
                   double* hessian) {
  using T = Dual<double, kActive>;
  T x[kArguments], gradient[kArguments];
  QuadrotorStep::seed(at, x);
  step.pull_back(x, lambda, gradient);
  for (int r = kMoving; r < kArguments; ++r)
    for (int i = 0; i < kActive; ++i) hessian[r * kArguments + kMoving + i] += gradient[r].d[i];
}

}  // namespace lapwing
