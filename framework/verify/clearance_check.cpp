// SPDX-License-Identifier: Apache-2.0
// Distance of the continuous path from every obstacle and zone, never overestimated.
//
// How: the path between two integrated points is replaced by their chord. It leaves the chord by at
// most |a|max h^2 / 8 (`bulge`), which is subtracted from the distance. For each chord and
// obstacle:
//   1. A distance changes by at most the way travelled. So the distance at the middle of the chord,
//      less half its length, is a lower bound. If it is above the worst so far, the chord is done.
//   2. Else the smallest distance on the chord is searched: by golden sections where the distance
//      is a convex function, by the shape's own exact answer if it has one, else by halving (branch
//      and bound with the same lower bound).
// An obstacle that moves is straight in between its times. The chord is cut there and taken
// relative to the obstacle, where it is straight again. For an obstacle to stay inside of, the sign
// is turned.
#include <algorithm>
#include <map>
#include <string_view>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/verify/checks.h"
#include "framework/verify/straight_way.h"

namespace lapwing {
namespace {

constexpr double kApart = 1e-9;  // m, above what rounding can do

struct Chord {
  Eigen::Vector3d from, to;
  double bulge;
  Eigen::Vector3d at(double s) const { return from + s * (to - from); }
};

// An obstacle where it stands, from the side that the flight keeps to. Distances are never above
// the true ones, and told apart up to `reach` metres.
struct Body {
  const JudgedShape& shape;
  double sign = 1;  // -1: how far inside
  double reach = 0;

  double distance(const Eigen::Vector3d& p, double more = 0) const {
    return sign * shape.distance(p, reach + shape.error() + more) - shape.error();
  }
};

// The smallest distance on a chord and its share of it; never above the true one.
struct Nearest {
  double distance, share;
};

// By golden sections: the distance along the chord is convex.
Nearest nearest_of_convex(const Body& body, const Chord& chord) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double value_a = body.distance(chord.at(a)), value_b = body.distance(chord.at(b));
  for (int i = 0; i < 50; ++i) {
    if (value_a < value_b) {
      high = b, b = a, value_b = value_a;
      a = high - kGolden * (high - low), value_a = body.distance(chord.at(a));
    } else {
      low = a, a = b, value_a = value_b;
      b = low + kGolden * (high - low), value_b = body.distance(chord.at(b));
    }
  }
  Nearest best{body.distance(chord.from), 0};
  for (const double share : {(low + high) / 2, 1.0}) {
    const double value = body.distance(chord.at(share));
    if (value < best.distance) best = {value, share};
  }
  return best;
}

// What need not be convex: halves of the chord that may hold less than the best so far are halved
// again, down to a length that is taken off the distance.
Nearest nearest_by_halves(const Body& body, const Chord& chord) {
  const double length = (chord.to - chord.from).norm();
  const double resolution = std::max(tolerances::kBulge, length / 2048);
  Nearest best{body.distance(chord.from), 0};
  std::vector<std::pair<double, double>> parts{{0.0, 1.0}};
  while (!parts.empty()) {
    const auto [from, to] = parts.back();
    parts.pop_back();
    const double middle = (from + to) / 2, half = (to - from) / 2 * length;
    const double value = body.distance(chord.at(middle), half);
    if (value - half >= best.distance) continue;
    if (half <= resolution) {
      best = {value - half, middle};
    } else {
      if (value < best.distance) best = {value, middle};
      parts.emplace_back(middle, to);
      parts.emplace_back(from, middle);
    }
  }
  return best;
}

Nearest nearest(const Body& body, const Chord& chord) {
  if (body.sign > 0) {
    if (body.shape.convex()) return nearest_of_convex(body, chord);
    if (const auto exact = body.shape.nearest(chord.from, chord.to, body.reach))
      return {exact->distance, exact->share};
  }
  return nearest_by_halves(body, chord);
}

class Clearance {
 public:
  Clearance(const char* check, double margin)
      : worst_(check, margin, tolerances::kClearance, true), margin_(margin) {}

  // `number`: of the obstacle in the list, for its name.
  void see(const Obstacle& obstacle, const JudgedShape& shape, std::size_t number,
           const Chord& chord, double time, double duration) {
    Body body{shape, obstacle.side == Side::keep_inside ? -1.0 : 1.0, shape.reach() + margin_};
    // Nothing farther away than the worst so far has to be told apart.
    if (seen_ && body.sign > 0 && std::isfinite(body.reach))
      body.reach = std::min(body.reach, worst_.value() + chord.bulge + kApart);
    // Distances change by no more than the way travelled, so most chords need one evaluation.
    const double length = (chord.to - chord.from).norm();
    const double around = length / 2 + chord.bulge;
    const double lowest = body.distance(chord.at(0.5), around) - around;
    if (seen_ && lowest >= worst_.value()) return;
    seen_ = true;
    const Nearest best = nearest(body, chord);
    if (worst_.see(best.distance - chord.bulge, time + best.share * duration)) {
      nearest_ = obstacle.label(number);
      if (shape.by_triangles()) nearest_ += ", judged by its triangles";
    }
  }

  Check check() const {
    Check check = worst_.check();
    check.detail += (check.detail.empty() ? "" : "; ") + nearest_;
    return check;
  }

