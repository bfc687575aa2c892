// Distance of the continuous path from every obstacle, never overestimated.
//
// The path between two integrated points is replaced by their chord; it leaves the chord by at most
// |a|max h^2 / 8 (kBulge), which is taken off the distance.
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

struct Chord {
  Eigen::Vector3d from, to;
  double bulge;
  Eigen::Vector3d at(double s) const { return from + s * (to - from); }
};

// Signed distances of a point from a surface: negative inside. Both are convex functions of the
// point.
double distance(const Sphere& sphere, const Eigen::Vector3d& p) {
  return (p - sphere.center).norm() - sphere.radius;
}

double distance(const Box& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d beyond = (box.lower - p).cwiseMax(p - box.upper);
  const double deepest = beyond.maxCoeff();
  return deepest <= 0 ? deepest : beyond.cwiseMax(0.0).norm();
}

// The nearest share of the chord, by golden sections: the distance along it is convex.
template <class Obstacle>
double nearest_share(const Obstacle& obstacle, const Chord& chord) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double value_a = distance(obstacle, chord.at(a)), value_b = distance(obstacle, chord.at(b));
  for (int i = 0; i < 50; ++i) {
    if (value_a < value_b) {
      high = b, b = a, value_b = value_a;
      a = high - kGolden * (high - low), value_a = distance(obstacle, chord.at(a));
    } else {
      low = a, a = b, value_a = value_b;
      b = low + kGolden * (high - low), value_b = distance(obstacle, chord.at(b));
    }
  }
  return (low + high) / 2;
}

class Clearance {
 public:
  explicit Clearance(double margin) : worst_("clearance", margin, tolerances::kClearance, true) {}

  template <class Obstacle>
  void see(const Obstacle& obstacle, const char* kind, std::size_t number, const Chord& chord,
           double time, double duration) {
    // Distances change by no more than the way travelled, so most chords need one evaluation.
    const double length = (chord.to - chord.from).norm();
    const double lowest = distance(obstacle, chord.at(0.5)) - length / 2 - chord.bulge;
    if (seen_ && lowest >= worst_.value()) return;
    seen_ = true;
    double best = distance(obstacle, chord.from), share = 0;
    const double inner = length > 0 ? nearest_share(obstacle, chord) : 0.0;
    for (const double s : {inner, 1.0}) {
      const double value = distance(obstacle, chord.at(s));
      if (value < best) best = value, share = s;
    }
    if (worst_.see(best - chord.bulge, time + share * duration)) {
      nearest_ = obstacle.name.empty() ? std::string(kind) + " " + std::to_string(number + 1)
                                       : std::string(kind) + " '" + obstacle.name + "'";
    }
  }

  Check check() const {
    Check check = worst_.check();
    check.detail += (check.detail.empty() ? "" : "; ") + nearest_;
    return check;
  }

 private:
  Worst worst_;
  bool seen_ = false;
  std::string nearest_;
};

void see_all(const Environment& environment, const Chord& chord, double time, double duration,
             Clearance& clearance) {
  for (std::size_t i = 0; i < environment.spheres.size(); ++i) {
    clearance.see(environment.spheres[i], "sphere", i, chord, time, duration);
  }
  for (std::size_t i = 0; i < environment.boxes.size(); ++i) {
    clearance.see(environment.boxes[i], "box", i, chord, time, duration);
  }
}

}  // namespace

void check_clearance(const Flight& flight, Certificate& certificate) {
  const Environment& environment = flight.plan.environment;
  if (environment.spheres.empty() && environment.boxes.empty()) {
    certificate.checks.push_back(skipped_check("clearance", "the environment has no obstacle"));
    return;
  }
  Motion& motion = flight.motion;
  Clearance clearance(environment.margin);
  for (std::size_t i = 0; i <= motion.intervals(); ++i) {
    const MotionPoint p = motion.stated(i);
    see_all(environment, {p.position, p.position, 0}, p.time, 0, clearance);
  }
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const MotionPoint& a = points[k - 1];
      const MotionPoint& b = points[k];
      const double h = b.time - a.time;
      const double bulge = std::max(a.acceleration.norm(), b.acceleration.norm()) * h * h / 8;
      see_all(environment, {a.position, b.position, bulge}, a.time, h, clearance);
    }
  }
  certificate.checks.push_back(clearance.check());
}

}  // namespace lapwing
