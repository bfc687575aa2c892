// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/smooth_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr std::size_t kMostKnots = 20000;
constexpr double kRateWeight = 0.5;  // s: a velocity off by 1 m/s counts as a place off by 0.5 m
constexpr int kProbes = 4;           // of the trace
// Of the trace in the score: keeps few samples from being followed one by one (Kim and Gu, 2004).
constexpr double kCaution = 1.4;

// The four cubic B-splines of an interval of length h and their derivatives at share u.
std::array<double, 4> basis(double u, double h, int order) {
  const double u2 = u * u, u3 = u2 * u;
  switch (order) {
    case 0:
      return {(1 - 3 * u + 3 * u2 - u3) / 6, (4 - 6 * u2 + 3 * u3) / 6,
              (1 + 3 * u + 3 * u2 - 3 * u3) / 6, u3 / 6};
    case 1:
      return {(-1 + 2 * u - u2) / 2 / h, (-4 * u + 3 * u2) / 2 / h, (1 + 2 * u - 3 * u2) / 2 / h,
              u2 / 2 / h};
    case 2: {
      const double s = h * h;
      return {(1 - u) / s, (-2 + 3 * u) / s, (1 - 3 * u) / s, u / s};
    }
    default: {
      const double s = h * h * h;
      return {-1 / s, 3 / s, -3 / s, 1 / s};
    }
  }
}

struct Place {
  std::size_t interval;
  double share;
};

Place place_of(double time, double start, double step, std::size_t count) {
  const double at = (time - start) / step;
  const auto interval =
      static_cast<std::size_t>(std::clamp(std::floor(at), 0.0, static_cast<double>(count - 1)));
  return {interval, at - static_cast<double>(interval)};
}

// Rows of the least squares: what is wanted, and the splines that give it.
struct Rows {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Eigen::RowVectorXd> wanted;
};

void append(Rows& rows, const std::vector<double>& times, const Eigen::MatrixXd& values, int order,
            double weight, double start, double finish, double step, std::size_t count) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < start - 1e-9 || times[i] > finish + 1e-9) continue;
    const Place place = place_of(times[i], start, step, count);
    const auto b = basis(place.share, step, order);
    const int row = static_cast<int>(rows.wanted.size());
    for (int k = 0; k < 4; ++k)
      rows.entries.emplace_back(row, static_cast<int>(place.interval) + k,
                                weight * b[static_cast<std::size_t>(k)]);
    rows.wanted.emplace_back(weight * values.row(static_cast<Eigen::Index>(i)));
  }
}

// Of the third derivative, over an interval's length; made free of units by `scale` (s^3).
Sparse penalty_of(std::size_t count, double step) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto b = basis(0, step, 3);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 4; ++k)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i) + k,
                           std::sqrt(step) * b[static_cast<std::size_t>(k)]);
  Sparse jerk(static_cast<int>(count), static_cast<int>(count) + 3);
  jerk.setFromTriplets(entries.begin(), entries.end());
  return Sparse(jerk.transpose()) * jerk;
}

class Fit {
 public:
  Fit(const Rows& rows, std::size_t count, double step) : penalty_(penalty_of(count, step)) {
    design_ = Sparse(static_cast<int>(rows.wanted.size()), static_cast<int>(count) + 3);
    design_.setFromTriplets(rows.entries.begin(), rows.entries.end());
    wanted_.resize(static_cast<Eigen::Index>(rows.wanted.size()), rows.wanted[0].size());
    for (std::size_t i = 0; i < rows.wanted.size(); ++i)
      wanted_.row(static_cast<Eigen::Index>(i)) = rows.wanted[i];
    normal_ = Sparse(design_.transpose()) * design_;
    right_ = design_.transpose() * wanted_;
    Random random(1);
    probes_.resize(design_.rows(), kProbes);
    for (Eigen::Index i = 0; i < probes_.size(); ++i)
      probes_.data()[i] = random.uniform() < 0.5 ? -1 : 1;
  }

  // The score of cross-validation with that weight of the penalty; fills the coefficients.
  double score(double weight, Eigen::MatrixXd& coefficients) const {
    Sparse ridge(normal_.rows(), normal_.cols());
    ridge.setIdentity();
    const Eigen::SimplicialLDLT<Sparse> solver(normal_ + weight * penalty_ + 1e-9 * ridge);
    if (solver.info() != Eigen::Success) return INFINITY;
    coefficients = solver.solve(right_);
    const double misses = (design_ * coefficients - wanted_).squaredNorm();
    const Eigen::MatrixXd seen = design_ * solver.solve(design_.transpose() * probes_);
    const double trace = probes_.cwiseProduct(seen).sum() / kProbes;
    const double n = static_cast<double>(design_.rows());
    const double freedom = n - kCaution * trace;
    return freedom > 0.02 * n ? n * misses / (freedom * freedom) : INFINITY;
  }

 private:
  Sparse penalty_, design_, normal_;
  Eigen::MatrixXd wanted_, right_, probes_;
};

}  // namespace

SmoothCurve::SmoothCurve(const CurveSamples& samples, double start, double finish, double step)
    : start_(start) {
  const double span = finish - start;
  count_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(span / step - 1e-9)), 1,
                                   kMostKnots);
  step_ = span / static_cast<double>(count_);
  Rows rows;
  append(rows, samples.times, samples.values, 0, 1, start, finish, step_, count_);
  const std::size_t own = rows.wanted.size();
  if (own < 4) throw Error("a smooth curve needs four samples, not " + std::to_string(own));
  append(rows, samples.rate_times, samples.rates, 1, kRateWeight, start, finish, step_, count_);
  const Fit fit(rows, count_, step_);
  double least = INFINITY;
  Eigen::MatrixXd coefficients;
  for (int power = -8; power <= 6; ++power) {
    const double score = fit.score(std::pow(10.0, power), coefficients);
    if (score < least) least = score, coefficients_ = coefficients;
  }
  if (!std::isfinite(least)) throw Error("no smooth curve through the samples was found");
  double sum = 0;
  for (std::size_t i = 0; i < samples.times.size(); ++i)
    if (samples.times[i] >= start - 1e-9 && samples.times[i] <= finish + 1e-9)
      sum += (at(samples.times[i]).transpose() - samples.values.row(static_cast<Eigen::Index>(i)))
                 .squaredNorm();
  residual_ = std::sqrt(sum / static_cast<double>(own));
}

Eigen::VectorXd SmoothCurve::at(double time, int order) const {
  const Place place = place_of(time, start_, step_, count_);
  const auto b = basis(place.share, step_, order);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(coefficients_.cols());
  for (int k = 0; k < 4; ++k)
    sum += b[static_cast<std::size_t>(k)] *
           coefficients_.row(static_cast<Eigen::Index>(place.interval) + k).transpose();
  return sum;
}

}  // namespace lapwing
