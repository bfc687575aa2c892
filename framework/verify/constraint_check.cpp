// SPDX-License-Identifier: Apache-2.0
// Constraints that the script states: at every sample, and between two samples.
//
// A problem holds such a constraint at its stages, which are the samples. Between two of them a
// value bends on, by an eighth of its second difference if the bend is even: twice that much is
// allowed there, and never more than a share of the range of the values. What goes further is
// hidden by samples that are too coarse.
#include <set>
#include <span>

#include "framework/core/number_text.h"
#include "framework/verify/checks.h"
#include "framework/verify/constraint_evaluation.h"

namespace lapwing {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Check named_check(const StatedConstraint& constraint) {
  Check check;
  check.name = "constraint \"" + constraint.name + "\"";
  check.group = CheckGroup::task;
  check.required = constraint.required;
  return check;
}

// Between two points of the motion, which lie so near that accelerations hardly change.
MotionPoint between(const MotionPoint& a, const MotionPoint& b, double time) {
  const double h = b.time - a.time, share = h > 0 ? (time - a.time) / h : 0.0;
  const auto mixed = [&](auto from, auto to) { return from + share * (to - from); };
  MotionPoint p = a;
  p.time = time;
  const double bend = (time - a.time) * (time - b.time) / 2;
  p.position = a.position + share * (b.position - a.position) + bend * a.acceleration;
  p.velocity = a.velocity + share * (b.velocity - a.velocity);
  p.force = a.force + share * (b.force - a.force);
  p.yaw = mixed(a.yaw, b.yaw);
  p.yaw_rate = mixed(a.yaw_rate, b.yaw_rate);
  p.yaw_torque = mixed(a.yaw_torque, b.yaw_torque);
  p.gimbal_yaw = mixed(a.gimbal_yaw, b.gimbal_yaw);
  p.gimbal_pitch = mixed(a.gimbal_pitch, b.gimbal_pitch);
  p.gimbal_yaw_rate = mixed(a.gimbal_yaw_rate, b.gimbal_yaw_rate);
  p.gimbal_pitch_rate = mixed(a.gimbal_pitch_rate, b.gimbal_pitch_rate);
  p.orientation = a.orientation.slerp(share, b.orientation);
  p.body_rates = a.body_rates + share * (b.body_rates - a.body_rates);
  p.rotor_thrusts = a.rotor_thrusts + share * (b.rotor_thrusts - a.rotor_thrusts);
  for (std::size_t i = 0; i < p.columns.size(); ++i)
    p.columns[i] = mixed(a.columns[i], b.columns[i]);
  return p;
}

class ConstraintJudge {
 public:
  ConstraintJudge(const Flight& flight, const StatedConstraint& constraint)
      : flight_(flight),
        constraint_(constraint),
        evaluation_(constraint, flight.plan.trajectory, {flight.plan.environment, flight.shapes}),
        samples_(flight.plan.trajectory.samples.size()),
        rows_(constraint.results.size()),
        found_(rows_, 0.0) {
    for (std::size_t i = 0; i < samples_; ++i) points_.push_back(point(i, flight.motion.stated(i)));
  }

  Check check() {
    if (const auto outside = time_outside()) {
      Check check = named_check(constraint_);
      check.at = *outside;
      check.detail = "it is evaluated at " + plain_number(*outside) +
                     " s, and the flight lasts from " + plain_number(points_.front().motion.time) +
                     " to " + plain_number(points_.back().motion.time) + " s";
      return check;  // with nothing to report, and failed
    }
    if (constraint_.times.empty())
      judge_samples();
    else
      judge_times();
    Check check = named_check(constraint_);
    if (!seen_) {
      check.skipped = "the flight has no sample at which it is evaluated";
      return check;
    }
    check = judged(std::move(check), worst_.value, worst_.limit, worst_.tolerance, worst_.time,
                   worst_.at_least);
    if (rows_ > 1)
      check.detail += (check.detail.empty() ? "" : "; ") +
                      ("result " + std::to_string(worst_.row + 1)) + " of " + std::to_string(rows_);
    return check;
  }

