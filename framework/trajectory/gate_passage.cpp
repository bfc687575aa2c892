// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/gate_passage.h"

#include <algorithm>

namespace lapwing {

using Eigen::Vector2d;
using Eigen::Vector3d;

double outside_of(const std::vector<Vector2d>& corners, const Vector2d& p) {
  double worst = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2d &a = corners[k], edge = corners[(k + 1) % corners.size()] - a;
    worst = std::max(worst, (edge.y() * (p - a).x() - edge.x() * (p - a).y()) / edge.norm());
  }
  return worst;
}

namespace {

constexpr double kLeft = 1e-9;  // m: a path that has left a plane lies in it, to rounding

GatePassage through_ball(const GateTask& gate, std::span<const PathPoint> path, std::size_t from,
                         double tolerance) {
  GatePassage best;
  for (std::size_t k = from; k + 1 < path.size(); ++k) {
    const Vector3d a = path[k].position, chord = path[k + 1].position - a;
    const double length2 = chord.squaredNorm();
    const double s =
        length2 > 0 ? std::clamp((gate.position - a).dot(chord) / length2, 0.0, 1.0) : 0.0;
    const double beyond = (a + s * chord - gate.position).norm() - gate.radius;
    if (beyond < best.outside) best = {beyond, path[k].time, k};
    // Left again: what comes later is another passage.
    if (best.outside <= tolerance && beyond > best.outside + gate.radius) break;
  }
  return best;
}

// Follows the path from the chord that enters at `k` until it leaves, by either end.
GatePassage through_opening(const GateTask& gate, std::span<const PathPoint> path, std::size_t k,
                            double tolerance) {
  const double half = 0.5 * gate.tunnel_length;
  const auto along = [&](const Vector3d& p) { return (p - gate.position).dot(gate.direction); };
  const auto beyond = [&](const Vector3d& p) {
    const Vector3d from = p - gate.position;
    return outside_of(gate.corners, {from.dot(gate.left()), from.dot(gate.up)});
  };
  const auto at_plane = [&](std::size_t chord, double place) -> Vector3d {
    const Vector3d &a = path[chord].position, &b = path[chord + 1].position;
    const double span = along(b) - along(a);
    return a + (span != 0 ? (place - along(a)) / span : 0.0) * (b - a);
  };
  GatePassage passage{beyond(at_plane(k, -half)), path[k].time, k};
  const auto see = [&](const Vector3d& p, double time) {
    const double value = beyond(p);
    if (value > passage.outside) passage.outside = value, passage.time = time;
  };
  for (; k + 1 < path.size(); ++k) {
    const Vector3d& next = path[k + 1].position;
    if (along(next) >= half - (k + 2 == path.size() ? tolerance : 0)) {
      see(at_plane(k, half), path[k].time);
      passage.after = k;
      const double a = along(path[k].position), b = along(next);
      passage.share = b > a ? std::clamp((half - a) / (b - a), 0.0, 1.0) : 1.0;
      return passage;
    }
    if (along(next) < -half) break;  // out again where it came in
    see(next, path[k + 1].time);
  }
  passage.outside = std::numeric_limits<double>::infinity();
  return passage;
}

}  // namespace

GatePassage gate_passage(const GateTask& gate, std::span<const PathPoint> path, std::size_t from,
                         double tolerance, double share) {
  if (gate.ball()) return through_ball(gate, path, from, tolerance);
  GatePassage best;
  const double entry = -0.5 * gate.tunnel_length;
  for (std::size_t k = from; k + 1 < path.size(); ++k) {
    double a = (path[k].position - gate.position).dot(gate.direction) - entry;
    const double b = (path[k + 1].position - gate.position).dot(gate.direction) - entry;
    // Half-way through a chord: one passage is not two.
    if (k == from && share > 0) a += share * (b - a) + kLeft;
    // A lap that ends in the plane of its gate has come there, to the tolerance.
    const bool last = k + 2 == path.size();
    if (!(a < 0 && b >= (last ? -tolerance : 0))) continue;
    const GatePassage passage = through_opening(gate, path, k, tolerance);
    if (passage.outside < best.outside) best = passage;
    if (best.outside <= tolerance) break;
  }
  return best;
}

}  // namespace lapwing
