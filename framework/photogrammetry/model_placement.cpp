// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/model_placement.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kWithin = 3;  // times the accuracy
constexpr std::size_t kMostTriples = 2000;
constexpr double kInLine = 1e-3;    // second over first extent of points
constexpr double kDisagree = 0.05;  // share of a distance
constexpr std::uint64_t kSeed = 1;

// Umeyama 1991, equations 34 to 43, by loops, because the points are few.
Similarity similarity_of(const std::vector<const PlacedPoint*>& points) {
  const auto count = static_cast<double>(points.size());
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  for (const PlacedPoint* p : points) {
    from += p->model / count;
    to += p->world / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (const PlacedPoint* p : points) {
    const Vector3d a = p->model - from, b = p->world - to;
    spread += a.squaredNorm() / count;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) covariance(i, k) += b[i] * a[k] / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> parts(covariance,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d sign = Vector3d::Ones();
  if (parts.matrixU().determinant() * parts.matrixV().determinant() < 0) sign.z() = -1;
  const Eigen::Matrix3d turn = parts.matrixU() * sign.asDiagonal() * parts.matrixV().transpose();
  Similarity result;
  result.rotation = Eigen::Quaterniond(turn).normalized();
  result.scale = spread > 0 ? parts.singularValues().dot(sign) / spread : 0;
  result.translation = to - result.scale * (result.rotation * from);
  return result;
}

// Whether the points determine a turn: they do not lie in one line.
bool spread_out(const std::vector<const PlacedPoint*>& points, Vector3d PlacedPoint::*where,
                double least) {
  Vector3d mean = Vector3d::Zero();
  for (const PlacedPoint* p : points) mean += p->*where / static_cast<double>(points.size());
  double longest = 0;
  Vector3d along = Vector3d::Zero();
  for (const PlacedPoint* p : points) {
    const Vector3d d = p->*where - mean;
    if (d.norm() > longest) {
      longest = d.norm();
      along = d.normalized();
    }
  }
  double widest = 0;
  for (const PlacedPoint* p : points) {
    const Vector3d d = p->*where - mean;
    widest = std::max(widest, (d - along.dot(d) * along).norm());
  }
  return longest > 0 && widest > kInLine * longest && widest > least;
}

double miss(const Similarity& fit, const PlacedPoint& point) {
  return (fit.apply(point.model) - point.world).norm();
}

std::vector<const PlacedPoint*> agreeing(const Similarity& fit,
                                         const std::vector<PlacedPoint>& points, double within) {
  std::vector<const PlacedPoint*> agree;
  for (const PlacedPoint& p : points)
    if (miss(fit, p) <= within) agree.push_back(&p);
  return agree;
}

// Those that most agree with some three of them.
std::vector<const PlacedPoint*> consensus(const std::vector<PlacedPoint>& points, double within) {
  const std::size_t n = points.size();
  const double triples =
      static_cast<double>(n) * static_cast<double>(n - 1) * static_cast<double>(n - 2) / 6;
  std::vector<const PlacedPoint*> best;
  const auto attempt = [&](std::size_t a, std::size_t b, std::size_t c) {
    const std::vector<const PlacedPoint*> three{&points[a], &points[b], &points[c]};
    if (!spread_out(three, &PlacedPoint::model, 0)) return;
    const Similarity fit = similarity_of(three);
    if (!(fit.scale > 0)) return;
    auto agree = agreeing(fit, points, within);
    if (agree.size() > best.size()) best = std::move(agree);
  };
  if (triples <= static_cast<double>(kMostTriples)) {
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b)
        for (std::size_t c = b + 1; c < n; ++c) attempt(a, b, c);
    return best;
  }
  Random random(kSeed);
  const auto any = [&] {
    return static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(n) - 1));
  };
  for (std::size_t k = 0; k < kMostTriples; ++k) {
    const std::size_t a = any(), b = any(), c = any();
    if (a != b && b != c && a != c) attempt(a, b, c);
  }
  return best;
}

}  // namespace

PlacementFit fit_placement(const std::vector<PlacedPoint>& points, double accuracy) {
  if (!(accuracy > 0)) throw InputError("the accuracy of positions must be above 0 m");
  if (points.size() < 3)
    throw InputError(std::to_string(points.size()) +
                     " positions are too few to place a model: at least 3 are needed");
  const double within = kWithin * accuracy;
  std::vector<const PlacedPoint*> used = consensus(points, within);
  if (2 * used.size() < points.size() || used.size() < 3)
    throw InputError("only " + std::to_string(used.size()) + " of " +
                     std::to_string(points.size()) +
                     " positions agree with the model to three times the accuracy: state a "
                     "larger accuracy, or check that positions and model are of one flight");
  Similarity fit;
  for (int round = 0; round < 5; ++round) {
    fit = similarity_of(used);
    auto agree = agreeing(fit, points, within);
    if (agree.size() < 3 || agree == used) break;
    used = std::move(agree);
  }
  if (!spread_out(used, &PlacedPoint::model, 0) || !spread_out(used, &PlacedPoint::world, accuracy))
    throw InputError(
        "the positions lie nearly in one line, so that the turn about it is open: use photographs "
        "of several lines of flight, or state distances and up");
  PlacementFit result;
  result.to_world = fit;
  result.used = used.size();
  result.given = points.size();
  for (const PlacedPoint& p : points) {
    const double m = miss(fit, p);
    if (std::find(used.begin(), used.end(), &p) == used.end()) {
      result.left_out.push_back(p.name);
      continue;
    }
    result.residual += m * m / static_cast<double>(used.size());
    result.largest = std::max(result.largest, m);
  }
  result.residual = std::sqrt(result.residual);
  return result;
}

ScaleFit fit_scale(const std::vector<StatedDistance>& distances) {
  if (distances.empty()) throw InputError("no distance is stated");
  double above = 0, below = 0;
  for (const StatedDistance& d : distances) {
    const double units = (d.to - d.from).norm();
    if (!(d.metres > 0 && std::isfinite(d.metres)) || !(units > 0))
      throw InputError("a distance must be above 0 m, between two places of the model");
    above += units * d.metres;
    below += units * units;
  }
  ScaleFit fit;
  fit.scale = above / below;
  for (const StatedDistance& d : distances)
    fit.worst =
        std::max(fit.worst, std::abs(fit.scale * (d.to - d.from).norm() - d.metres) / d.metres);
  if (fit.worst > kDisagree) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the stated distances disagree: with one scale, %.6g m per unit, one of them is "
                  "wrong by %.3g %%",
                  fit.scale, 100 * fit.worst);
    throw InputError(text);
  }
  return fit;
}

}  // namespace lapwing
