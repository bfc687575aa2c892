// SPDX-License-Identifier: Apache-2.0
#include "framework/export/plan_progress.h"

#include <algorithm>
#include <cmath>

#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr std::size_t kPlaces = 2000;  // of plan and flight, that are brought together
// m^2 that it counts as where one of them stands and the other goes on.
constexpr double kWait = 4e-4;
constexpr double kNear = 1;  // s of the plan before and behind, that are compared

}  // namespace

PlanProgress::PlanProgress(const Trajectory& plan, const Trajectory& flown, double start,
                           double finish)
    : plan_(plan), flown_(flown), start_(start), finish_(finish) {
  const auto& samples = flown.samples;
  std::vector<Eigen::Vector3d> wanted, shown;
  std::vector<double> planned;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double share = static_cast<double>(i) / (kPlaces - 1);
    planned.push_back(start + share * (finish - start));
    wanted.push_back(sample_at(plan, planned.back()).position);
    shown.push_back(sample_at(flown, share * samples.back().time).position);
  }
  const std::vector<std::size_t> matches = align(wanted, shown);
  for (const Sample& s : samples) {
    const double at = samples.back().time > 0 ? s.time / samples.back().time * (kPlaces - 1) : 0;
    const std::size_t i = std::min(static_cast<std::size_t>(at), kPlaces - 2);
    const double before = planned[matches[i]], after = planned[matches[i + 1]];
    reached_.push_back(before + (at - static_cast<double>(i)) * (after - before));
  }
}

double PlanProgress::across(std::size_t number) const {
  constexpr int kParts = 40;
  const Eigen::Vector3d& place = flown_.samples[number].position;
  const double from = std::max(start_, reached_[number] - kNear);
  const double to = std::min(finish_, reached_[number] + kNear);
  Eigen::Vector3d before = sample_at(plan_, from).position;
  double least = (before - place).norm();
  for (int k = 1; k <= kParts; ++k) {
    const Eigen::Vector3d after = sample_at(plan_, from + (to - from) * k / kParts).position;
    const Eigen::Vector3d way = after - before;
    const double length = way.squaredNorm();
    const double share = length > 0 ? std::clamp(way.dot(place - before) / length, 0.0, 1.0) : 0;
    least = std::min(least, (before + share * way - place).norm());
    before = after;
  }
  return least;
}

double PlanProgress::flown_time(double planned) const {
  const auto found = std::lower_bound(reached_.begin(), reached_.end(), planned);
  const auto& samples = flown_.samples;
  if (found == reached_.end()) return samples.back().time;
  return samples[static_cast<std::size_t>(found - reached_.begin())].time;
}

// Of each place that is shown, the nearest of the wanted ones that the alignment gives it.
std::vector<std::size_t> PlanProgress::align(const std::vector<Eigen::Vector3d>& wanted,
                                             const std::vector<Eigen::Vector3d>& shown) {
  enum : char { both, flight, plan };
  std::vector<char> steps(kPlaces * kPlaces, both);
  std::vector<double> row(kPlaces, INFINITY), next(kPlaces);
  const auto cost = [&](std::size_t i, std::size_t j) {
    return (shown[i] - wanted[j]).squaredNorm();
  };
  for (std::size_t i = 0; i < kPlaces; ++i) {
    for (std::size_t j = 0; j < kPlaces; ++j) {
      const double diagonal = i == 0 && j == 0 ? 0 : i > 0 && j > 0 ? row[j - 1] : INFINITY;
      const double up = i > 0 ? row[j] + kWait : INFINITY;
      const double left = j > 0 ? next[j - 1] + kWait : INFINITY;
      const double least = std::min({diagonal, up, left});
      steps[i * kPlaces + j] = least == diagonal ? both : least == up ? flight : plan;
      next[j] = least + cost(i, j);
    }
    row.swap(next);
  }
  std::vector<std::size_t> matches(kPlaces, kPlaces - 1);
  std::size_t i = kPlaces - 1, j = kPlaces - 1;
  std::vector<double> least(kPlaces, INFINITY);
  while (true) {
    if (cost(i, j) < least[i]) least[i] = cost(i, j), matches[i] = j;
    if (i == 0 && j == 0) return matches;
    const char step = steps[i * kPlaces + j];
    if (step != plan) --i;
    if (step != flight) --j;
  }
}

}  // namespace lapwing
