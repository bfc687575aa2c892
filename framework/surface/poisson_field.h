// SPDX-License-Identifier: Apache-2.0
// The function whose gradient agrees with the normals of points: Poisson reconstruction by CGAL.
// Internal to this room; callers include surface_mesh.h.
#pragma once

#include <array>
#include <memory>
#include <vector>

namespace lapwing {

class PoissonField {
 public:
  struct Sample {
    std::array<double, 3> point, normal;
  };
  // At least four points that do not lie in one plane, or CGAL ends the process. Throws InputError
  // when the equations cannot be solved.
  explicit PoissonField(const std::vector<Sample>& samples);
  ~PoissonField();
  PoissonField(const PoissonField&) = delete;
  PoissonField& operator=(const PoissonField&) = delete;
  // Negative behind the surface, positive on the side that normals point to. Not thread-safe.
  double value(double x, double y, double z) const;

 private:
  struct Function;
  std::unique_ptr<Function> function_;
};

}  // namespace lapwing
