// SPDX-License-Identifier: Apache-2.0
// How: in the coordinates w of scaling.h the Hessian is the identity. A limit with the normal a in
// the variables has the normal n = S' a in w, and n'n = a' H^-1 a.
//   1. Scale without limits. The equations' normals are the columns of N, with N'N = A H^-1 A'. The
//      diagonal of its inverse is the curvature of the cost when one equation moves and all others
//      hold. It comes from a Cholesky factor with columns of length 1; a dependent column gets a
//      large number instead of a division by zero.
//   2. Scale again, the equations held by these penalties.
//   3. Other limits: 1 / n'n at up to five limits of each name; the rest take the nearest of these.
// All penalties are 10 times that curvature.
#include "plugins/trajectory_solvers/nlopt/penalties.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kFirstPenalty = 10;  // over the curvature of the cost along a limit's normal
constexpr int kSamples = 5;           // limits of one name at which that curvature is measured
constexpr std::size_t kLargestEquations = 600;
constexpr double kDependent = 1e-12;  // squared distance of a unit vector from combinations

// Diagonal of (N'N)^-1 for the columns N, 0 for a column of zeros. Columns that are combinations
// of others get a large number.
std::vector<double> inverse_gram_diagonal(const std::vector<VectorXd>& columns) {
  const int n = static_cast<int>(columns.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> factor(n, n);
  factor.setZero();
  std::vector<double> lengths;
  for (const VectorXd& column : columns) lengths.push_back(column.norm());
  for (int i = 0; i < n; ++i)  // Cholesky, columns scaled to length 1
    for (int j = 0; j <= i; ++j) {
      const double scale = lengths[i] * lengths[j];
      double entry = scale > 0 ? columns[i].dot(columns[j]) / scale : (i == j ? 1.0 : 0.0);
      entry -= factor.row(i).head(j).dot(factor.row(j).head(j));
      factor(i, j) = i == j ? std::sqrt(std::max(entry, kDependent)) : entry / factor(j, j);
    }
  std::vector<double> result(n, 0.0);
  for (int k = 0; k < n; ++k) {
    VectorXd solution = VectorXd::Zero(n);
    for (int i = k; i < n; ++i)
      solution(i) =
          ((i == k ? 1.0 : 0.0) - factor.row(i).head(i).dot(solution.head(i).transpose())) /
          factor(i, i);
    if (lengths[k] > 0) result[k] = solution.squaredNorm() / (lengths[k] * lengths[k]);
  }
  return result;
}

// The gradient of a limited quantity in round coordinates.
VectorXd round_normal(const ReducedProblem& reduced, const LocalModel& model,
                      const Scaling& scaling, const Limited& item) {
  VectorXd normal = VectorXd::Zero(item.is_row ? model.jacobian.rows() : model.jacobian.cols());
  normal(item.index) = 1;
  if (item.is_row) normal = VectorXd(model.jacobian.transpose() * normal);
  VectorXd gradient;
  reduced.backward(model, normal, gradient, nullptr);
  return scaling.to_gradient(gradient);
}

}  // namespace

void set_first_penalties(const ReducedProblem& reduced, const LocalModel& model,
                         AugmentedCost& cost, Scaling& scaling) {
  const TrajectoryProblem& problem = reduced.problem();
  std::vector<Limited*> equations;
  std::map<std::string, std::vector<Limited*>> groups;
  for (Limited& item : cost.limited()) {
    item.error = 0;
    const auto [lower, upper] =
        item.is_row ? std::pair{model.row_lower(item.index), model.row_upper(item.index)}
                    : problem.bounds(item.index);
    if (lower == upper && equations.size() < kLargestEquations) {
      equations.push_back(&item);
      continue;
    }
    const std::string name =
        item.is_row ? problem.row_name(item.index) : problem.column_name(item.index);
    groups[name.substr(0, name.rfind(" at "))].push_back(&item);
  }
  const auto normal = [&](const Limited& item) {
    return round_normal(reduced, model, scaling, item);
  };
  const auto round = [&] {
    cost.prepare_hessian(model);
    scaling.set_whole(model, cost);
  };
  round();
  std::vector<VectorXd> normals;
  for (const Limited* item : equations) normals.push_back(normal(*item));
  const std::vector<double> stiffness = inverse_gram_diagonal(normals);
  for (std::size_t k = 0; k < equations.size(); ++k) {
    equations[k]->penalty = stiffness[k] > 0 ? kFirstPenalty * stiffness[k] : 1.0;
    equations[k]->error = 1;  // held
  }
  round();
  for (auto& [name, items] : groups) {
    const std::size_t samples = std::min<std::size_t>(kSamples, items.size());
    std::vector<double> curvatures;
    for (std::size_t s = 0; s < samples; ++s) {
      const double compliance =
          normal(*items[(2 * s + 1) * items.size() / (2 * samples)]).squaredNorm();
      curvatures.push_back(compliance > 0 ? 1.0 / compliance : 1.0);
    }
    for (std::size_t k = 0; k < items.size(); ++k)
      items[k]->penalty = kFirstPenalty * curvatures[k * samples / items.size()];
  }
}

}  // namespace lapwing