 private:
  struct Seen {
    double value = 0, limit = 0, tolerance = 0, time = 0;
    bool at_least = false;
    std::size_t row = 0;
  };

  // The rest of what the script may read of sample `i`, or of a time after it.
  ConstraintPoint point(std::size_t i, const MotionPoint& motion) const {
    const auto& samples = flight_.plan.trajectory.samples;
    ConstraintPoint p{.motion = motion, .target = samples[i].target};
    const std::size_t first = i + 1 < samples_ ? i : i > 0 ? i - 1 : i;
    if (first + 1 >= samples_) return p;
    p.step = samples[first + 1].time - samples[first].time;
    if (i + 1 < samples_)
      p.target +=
          (motion.time - samples[i].time) / p.step * (samples[i + 1].target - samples[i].target);
    return p;
  }

  bool asked(std::size_t i) const {
    const auto last = i + static_cast<std::size_t>(evaluation_.window()) - 1;
    if (last >= samples_) return false;
    const double from = points_[i].motion.time, to = points_[last].motion.time;
    constexpr double kSame = tolerances::kConstraintTime;
    const auto holds = [&](const TimeSpan& span) {
      return span.start <= from + kSame && to - kSame <= span.finish;
    };
    const auto overlaps = [&](const TimeSpan& span) {
      return span.start <= to + kSame && from - kSame <= span.finish;
    };
    const auto &spans = constraint_.spans, &except = constraint_.except;
    return (spans.empty() || std::any_of(spans.begin(), spans.end(), holds)) &&
           std::none_of(except.begin(), except.end(), overlaps);
  }

  // Values of one result at the samples at which it is asked; no number elsewhere.
  double at(std::size_t i, std::size_t row) const { return values_[i * rows_ + row]; }

  void judge_samples() {
    values_.assign(samples_ * rows_, kNone);
    std::vector<char> is_asked(samples_, 0);
    for (std::size_t i = 0; i < samples_; ++i) {
      if (!asked(i)) continue;
      is_asked[i] = 1;
      evaluation_.evaluate(std::span(points_).subspan(i), found_);
      std::copy(found_.begin(), found_.end(), values_.begin() + static_cast<long>(i * rows_));
    }
    measure_ranges();
    for (std::size_t i = 0; i < samples_; ++i)
      for (std::size_t row = 0; is_asked[i] && row < rows_; ++row)
        see(row, at(i, row), 0, points_[i].motion.time);
    // What reads several samples is stated at samples alone.
    if (evaluation_.window() > 1) return;
    for (std::size_t i = 0; i + 1 < samples_; ++i)
      if (is_asked[i] && is_asked[i + 1]) judge_between(i);
  }

  void judge_between(std::size_t i) {
    const auto motion = flight_.motion.integrate(i);
    for (std::size_t k = 1; k + 1 < motion.size(); ++k) {
      const ConstraintPoint p = point(i, motion[k]);
      evaluation_.evaluate({&p, 1}, found_);
      for (std::size_t row = 0; row < rows_; ++row)
        see(row, found_[row], allowance(i, row), motion[k].time);
    }
  }

  // By which a value may pass its bound between sample `i` and the next one.
  double allowance(std::size_t i, std::size_t row) const {
    double bend = 0;
    for (const std::size_t middle : {i, i + 1}) {
      if (middle == 0 || middle + 1 >= samples_) continue;
      const double second = at(middle - 1, row) - 2 * at(middle, row) + at(middle + 1, row);
      if (std::isfinite(second)) bend = std::max(bend, std::abs(second));
    }
    return std::min(tolerances::kConstraintBend * bend / 8,
                    tolerances::kConstraintBetween * ranges_[row]);
  }

