// SPDX-License-Identifier: Apache-2.0
// Heights and distances from the take-off place, and heights above the ground of the origin.
//
// With an origin, heights follow the ellipsoid: the ground below a place 1 km away lies 8 cm below
// the plane z = 0. Without one they are differences of z. Between two integrated points the path
// leaves their chord by at most |a|max h^2 / 8, which counts against the plan.
#include <cmath>
#include <limits>

#include "framework/core/number_text.h"
#include "framework/geometry/geodetic.h"
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

// Heights of places of a plan's world.
class Heights {
 public:
  explicit Heights(const Plan& plan) : origin_(plan.geodetic_origin) {
    if (plan.home) home_ = of(plan.home->position);
  }

  double above_home(const Eigen::Vector3d& p) const { return of(p) - home_; }
  bool ground() const { return origin_ && origin_->height_of == HeightOf::ground; }
  // Of an origin whose height counts from the ground there.
  double above_ground(const Eigen::Vector3d& p) const { return of(p); }

 private:
  // m, above what the origin's point counts from; without an origin above the plane z = 0.
  double of(const Eigen::Vector3d& p) const {
    return origin_ ? to_geodetic(origin_->point(), p).altitude : p.z();
  }

  const std::optional<GeodeticOrigin>& origin_;
  double home_ = 0;
};

double distance_across(const Home& home, const Eigen::Vector3d& p) {
  return (p - home.position).head<2>().norm();
}

// Calls see(place, time, bulge) for the samples and for the ends of all steps between them.
template <class See>
void along(Motion& motion, See see) {
  for (std::size_t i = 0; i <= motion.intervals(); ++i) {
    const MotionPoint p = motion.stated(i);
    see(p.position, p.time, 0.0);
  }
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const MotionPoint &a = points[k - 1], &b = points[k];
      const double h = b.time - a.time;
      const double bulge = std::max(a.acceleration.norm(), b.acceleration.norm()) * h * h / 8;
      see(a.position, a.time, bulge);
      see(b.position, b.time, bulge);
    }
  }
}

Check detailed(const Worst& worst, const std::string& detail) {
  Check check = worst.check();
  check.detail += (check.detail.empty() ? "" : "; ") + detail;
  return check;
}

// What a rally point has to spare of everything that is asked of the flight; negative where it
// breaks something.
struct Spare {
  double distance = std::numeric_limits<double>::infinity();
  std::string of;

  void see(double spare, const std::string& what) {
    if (spare < distance) *this = {spare, what};
  }
};

Spare spare_of(const Flight& flight, const Heights& heights, const Eigen::Vector3d& point) {
  const Environment& environment = flight.plan.environment;
  const Home& home = *flight.plan.home;
  Spare spare;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    const Obstacle& obstacle = environment.obstacles[i];
    const JudgedShape& shape = *flight.shapes[i];
    const double sign = obstacle.side == Side::keep_inside ? -1.0 : 1.0;
    const double reach = shape.reach() + environment.margin + shape.error();
    std::vector<Eigen::Vector3d> moves = obstacle.moves;
    if (moves.empty()) moves.push_back(Eigen::Vector3d::Zero());
    for (const Eigen::Vector3d& move : moves)
      spare.see(sign * shape.distance(point - move, reach) - shape.error() - environment.margin,
                obstacle.label(i + 1));
  }
  if (home.max_height)
    spare.see(*home.max_height - heights.above_home(point), "the largest height above home");
  if (home.max_distance)
    spare.see(*home.max_distance - distance_across(home, point), "the largest distance from home");
  if (heights.ground()) spare.see(heights.above_ground(point), "the ground");
  return spare;
}

void check_rally_points(const Flight& flight, const Heights& heights, Certificate& certificate) {
  Worst worst("rally_points", 0, tolerances::kClearance, true);
  std::string detail;
  const auto& points = flight.plan.home->rally_points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Spare spare = spare_of(flight, heights, points[i]);
    if (!std::isfinite(spare.distance)) continue;
    if (worst.see(spare.distance, 0))
      detail = "rally point " + std::to_string(i + 1) + ", " + spare.of;
  }
  if (detail.empty())
    certificate.checks.push_back(
        skipped_check("rally_points", "the plan has no obstacle and no limit for them"));
  else
    certificate.checks.push_back(detailed(worst, detail));
}

}  // namespace

void check_home(const Flight& flight, Certificate& certificate) {
  const Heights heights(flight.plan);
  const std::optional<Home>& home = flight.plan.home;
  const bool high = home && home->max_height, far = home && home->max_distance;
  Worst height("height_above_home", high ? *home->max_height : 0);
  Worst distance("distance_from_home", far ? *home->max_distance : 0);
  Worst ground("height_above_ground", 0, tolerances::kClearance, true);
  if (high || far || heights.ground())
    along(flight.motion, [&](const Eigen::Vector3d& p, double time, double bulge) {
      if (high) height.see(heights.above_home(p) + bulge, time);
      if (far) distance.see(distance_across(*home, p) + bulge, time);
      if (heights.ground()) ground.see(heights.above_ground(p) - bulge, time);
    });
  if (high)
    certificate.checks.push_back(detailed(
        height, "the take-off place is at z = " + plain_number(home->position.z(), 4) + " m"));
  if (far) certificate.checks.push_back(distance.check());
  if (heights.ground())
    certificate.checks.push_back(detailed(ground, "the ground at the origin, taken as level"));
  if (home && !home->rally_points.empty()) check_rally_points(flight, heights, certificate);
}

void list_home_problems(const Plan& plan, std::vector<std::string>& problems) {
  if (!plan.home) return;
  const Home& home = *plan.home;
  if (!sound(home.position))
    problems.emplace_back("the take-off place holds a number that is not finite or beyond 1e7");
  const auto positive = [&](const std::optional<double>& limit, const char* what) {
    if (limit && (!sound(*limit) || !(*limit > 0)))
      problems.push_back(std::string(what) + " from home must be above 0");
  };
  positive(home.max_height, "the largest height");
  positive(home.max_distance, "the largest distance");
  for (std::size_t i = 0; i < home.rally_points.size(); ++i)
    if (!sound(home.rally_points[i]))
      problems.push_back("rally point " + std::to_string(i + 1) +
                         " holds a number that is not finite or beyond 1e7");
}

}  // namespace lapwing
