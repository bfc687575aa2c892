// The distance that the path keeps from subjects that ask for one, never overestimated.
//
// Between two integrated points, and between two corners of the subject's track, both move along
// chords: the path leaves its own by at most |a|max h^2 / 8, which is taken off the distance.
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

// Of the subject whose distance falls short the most.
class Nearness {
 public:
  // `from` and `to`: from the subject to the path.
  void see(const Subject& subject, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
           double bulge, double start, double duration) {
    const Eigen::Vector3d way = to - from;
    const double squared = way.squaredNorm();
    const double share = squared > 0 ? std::clamp(-from.dot(way) / squared, 0.0, 1.0) : 0.0;
    const double distance = (from + share * way).norm() - bulge;
    if (subject_ != nullptr && distance - subject.distance >= distance_ - subject_->distance)
      return;
    subject_ = &subject;
    distance_ = distance;
    at_ = start + share * duration;
  }

  Check check() const {
    Check check = judged(make_check("subject_distance"), distance_, subject_->distance,
                         tolerances::kClearance, at_, true);
    if (!check.detail.empty()) check.detail += "; ";
    check.detail += (subject_->filmed ? "subject '" : "bystander '") + subject_->name + "'";
    return check;
  }

 private:
  const Subject* subject_ = nullptr;
  double distance_ = 0, at_ = 0;
};

// One chord of the path, cut where the track has a corner.
void see_chord(const Subject& subject, const MotionPoint& a, const MotionPoint& b,
               Nearness& nearness) {
  const double h = b.time - a.time;
  const double bulge = std::max(a.acceleration.norm(), b.acceleration.norm()) * h * h / 8;
  const auto offset = [&](double time) -> Eigen::Vector3d {
    const double share = h > 0 ? (time - a.time) / h : 0.0;
    return a.position + share * (b.position - a.position) - subject.position(time);
  };
  double from = a.time;
  for (const double corner : subject.times) {
    if (corner <= from || corner >= b.time) continue;
    nearness.see(subject, offset(from), offset(corner), bulge, from, corner - from);
    from = corner;
  }
  nearness.see(subject, offset(from), offset(b.time), bulge, from, b.time - from);
}

}  // namespace

void check_subject_distance(const Flight& flight, Certificate& certificate) {
  std::vector<const Subject*> asking;
  for (const Subject& subject : flight.plan.environment.subjects)
    if (subject.distance > 0) asking.push_back(&subject);
  if (asking.empty()) {
    certificate.checks.push_back(
        skipped_check("subject_distance", "no subject asks for a distance"));
    return;
  }
  Motion& motion = flight.motion;
  Nearness nearness;
  for (const Subject* subject : asking)
    for (std::size_t i = 0; i <= motion.intervals(); ++i) {
      const MotionPoint p = motion.stated(i);
      see_chord(*subject, p, p, nearness);
    }
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k)
      for (const Subject* subject : asking) see_chord(*subject, points[k - 1], points[k], nearness);
  }
  certificate.checks.push_back(nearness.check());
}

}  // namespace lapwing
