// SPDX-License-Identifier: Apache-2.0
// In place of torch_trainee.cpp, in builds without libtorch.
#include "framework/core/error.h"
#include "plugins/utilities/learned/trainee.h"

namespace lapwing::learned {
namespace {

[[noreturn]] void refuse() {
  throw InputError(
      "backend: this build has no libtorch; use own, or make the build that has it: "
      "scripts/setup.sh --for learn, cmake --preset learn, cmake --build --preset learn");
}

}  // namespace

void require_torch() {
  refuse();
}

std::unique_ptr<Trainee> torch_grid_trainee(const Parameters&, int, int) {
  refuse();
}

std::unique_ptr<Trainee> torch_ray_trainee(const Parameters&, int, int) {
  refuse();
}

}  // namespace lapwing::learned
