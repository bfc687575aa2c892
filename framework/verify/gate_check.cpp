// Is every gate flown through in its order, in its direction, inside its opening, and its tunnel
// held from end to end? On the continuous path, by the chords of the integrated motion.
//
// Gates are met one after the other: each is looked for from where the one before was left, and the
// first passage that is good counts. Of a passage the value is how far outside its opening the path
// is at worst, negative inside.
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct PathPoint {
  double time;
  Vector3d position;
};

std::vector<PathPoint> path_of(const Flight& flight) {
  std::vector<PathPoint> path;
  for (std::size_t i = 0; i < flight.motion.intervals(); ++i)
    for (const MotionPoint& p : flight.motion.integrate(i)) path.push_back({p.time, p.position});
  return path;
}

// How far outside a convex polygon with corners in counter-clockwise order; negative inside.
double outside(const std::vector<Vector2d>& corners, const Vector2d& p) {
  double worst = -kInfinity;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2d &a = corners[k], edge = corners[(k + 1) % corners.size()] - a;
    worst = std::max(worst, (edge.y() * (p - a).x() - edge.x() * (p - a).y()) / edge.norm());
  }
  return worst;
}

struct Passage {
  double outside = kInfinity, at = 0;
  std::size_t after = 0;  // the chord from which the next gate is looked for
};

Passage through_ball(const GateTask& gate, const std::vector<PathPoint>& path, std::size_t from) {
  Passage best;
  for (std::size_t k = from; k + 1 < path.size(); ++k) {
    const Vector3d a = path[k].position, chord = path[k + 1].position - a;
    const double length2 = chord.squaredNorm();
    const double s =
        length2 > 0 ? std::clamp((gate.position - a).dot(chord) / length2, 0.0, 1.0) : 0.0;
    const double beyond = (a + s * chord - gate.position).norm() - gate.radius;
    if (beyond < best.outside) best = {beyond, path[k].time, k};
    // Left again: what comes later is another passage.
    if (best.outside <= tolerances::kClearance && beyond > best.outside + gate.radius) break;
  }
  return best;
}

// Follows the path from the chord that enters at `k` until it leaves, by either end.
Passage through_opening(const GateTask& gate, const std::vector<PathPoint>& path, std::size_t k) {
  const double half = 0.5 * gate.tunnel_length;
  const auto along = [&](const Vector3d& p) { return (p - gate.position).dot(gate.direction); };
  const auto beyond = [&](const Vector3d& p) {
    const Vector3d from = p - gate.position;
    return outside(gate.corners, {from.dot(gate.left()), from.dot(gate.up)});
  };
  const auto at_plane = [&](std::size_t chord, double place) -> Vector3d {
    const Vector3d &a = path[chord].position, &b = path[chord + 1].position;
    const double span = along(b) - along(a);
    return a + (span != 0 ? (place - along(a)) / span : 0.0) * (b - a);
  };
  Passage passage{beyond(at_plane(k, -half)), path[k].time, k};
  const auto see = [&](const Vector3d& p, double time) {
    const double value = beyond(p);
    if (value > passage.outside) passage.outside = value, passage.at = time;
  };
  for (; k + 1 < path.size(); ++k) {
    const Vector3d& next = path[k + 1].position;
    if (along(next) >= half) {
      see(at_plane(k, half), path[k].time);
      passage.after = k;
      return passage;
    }
    if (along(next) < -half) break;  // out again where it came in
    see(next, path[k + 1].time);
  }
  passage.outside = kInfinity;
  return passage;
}

Passage passage_of(const GateTask& gate, const std::vector<PathPoint>& path, std::size_t from) {
  if (gate.ball()) return through_ball(gate, path, from);
  Passage best;
  const double entry = -0.5 * gate.tunnel_length;
  for (std::size_t k = from; k + 1 < path.size(); ++k) {
    const double a = (path[k].position - gate.position).dot(gate.direction) - entry;
    const double b = (path[k + 1].position - gate.position).dot(gate.direction) - entry;
    if (!(a < 0 && b >= 0)) continue;
    const Passage passage = through_opening(gate, path, k);
    if (passage.outside < best.outside) best = passage;
    if (best.outside <= tolerances::kClearance) break;
  }
  return best;
}

}  // namespace

void check_gates(const Flight& flight, Certificate& certificate) {
  const auto& gates = flight.plan.task.gates;
  if (gates.empty()) {
    certificate.checks.push_back(skipped_check("gates", "the task has no gate"));
    return;
  }
  const std::vector<PathPoint> path = path_of(flight);
  Passage worst{-kInfinity, 0, 0};
  std::size_t from = 0;
  std::string name;
  for (std::size_t g = 0; g < gates.size(); ++g) {
    const Passage passage = passage_of(gates[g], path, from);
    if (passage.outside > worst.outside) {
      worst = passage;
      name = "gate " + std::to_string(g + 1) + " (" + gates[g].name + ")";
    }
    if (passage.outside == kInfinity) break;
    from = passage.after;
  }
  Check check = judged(make_check("gates"), worst.outside, 0.0, tolerances::kClearance, worst.at);
  check.detail = std::isfinite(worst.outside)
                     ? name
                     : name + " is not flown through in its direction, after the one before";
  certificate.checks.push_back(check);
}

void list_gate_problems(const Task& task, std::vector<std::string>& problems) {
  for (std::size_t g = 0; g < task.gates.size(); ++g) {
    const GateTask& gate = task.gates[g];
    const auto add = [&](const char* what) {
      problems.push_back("gate " + std::to_string(g + 1) + " " + what);
    };
    bool corners = true;
    for (const Vector2d& c : gate.corners) corners &= sound(c.x()) && sound(c.y());
    if (!sound(gate.position) || !sound(gate.tunnel_length) || !corners || !sound(gate.radius)) {
      add("holds a number that is not finite or beyond 1e7");
      continue;
    }
    if (gate.ball()) {
      if (!(gate.radius > 0)) add("is a ball without a radius");
      continue;
    }
    const double unit = tolerances::kUnitLength;
    if (!(std::abs(gate.direction.norm() - 1) < unit && std::abs(gate.up.norm() - 1) < unit &&
          std::abs(gate.direction.dot(gate.up)) < unit))
      add("needs a direction and an up of unit length, across each other");
    if (gate.corners.size() < 3 || !(outside(gate.corners, Vector2d::Zero()) < 0))
      add("needs three corners or more, counter-clockwise around its middle");
    if (!(gate.tunnel_length >= 0)) add("has a tunnel of negative length");
  }
}

}  // namespace lapwing