  // A time at which it is asked and there is no flight, if there is one.
  std::optional<double> time_outside() const {
    const double first = points_.front().motion.time, last = points_.back().motion.time;
    for (const double time : constraint_.times)
      if (!(time >= first - tolerances::kSpanTime && time <= last + tolerances::kSpanTime))
        return time;
    return std::nullopt;
  }

  void judge_times() {
    ranges_.assign(rows_, 0.0);
    for (const double time : constraint_.times) {
      bool found = false;
      for (std::size_t i = 0; i + 1 < samples_; ++i) {
        if (points_[i + 1].motion.time < time && i + 2 < samples_) continue;
        const auto motion = flight_.motion.integrate(i);
        std::size_t k = 1;
        while (k + 1 < motion.size() && motion[k].time < time) ++k;
        const double inside = std::clamp(time, motion.front().time, motion.back().time);
        const ConstraintPoint p = point(i, between(motion[k - 1], motion[k], inside));
        evaluation_.evaluate({&p, 1}, found_);
        found = true;
        break;
      }
      if (!found) evaluation_.evaluate(std::span(points_).first(1), found_);
      for (std::size_t row = 0; row < rows_; ++row) see(row, found_[row], 0, time);
    }
  }

  void measure_ranges() {
    ranges_.assign(rows_, 0.0);
    for (std::size_t row = 0; row < rows_; ++row) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t i = 0; i < samples_; ++i) {
        if (!std::isfinite(at(i, row))) continue;
        low = std::min(low, at(i, row));
        high = std::max(high, at(i, row));
      }
      if (high > low) ranges_[row] = high - low;
    }
  }

  void see(std::size_t row, double value, double allowed, double time) {
    const ConstraintResult& result = constraint_.results[row];
    for (const bool at_least : {true, false}) {
      const auto& bound = at_least ? result.lower : result.upper;
      if (!bound) continue;
      const double tolerance =
          std::max(tolerances::kConstraintShare * std::max(std::abs(*bound), ranges_[row]),
                   tolerances::kConstraintFloor);
      const double beyond = at_least ? *bound - value : value - *bound;
      const double share = (beyond - allowed) / tolerance;
      if (seen_ && (std::isnan(share_) || share <= share_)) continue;
      seen_ = true;
      share_ = share;
      worst_ = {value, *bound, tolerance + allowed, time, at_least, row};
    }
  }

  const Flight& flight_;
  const StatedConstraint& constraint_;
  ConstraintEvaluation evaluation_;
  std::size_t samples_, rows_;
  std::vector<double> found_;
  std::vector<ConstraintPoint> points_;  // of the samples
  std::vector<double> values_, ranges_;
  bool seen_ = false;
  double share_ = 0;  // of the tolerance, by which the worst value is beyond its bound
  Seen worst_;
};

}  // namespace

void check_constraints(const Flight& flight, Certificate& certificate) {
  for (const StatedConstraint& constraint : flight.plan.constraints) {
    if (constraint.unjudged.empty()) {
      certificate.checks.push_back(ConstraintJudge(flight, constraint).check());
      continue;
    }
    certificate.checks.push_back(named_check(constraint));
    certificate.checks.back().skipped = constraint.unjudged;
  }
}

void skip_constraints(const Plan& plan, const std::string& reason, Certificate& certificate) {
  for (const StatedConstraint& constraint : plan.constraints) {
    certificate.checks.push_back(named_check(constraint));
    certificate.checks.back().skipped = reason;
  }
}

void list_constraint_problems(const Plan& plan, std::vector<std::string>& problems) {
  std::set<std::string> names;
  for (const StatedConstraint& constraint : plan.constraints) {
    const std::string what = "constraint '" + constraint.name + "'";
    if (!names.insert(constraint.name).second)
      problems.push_back("two constraints are named '" + constraint.name + "'");
    const std::string problem = problem_of(constraint, plan);
    if (!problem.empty()) problems.push_back(what + problem);
  }
}

}  // namespace lapwing
