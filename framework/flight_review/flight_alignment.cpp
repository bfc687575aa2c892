// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/flight_alignment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/flight_review/clock_search.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Unknowns = Eigen::Matrix<double, 5, 1>;  // clock, offset, turn

constexpr double kNear = 0.3;       // share of lost places up to which a rigid match is good
constexpr double kBetter = 0.6;     // of the loss, that matching places must leave at most
constexpr double kFlew = 0.5;       // of the bounded loss, above which it is another flight
constexpr double kPart = 0.05;      // of the plan, that may be missing where the match is coarse
constexpr double kBeside = 5;       // m, across the ground, that a receiver may be off
constexpr double kDrift = 3;        // s, that refinement may move the clock
constexpr double kElsewhere = 200;  // m between log and plan
constexpr int kParts = 10;          // of the flight, left out in turn
constexpr std::size_t kMostTimes = 20000;

Eigen::Matrix3d about_z(double turn) {
  return Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
}

// One place of the plan with what the log shows then.
struct Row {
  Vector3d residual;
  Eigen::Matrix<double, 3, 5> slopes;
  double weight = 1;
};

class Refinement {
 public:
  Refinement(const Trajectory& plan, const FlownSeries& flown, const AlignmentRequest& asked)
      : flown_(flown) {
    const double span = plan.duration(), start = plan.samples.front().time;
    const auto count =
        std::clamp<std::size_t>(static_cast<std::size_t>(span / 0.02), 50, kMostTimes);
    for (std::size_t i = 0; i <= count; ++i) {
      times_.push_back(start + span * static_cast<double>(i) / static_cast<double>(count));
      wanted_.push_back(sample_at(plan, times_.back()).position);
    }
    // Of the plan: that of a log is noise, where its receiver is coarse.
    for (std::size_t i = 0; i <= count; ++i) {
      const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(count, i + 1);
      velocities_.push_back((wanted_[b] - wanted_[a]) / (times_[b] - times_[a]));
    }
    free_ << !asked.clock, asked.estimate_offset, asked.estimate_offset,
        asked.estimate_offset || flown.height_unknown, asked.estimate_turn && flown.local;
  }

  // Huber's weights at 1.5 robust standard deviations.
  FlightAlignment run(const ClockCandidate& from) {
    at_ << from.clock, from.offset, from.turn;
    double damping = 1e-9;
    for (int round = 0; round < 30; ++round) {
      const Unknowns step = solved(rows(), -1, damping);
      at_ += step;
      if (std::abs(at_[0] - from.clock) > kDrift) {  // it leads away: nothing fits there
        at_ << from.clock, from.offset, from.turn;
        break;
      }
      if (std::abs(step[0]) < 1e-7 && step.segment<3>(1).norm() < 1e-6 && std::abs(step[4]) < 1e-8)
        break;
    }
    return result();
  }

 private:
  std::vector<Row> rows() const {
    std::vector<Row> found;
    const Eigen::Matrix3d rotation = about_z(at_[4]);
    for (std::size_t i = 0; i < times_.size(); ++i) {
      const double time = times_[i] + at_[0];
      const auto now = flown_.at(time);
      if (!now) continue;
      Row row;
      const Vector3d turned = rotation * *now;
      row.residual = turned + at_.segment<3>(1) - wanted_[i];
      row.slopes.col(0) = velocities_[i];
      row.slopes.block<3, 3>(0, 1).setIdentity();
      row.slopes.col(4) = Vector3d(-turned.y(), turned.x(), 0);
      found.push_back(row);
    }
    weigh(found);
    return found;
  }

  static void weigh(std::vector<Row>& rows) {
    std::vector<double> sizes;
    for (const Row& row : rows) sizes.push_back(row.residual.norm());
    if (sizes.empty()) return;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double bound = std::max(1e-3, 1.5 * *middle);
    for (Row& row : rows) row.weight = std::min(1.0, bound / std::max(1e-12, row.residual.norm()));
  }

  // The step of least squares without the part `left_out` of the flight; -1: of all of it.
  Unknowns solved(const std::vector<Row>& rows, int left_out, double damping) const {
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Unknowns right = Unknowns::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (static_cast<int>(i * kParts / rows.size()) == left_out) continue;
      const Row& row = rows[i];
      normal += row.weight * row.slopes.transpose() * row.slopes;
      right -= row.weight * row.slopes.transpose() * row.residual;
    }
    const double count = std::max<double>(1, static_cast<double>(rows.size()));
    // An offset of 10 m counts as much as a residual of 1 cm throughout: it decides only where the
    // flight itself does not.
    if (!flown_.local)
      for (int k = 1; k < 4; ++k) {
        normal(k, k) += 1e-6 * count;
        right[k] -= 1e-6 * count * at_[k];
      }
    for (int k = 0; k < 5; ++k) {
      normal(k, k) += damping * count;
      if (free_[k]) continue;
      normal.row(k).setZero();
      normal.col(k).setZero();
      normal(k, k) = 1;
      right[k] = 0;
    }
    return normal.ldlt().solve(right);
  }

  FlightAlignment result() const {
    const std::vector<Row> all = rows();
    FlightAlignment found;
    found.clock = at_[0];
    found.offset = at_.segment<3>(1);
    found.turn = std::remainder(at_[4], 2 * M_PI);
    double sum = 0;
    for (const Row& row : all) sum += row.residual.squaredNorm();
    found.residual = std::sqrt(sum / std::max<double>(1, static_cast<double>(all.size())));
    // Jackknife over parts of the flight, as residuals of neighbours are alike.
    Unknowns mean = Unknowns::Zero(), squares = Unknowns::Zero();
    for (int part = 0; part < kParts; ++part) {
      const Unknowns step = solved(all, part, 1e-9);
      mean += step / kParts;
      squares += step.cwiseAbs2() / kParts;
    }
    const Unknowns sigma = ((kParts - 1) * (squares - mean.cwiseAbs2()).cwiseMax(0.0)).cwiseSqrt();
    found.clock_sigma = sigma[0];
    found.offset_sigma = sigma.segment<3>(1);
    found.turn_sigma = sigma[4];
    found.confounded = free_[0] && free_[1] && even(all);
    return found;
  }

  // Whether the velocity hardly changes: the clock's column is a mix of the offset's.
  static bool even(const std::vector<Row>& rows) {
    Vector3d mean = Vector3d::Zero();
    double square = 0;
    for (const Row& row : rows)
      mean += row.slopes.col(0), square += row.slopes.col(0).squaredNorm();
    if (rows.empty() || square == 0) return true;
    const double count = static_cast<double>(rows.size());
    return 1 - (mean / count).squaredNorm() / (square / count) < 0.02;
  }

  const FlownSeries& flown_;
  std::vector<double> times_;
  std::vector<Vector3d> wanted_, velocities_;
  Eigen::Matrix<bool, 5, 1> free_;
  Unknowns at_;
};

