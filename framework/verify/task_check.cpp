// SPDX-License-Identifier: Apache-2.0
// Does the flight do what the mission asked? Keyframes, each against its own tolerances.
#include <numbers>

#include "framework/verify/checks.h"

namespace lapwing {
namespace {

// The smallest distance of p from the line from a to b.
double distance_to_line(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double length2 = d.squaredNorm();
  const double s = length2 > 0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * d).norm();
}

// The smallest angle, on the circle, between `yaw` and what lies between a and b.
double angle_to_range(double yaw, double a, double b) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double low = std::min(a, b), high = std::max(a, b);
  // The first copy of yaw that is not below the range, and the one before it.
  const double above = yaw + kTurn * std::ceil((low - yaw) / kTurn);
  return std::max(0.0, std::min(above - high, low - (above - kTurn)));
}

// How near the flight comes to a keyframe within its window of time.
struct Meeting {
  double from = 0, to = 0;  // s, the part of the window that lies within the flight
  double outside = 0;       // s, how far the keyframe's time lies outside the flight
  double distance = std::numeric_limits<double>::infinity(), distance_at = 0;
  double angle = std::numeric_limits<double>::infinity(), angle_at = 0;
};

Meeting window_of(const KeyframeTask& keyframe, const Trajectory& trajectory) {
  const double start = trajectory.samples.front().time, end = trajectory.samples.back().time;
  Meeting meeting;
  meeting.outside = std::max({0.0, start - keyframe.time, keyframe.time - end});
  meeting.from = std::clamp(keyframe.time - keyframe.time_tolerance, start, end);
  meeting.to = std::clamp(keyframe.time + keyframe.time_tolerance, start, end);
  return meeting;
}

void see(const KeyframeTask& keyframe, const MotionPoint& a, const MotionPoint& b,
         Meeting& meeting) {
  if (b.time < meeting.from || a.time > meeting.to) return;
  const double h = b.time - a.time;
  const auto share = [&](double t) { return h > 0 ? std::clamp((t - a.time) / h, 0.0, 1.0) : 0.0; };
  const double s0 = share(meeting.from), s1 = share(meeting.to), time = a.time + s0 * h;
  const auto place = [&](double s) -> Eigen::Vector3d {
    return a.position + s * (b.position - a.position);
  };
  const double distance = distance_to_line(keyframe.position, place(s0), place(s1));
  if (distance < meeting.distance) meeting.distance = distance, meeting.distance_at = time;
  if (!keyframe.yaw) return;
  const double turn = b.yaw - a.yaw;
  const double angle = angle_to_range(*keyframe.yaw, a.yaw + s0 * turn, a.yaw + s1 * turn);
  if (angle < meeting.angle) meeting.angle = angle, meeting.angle_at = time;
}

std::vector<Meeting> meetings_of(const Flight& flight) {
  const auto& keyframes = flight.plan.task.keyframes;
  Motion& motion = flight.motion;
  std::vector<Meeting> meetings;
  for (const KeyframeTask& k : keyframes) {
    meetings.push_back(window_of(k, flight.plan.trajectory));
  }
  const auto see_all = [&](const MotionPoint& a, const MotionPoint& b) {
    for (std::size_t k = 0; k < keyframes.size(); ++k) see(keyframes[k], a, b, meetings[k]);
  };
  for (std::size_t i = 0; i <= motion.intervals(); ++i) see_all(motion.stated(i), motion.stated(i));
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) see_all(points[k - 1], points[k]);
  }
  return meetings;
}

// Each keyframe has a tolerance of its own, so the worst one is the worst share of its tolerance.
class WorstKeyframe {
 public:
  explicit WorstKeyframe(const char* name) : check_(make_check(name)) {}

  void see(double value, double limit, double at, std::size_t index) {
    const double share = value / std::max(limit, tolerances::kLimitFloor);
    if (seen_ && share <= share_) return;
    seen_ = true;
    share_ = share;
    check_ = judged(make_check(check_.name), value, limit, tolerance_of(limit), at);
    check_.detail +=
        (check_.detail.empty() ? "" : "; ") + ("keyframe " + std::to_string(index + 1));
  }

  Check check(const char* reason) const {
    return seen_ ? check_ : skipped_check(check_.name, reason);
  }

 private:
  Check check_;
  bool seen_ = false;
  double share_ = 0;
};

}  // namespace

void check_task(const Flight& flight, const std::optional<FlownPath>& flown,
                Certificate& certificate) {
  const auto& keyframes = flight.plan.task.keyframes;
  const std::vector<Meeting> meetings = meetings_of(flight);
  WorstKeyframe time("keyframe_time"), miss("keyframe_miss"), yaw("keyframe_yaw");
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const Meeting& m = meetings[k];
    time.see(m.outside, keyframes[k].time_tolerance, keyframes[k].time, k);
    miss.see(m.distance, keyframes[k].tolerance, m.distance_at, k);
    if (keyframes[k].yaw) yaw.see(m.angle, keyframes[k].yaw_tolerance, m.angle_at, k);
  }
  auto& checks = certificate.checks;
  checks.push_back(time.check("the task has no keyframe"));
  checks.push_back(miss.check("the task has no keyframe"));
  checks.push_back(yaw.check("no keyframe states a yaw"));
  check_framing(flight, certificate);
  check_gates(flight, certificate);
  check_drawing(flight, flown, certificate);
}

}  // namespace lapwing
