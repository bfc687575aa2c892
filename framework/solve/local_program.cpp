// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/local_program.h"

namespace lapwing {

QuadraticProgram local_program(const LocalModel& model) {
  return {model.hessian,
          model.gradient,
          model.jacobian,
          model.row_lower - model.values,
          model.row_upper - model.values,
          model.step_lower,
          model.step_upper,
          model.cost};
}

}  // namespace lapwing