 private:
  Worst worst_;
  double margin_;
  bool seen_ = false;
  std::string nearest_;
};

// The chord as an obstacle that moves sees it. It is cut where the obstacle turns.
template <class See>
void relative(const Obstacle& obstacle, const Chord& chord, double time, double duration, See see) {
  if (obstacle.still()) return see(chord, time, duration);
  const double finish = time + duration;
  const auto part = [&](double from, double to) {
    const auto share = [&](double at) { return duration > 0 ? (at - time) / duration : 0.0; };
    see(Chord{chord.at(share(from)) - obstacle.moved(from),
              chord.at(share(to)) - obstacle.moved(to), chord.bulge},
        from, to - from);
  };
  double from = time;
  for (const double turn : obstacle.times) {
    if (!(turn > from) || !(turn < finish)) continue;
    part(from, turn);
    from = turn;
  }
  part(from, finish);
}

void see_all(const Flight& flight, Side side, const Chord& chord, double time, double duration,
             Clearance& clearance) {
  std::map<std::string_view, std::size_t> count;  // of a type
  const auto& obstacles = flight.plan.environment.obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (obstacles[i].side != side) continue;
    const std::size_t number = ++count[obstacles[i].type];
    relative(obstacles[i], chord, time, duration, [&](const Chord& c, double start, double length) {
      clearance.see(obstacles[i], *flight.shapes[i], number, c, start, length);
    });
  }
}

// Calls see(chord, time, duration) for the samples and for all that lies between them.
template <class See>
void along(Motion& motion, See see) {
  for (std::size_t i = 0; i <= motion.intervals(); ++i) {
    const MotionPoint p = motion.stated(i);
    see(Chord{p.position, p.position, 0}, p.time, 0.0);
  }
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const MotionPoint& a = points[k - 1];
      const MotionPoint& b = points[k];
      const double h = b.time - a.time;
      const double bulge = std::max(a.acceleration.norm(), b.acceleration.norm()) * h * h / 8;
      see(Chord{a.position, b.position, bulge}, a.time, h);
    }
  }
}

// `none`: why there is nothing to check.
void check_side(const Flight& flight, Side side, const char* name, const char* none,
                Certificate& certificate) {
  const Environment& environment = flight.plan.environment;
  if (std::none_of(environment.obstacles.begin(), environment.obstacles.end(),
                   [&](const Obstacle& obstacle) { return obstacle.side == side; })) {
    certificate.checks.push_back(skipped_check(name, none));
    return;
  }
  Clearance clearance(name, environment.margin);
  along(flight.motion, [&](const Chord& chord, double time, double duration) {
    see_all(flight, side, chord, time, duration, clearance);
  });
  Check check = clearance.check();
  if (environment.accuracy > 0)
    check.detail += (check.detail.empty() ? "" : "; ") +
                    ("the margin includes " + plain_number(environment.accuracy) +
                     " m, the accuracy of the position");
  certificate.checks.push_back(check);
}

}  // namespace

void check_clearance(const Flight& flight, Certificate& certificate) {
  check_side(flight, Side::keep_out, "clearance", "the environment has no obstacle", certificate);
}

void check_flight_zones(const Flight& flight, Certificate& certificate) {
  check_side(flight, Side::keep_inside, "flight_zone", "the environment has no flight zone",
             certificate);
}

StraightWay::StraightWay(const Environment& environment, const std::filesystem::path& folder,
                         const Eigen::Vector3d& place, double around)
    : environment_(environment) {
  const double room = around + environment.margin + tolerances::kMapReach;
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(room);
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    const Obstacle& obstacle = environment.obstacles[i];
    const Value* file = obstacle.parameters.find("file");
    Eigen::AlignedBox3d box(place - corner, place + corner);
    for (const Eigen::Vector3d& move : obstacle.moves) {
      box.extend(place - corner - move);
      box.extend(place + corner - move);
    }
    try {
      shapes_.push_back(judged_shape(
          obstacle, file && file->is_text() ? folder / file->as_text() : std::filesystem::path(),
          box));
    } catch (const std::exception& error) {
      throw InputError(obstacle.label(i + 1) + ": " + error.what());
    }
  }
}

StraightWay::~StraightWay() = default;
StraightWay::StraightWay(StraightWay&&) noexcept = default;

std::string StraightWay::blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                 double time) const {
  constexpr double kForgiven = 0.05;  // m
  const auto near = [](const std::string& what, double distance, double wanted) {
    return what + " is at " + plain_number(distance, 3) + " m of the way, " +
           plain_number(wanted, 3) + " m are kept";
  };
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Obstacle& obstacle = environment_.obstacles[i];
    const double sign = obstacle.side == Side::keep_inside ? -1.0 : 1.0;
    const Body body{*shapes_[i], sign, shapes_[i]->reach() + environment_.margin};
    const Eigen::Vector3d moved = obstacle.moved(time);
    const double distance = nearest(body, Chord{from - moved, to - moved, 0}).distance;
    if (!(distance >= environment_.margin - kForgiven))
      return near(obstacle.label(i + 1), distance, environment_.margin);
  }
  for (const Subject& subject : environment_.subjects) {
    const Eigen::Vector3d way = to - from, off = subject.position(time) - from;
    const double share = std::clamp(off.dot(way) / std::max(1e-12, way.squaredNorm()), 0.0, 1.0);
    const double distance = (off - share * way).norm();
    if (distance < subject.distance - kForgiven)
      return near("subject '" + subject.name + "'", distance, subject.distance);
  }
  return {};
}

}  // namespace lapwing
