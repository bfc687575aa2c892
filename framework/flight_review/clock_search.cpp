// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/clock_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPlaces = 160;  // of the plan, that are compared
constexpr double kStep = 0.1;         // s between clock offsets that are tried
constexpr std::size_t kMostGrid = 2000000;
constexpr double kFar = 10;          // m, of an offset that is half unlikely
constexpr double kFarWeight = 0.02;  // of that against the loss
constexpr double kTie = 0.02;        // of the loss of one place, that does not count
constexpr std::size_t kKept = 4;     // candidates

// Positions at even times, for quick look-ups; not a number in gaps.
struct Grid {
  double start = 0, step = kStep;
  std::vector<Vector3d> positions;

  explicit Grid(const FlownSeries& flown) : start(flown.start()) {
    const double span = flown.finish() - flown.start();
    step = std::max(kStep / 2, span / static_cast<double>(kMostGrid));
    const auto count = static_cast<std::size_t>(span / step) + 1;
    for (std::size_t i = 0; i < count; ++i)
      positions.push_back(
          flown.at(start + step * static_cast<double>(i)).value_or(Vector3d::Constant(NAN)));
  }
  const Vector3d* at(double time) const {
    const double place = (time - start) / step + 0.5;
    if (!(place >= 0) || place >= static_cast<double>(positions.size())) return nullptr;
    const Vector3d& p = positions[static_cast<std::size_t>(place)];
    return std::isnan(p.x()) ? nullptr : &p;
  }
};

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Pairs {
  std::vector<Vector3d> wanted, shown;
};

// The turn about z that brings one set of points onto the other, in the least squares.
double turn_of(const Pairs& pairs) {
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.wanted.size(); ++i) a += pairs.wanted[i], b += pairs.shown[i];
  a /= static_cast<double>(pairs.wanted.size());
  b /= static_cast<double>(pairs.wanted.size());
  double along = 0, across = 0;
  for (std::size_t i = 0; i < pairs.wanted.size(); ++i) {
    const Vector3d w = pairs.wanted[i] - a, s = pairs.shown[i] - b;
    along += s.x() * w.x() + s.y() * w.y();
    across += s.x() * w.y() - s.y() * w.x();
  }
  return std::atan2(across, along);
}

Vector3d median_offset(const Pairs& pairs, double turn) {
  const Eigen::AngleAxisd rotation(turn, Vector3d::UnitZ());
  std::array<std::vector<double>, 3> parts;
  for (std::size_t i = 0; i < pairs.wanted.size(); ++i) {
    const Vector3d d = pairs.wanted[i] - rotation * pairs.shown[i];
    for (std::size_t axis = 0; axis < 3; ++axis)
      parts[axis].push_back(d[static_cast<Eigen::Index>(axis)]);
  }
  return {median_of(parts[0]), median_of(parts[1]), median_of(parts[2])};
}

double loss(double squared, double scale) {
  return squared / (squared + scale * scale);
}

class Search {
 public:
  Search(const Trajectory& plan, const FlownSeries& flown, const AlignmentRequest& asked)
      : grid_(flown),
        asked_(asked),
        local_(flown.local),
        height_(flown.height_unknown),
        scale_(loss_scale(plan)) {
    const double start = plan.samples.front().time, span = plan.duration();
    for (std::size_t k = 0; k < kPlaces; ++k) {
      times_.push_back(start + span * static_cast<double>(k) / (kPlaces - 1));
      wanted_.push_back(sample_at(plan, times_.back()).position);
    }
  }

  ClockCandidate at(double clock) const {
    ClockCandidate candidate{clock, Vector3d::Zero(), 0, 1};
    Pairs pairs;
    for (std::size_t k = 0; k < kPlaces; ++k)
      if (const Vector3d* shown = grid_.at(times_[k] + clock)) {
        pairs.wanted.push_back(wanted_[k]);
        pairs.shown.push_back(*shown);
      }
    if (pairs.wanted.size() < 3) return candidate;
    if (asked_.estimate_turn && local_) candidate.turn = turn_of(pairs);
    if (asked_.estimate_offset)
      candidate.offset = median_offset(pairs, candidate.turn);
    else if (height_)
      candidate.offset.z() = median_offset(pairs, 0).z();
    const Eigen::AngleAxisd rotation(candidate.turn, Vector3d::UnitZ());
    double sum = static_cast<double>(kPlaces - pairs.wanted.size());
    for (std::size_t i = 0; i < pairs.wanted.size(); ++i)
      sum += loss((rotation * pairs.shown[i] + candidate.offset - pairs.wanted[i]).squaredNorm(),
                  scale_);
    candidate.cost = sum / kPlaces;
    // What the log itself places on the earth is not likely to be far off.
    if (!local_)
      candidate.cost += kFarWeight * loss(candidate.offset.head<2>().squaredNorm(), kFar);
    return candidate;
  }