// m between the nearest places of both, whatever the time.
double nearest(const Trajectory& plan, const FlownSeries& flown) {
  double least = INFINITY;
  const std::size_t step = std::max<std::size_t>(1, flown.positions.size() / 2000);
  const std::size_t stride = std::max<std::size_t>(1, plan.samples.size() / 200);
  for (std::size_t i = 0; i < flown.positions.size(); i += step)
    for (std::size_t k = 0; k < plan.samples.size(); k += stride)
      least = std::min(least, (flown.positions[i] - plan.samples[k].position).head<2>().norm());
  return least;
}

[[noreturn]] void refuse(const std::string& how) {
  throw AnotherFlight("the log never flew this plan: " + how +
                      "; is it the log of another day, or the plan of another flight?");
}

}  // namespace

Vector3d FlightAlignment::corrected(const Vector3d& position) const {
  return about_z(turn) * position + offset;
}

FlightAlignment align_flight(const Trajectory& plan, const FlownSeries& flown,
                             const AlignmentRequest& asked) {
  if (plan.samples.size() < 2) throw InputError("the plan has no duration to compare with");
  if (!flown.local)
    if (const double far = nearest(plan, flown); far > kElsewhere)
      throw AnotherFlight("the log is of another place: it comes no nearer to the plan than " +
                          plain_number(far > 2000 ? far / 1000 : far, 3) +
                          (far > 2000 ? " km" : " m"));
  const double start = plan.samples.front().time, span = plan.duration();
  const std::vector<ClockCandidate> candidates = search_clocks(plan, flown, asked);
  if (candidates.empty()) refuse("it is shorter than a fifth of the plan");
  Refinement refinement(plan, flown, asked);
  FlightAlignment best;
  double least = INFINITY;
  for (const ClockCandidate& candidate : candidates) {
    const FlightAlignment found = refinement.run(candidate);
    AlignmentRequest fixed = asked;
    fixed.clock = found.clock;
    double cost = candidate.cost;
    for (const ClockCandidate& again : search_clocks(plan, flown, fixed)) cost = again.cost;
    if (cost < least) least = cost, best = found;
  }
  // Places that the log does not reach count as lost; they say nothing of the match.
  const double inside = std::min(flown.finish(), best.clock + start + span) -
                        std::max(flown.start(), best.clock + start);
  const double missing = std::clamp(1 - inside / span, 0.0, 1.0);
  const double lost = missing < 1 ? (least - missing) / (1 - missing) : 1;
  const double window = 0.5 * span + 30;
  const WarpedMatch match =
      search_places(plan, flown, best.clock + start - window, best.clock + start + span + window,
                    best.offset, best.turn, false);
  best.end = std::max(start + span, match.end - best.clock);
  const std::string near = "about " + plain_number(100 * std::clamp(1 - lost, 0.0, 1.0), 2) +
                           " % of the plan's places are within " +
                           plain_number(loss_scale(plan), 3) + " m of it";
  if (lost < kNear || asked.clock) {
    if (lost > kFlew) refuse("with --time-offset " + plain_number(*asked.clock) + " " + near);
    if (match.cost > kNear + missing) best.end = start + span;
    return best;
  }
  const WarpedMatch free =
      search_places(plan, flown, flown.start(), flown.finish(),
                    flown.local ? best.offset : Vector3d::Zero(), best.turn, asked.estimate_offset);
  if (free.cost < std::min(kFlew, kBetter * lost)) {
    best.clock = free.start - start;
    best.offset = free.offset;
    best.end = free.end - best.clock;
    best.stretched = true;
    best.clock_sigma = 0.5;
    return best;
  }
  if (lost > kFlew) refuse("at the best time " + near);
  // With a free offset, the end of one flight fits the beginning of many others coarsely.
  const double beside = flown.local ? INFINITY : best.offset.head<2>().norm();
  if (missing > kPart && beside > kBeside)
    refuse("the best match is a part, " + plain_number(100 * (1 - missing), 2) + " % of the plan" +
           (flown.local ? "" : ", " + plain_number(beside, 3) + " m beside it") + ", of which " +
           near);
  return best;
}

}  // namespace lapwing
