// SPDX-License-Identifier: Apache-2.0
// How: Poisson reconstruction (Kazhdan, Bolitho and Hoppe 2006). The indicator function chi of the
// solid has a gradient that is large at the surface and along its normals. Given the field V of
// normals of the samples, chi solves laplace(chi) = div V. CGAL refines a Delaunay triangulation of
// the samples, takes chi linear on each tetrahedron, and fills the sparse matrix;
// poisson_equations.h solves it. CGAL then shifts chi so that its median at the samples is 0. A
// value is interpolated in the tetrahedron around the place.
//
// This is the only source that includes CGAL, because that is slow to compile.
#include "framework/surface/poisson_field.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Poisson_reconstruction_function.h>
#include <CGAL/property_map.h>

#include "framework/core/error.h"
#include "framework/surface/poisson_equations.h"

namespace lapwing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointWithNormal = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Poisson = CGAL::Poisson_reconstruction_function<Kernel>;

std::vector<PointWithNormal> pairs_of(const std::vector<PoissonField::Sample>& samples) {
  std::vector<PointWithNormal> pairs;
  for (const auto& [p, n] : samples) {
    pairs.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), Kernel::Vector_3(n[0], n[1], n[2]));
  }
  return pairs;
}

}  // namespace

struct PoissonField::Function {
  explicit Function(std::vector<PointWithNormal> given)
      : pairs(std::move(given)),
        poisson(pairs.begin(), pairs.end(), CGAL::First_of_pair_property_map<PointWithNormal>(),
                CGAL::Second_of_pair_property_map<PointWithNormal>()) {}
  std::vector<PointWithNormal> pairs;
  Poisson poisson;
};

PoissonField::PoissonField(const std::vector<Sample>& samples)
    : function_(std::make_unique<Function>(pairs_of(samples))) {
  if (!function_->poisson.compute_implicit_function(PoissonSolver())) {
    throw InputError("surface from points: the equations of the reconstruction have no solution");
  }
}

PoissonField::~PoissonField() = default;

double PoissonField::value(double x, double y, double z) const {
  return function_->poisson(Kernel::Point_3(x, y, z));
}

}  // namespace lapwing
