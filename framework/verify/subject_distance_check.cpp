// SPDX-License-Identifier: Apache-2.0
// The distance that the path keeps from subjects that ask for one, never overestimated.
//
// Between two integrated points, and between two corners of the subject's track, both move along
// chords: the path leaves its own by at most |a|max h^2 / 8, which is taken off the distance.
#include <algorithm>
#include <cstdio>
#include <limits>

#include "framework/verify/checks.h"

namespace lapwing {
namespace {

std::string named(const Subject& subject) {
  return (subject.filmed ? "subject '" : "bystander '") + subject.name + "'";
}

// How near the path comes to a subject.
class Nearness {
 public:
  explicit Nearness(const Subject& subject) : subject_(subject) {}

  // `from` and `to`: from the subject to the path.
  void see(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double bulge, double start,
           double duration) {
    const Eigen::Vector3d way = to - from;
    const double squared = way.squaredNorm();
    const double share = squared > 0 ? std::clamp(-from.dot(way) / squared, 0.0, 1.0) : 0.0;
    const double distance = (from + share * way).norm() - bulge;
    if (distance >= distance_) return;
    distance_ = distance;
    at_ = start + share * duration;
  }

  double spare() const { return distance_ - subject_.distance; }

  Check check() const {
    Check check = judged(make_check("subject_distance"), distance_, subject_.distance,
                         tolerances::kClearance, at_, true);
    if (!check.detail.empty()) check.detail += "; ";
    check.detail += named(subject_);
    return check;
  }

  // "bystander 'bob' 8.2 m at 3.1 s, asks for 5 m"
  std::string in_words() const {
    char text[96];
    std::snprintf(text, sizeof text, " %.4g m at %.4g s, requires %.4g m", distance_, at_,
                  subject_.distance);
    return named(subject_) + text;
  }

  // One chord of the path, cut where the track has a corner.
  void see_chord(const MotionPoint& a, const MotionPoint& b) {
    const double h = b.time - a.time;
    const double bulge = std::max(a.acceleration.norm(), b.acceleration.norm()) * h * h / 8;
    const auto offset = [&](double time) -> Eigen::Vector3d {
      const double share = h > 0 ? (time - a.time) / h : 0.0;
      return a.position + share * (b.position - a.position) - subject_.position(time);
    };
    double from = a.time;
    for (const double corner : subject_.times) {
      if (corner <= from || corner >= b.time) continue;
      see(offset(from), offset(corner), bulge, from, corner - from);
      from = corner;
    }
    see(offset(from), offset(b.time), bulge, from, b.time - from);
  }

 private:
  const Subject& subject_;
  double distance_ = std::numeric_limits<double>::infinity(), at_ = 0;
};

// The check of the subject whose distance falls short the most; of several, the others are told
// too.
Check check_of(const std::vector<Nearness>& all) {
  const auto less = [](const Nearness& a, const Nearness& b) { return a.spare() < b.spare(); };
  const auto worst = std::min_element(all.begin(), all.end(), less);
  Check check = worst->check();
  for (auto each = all.begin(); each != all.end(); ++each)
    if (each != worst) check.detail += "; " + each->in_words();
  return check;
}

}  // namespace

void check_subject_distance(const Flight& flight, Certificate& certificate) {
  std::vector<Nearness> asking;
  for (const Subject& subject : flight.plan.environment.subjects)
    if (subject.distance > 0) asking.emplace_back(subject);
  if (asking.empty()) {
    certificate.checks.push_back(
        skipped_check("subject_distance", "no subject requires a distance"));
    return;
  }
  Motion& motion = flight.motion;
  for (Nearness& nearness : asking)
    for (std::size_t i = 0; i <= motion.intervals(); ++i) {
      const MotionPoint p = motion.stated(i);
      nearness.see_chord(p, p);
    }
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k)
      for (Nearness& nearness : asking) nearness.see_chord(points[k - 1], points[k]);
  }
  certificate.checks.push_back(check_of(asking));
}

}  // namespace lapwing