 private:
  Grid grid_;
  AlignmentRequest asked_;
  bool local_, height_;
  double scale_;
  std::vector<double> times_;
  std::vector<Vector3d> wanted_;
};

}  // namespace

double loss_scale(const Trajectory& plan) {
  Eigen::AlignedBox3d box;
  for (const Sample& s : plan.samples) box.extend(s.position);
  return std::max(1.0, 0.05 * box.diagonal().norm());
}

std::vector<ClockCandidate> search_clocks(const Trajectory& plan, const FlownSeries& flown,
                                          const AlignmentRequest& asked) {
  const Search search(plan, flown, asked);
  if (asked.clock) return {search.at(*asked.clock)};
  const double span = plan.duration(), start = plan.samples.front().time;
  const double least = std::min(span, std::max(3.0, 0.2 * span));  // s of both
  const double first = flown.start() - start - span + least;
  const double last = flown.finish() - start - least;
  std::vector<ClockCandidate> all;
  const double step = std::max(kStep, (last - first) / 200000);
  for (double clock = first; clock <= last + 1e-9; clock += step) all.push_back(search.at(clock));
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<ClockCandidate> kept;
  for (const ClockCandidate& one : all) {
    if (kept.size() >= kKept) break;
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const ClockCandidate& other) {
      return std::abs(other.clock - one.clock) < 2;
    });
    if (!near) kept.push_back(one);
  }
  return kept;
}

WarpedMatch search_places(const Trajectory& plan, const FlownSeries& flown, double from, double to,
                          const Vector3d& offset, double turn, bool estimate_offset) {
  constexpr std::size_t kMost = 6000;
  WarpedMatch match;
  match.offset = offset;
  from = std::max(from, flown.start());
  to = std::min(to, flown.finish());
  if (!(to > from)) return match;
  const Eigen::AngleAxisd rotation(turn, Vector3d::UnitZ());
  std::vector<double> times;
  std::vector<Vector3d> shown, wanted;
  const auto count =
      std::clamp(static_cast<std::size_t>((to - from) / kStep), std::size_t{2}, kMost);
  for (std::size_t i = 0; i <= count; ++i) {
    const double time = from + (to - from) * static_cast<double>(i) / static_cast<double>(count);
    if (const auto p = flown.at(time)) times.push_back(time), shown.push_back(rotation * *p);
  }
  if (shown.empty()) return match;
  const double start = plan.samples.front().time, span = plan.duration(), scale = loss_scale(plan);
  for (std::size_t k = 0; k < kPlaces; ++k)
    wanted.push_back(
        sample_at(plan, start + span * static_cast<double>(k) / (kPlaces - 1)).position);
  for (int round = 0; round < (estimate_offset ? 3 : 1); ++round) {
    // Cost of bringing the plan up to place k onto the flight up to its time i.
    const std::size_t n = shown.size();
    std::vector<double> row(n), next(n);
    const auto miss = [&](std::size_t k, std::size_t i) {
      return loss((shown[i] + match.offset - wanted[k]).squaredNorm(), scale);
    };
    for (std::size_t i = 0; i < n; ++i) row[i] = miss(0, i);
    std::vector<std::size_t> best(kPlaces * n);
    for (std::size_t i = 0; i < n; ++i) best[i] = i;
    for (std::size_t k = 1; k < kPlaces; ++k) {
      // The best time of the place before, up to this one.
      double least = INFINITY;
      std::size_t at = 0;
      for (std::size_t i = 0; i < n; ++i) {
        // Before its start a flight hovers: the latest of many good times is the start.
        if (row[i] <= least + (k == 1 ? kTie : 0)) least = std::min(least, row[i]), at = i;
        next[i] = least + miss(k, i);
        best[k * n + i] = at;
      }
      row.swap(next);
    }
    // And it hovers at its end: the earliest of many.
    const double least = *std::min_element(row.begin(), row.end());
    const double tie = kTie + least / kPlaces;  // of a place, as noise makes it
    std::size_t i = static_cast<std::size_t>(
        std::find_if(row.begin(), row.end(), [&](double c) { return c <= least + tie; }) -
        row.begin());
    match.cost = row[i] / kPlaces;
    match.end = times[i];
    Pairs pairs;
    for (std::size_t k = kPlaces; k-- > 0;) {
      pairs.wanted.push_back(wanted[k]);
      pairs.shown.push_back(shown[i]);
      match.start = times[i];
      i = best[k * n + i];
    }
    if (estimate_offset) match.offset = median_offset(pairs, 0);
  }
  return match;
}

}  // namespace lapwing
