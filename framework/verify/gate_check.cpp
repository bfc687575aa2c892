// SPDX-License-Identifier: Apache-2.0
// Is every gate flown through in its order, in its direction, inside its opening, and its tunnel
// held from end to end? On the continuous path, by the chords of the integrated motion.
//
// Gates are met one after the other: each is looked for from where the one before was left, and the
// first passage that is good counts. Of a passage the value is how far outside its opening the path
// is at worst, negative inside.
#include "framework/trajectory/gate_passage.h"
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<PathPoint> path_of(const Flight& flight) {
  std::vector<PathPoint> path;
  for (std::size_t i = 0; i < flight.motion.intervals(); ++i)
    for (const MotionPoint& p : flight.motion.integrate(i)) path.push_back({p.time, p.position});
  return path;
}

}  // namespace

void check_gates(const Flight& flight, Certificate& certificate) {
  const auto& gates = flight.plan.task.gates;
  if (gates.empty()) {
    certificate.checks.push_back(skipped_check("gates", "the task has no gate"));
    return;
  }
  const std::vector<PathPoint> path = path_of(flight);
  GatePassage worst{-std::numeric_limits<double>::infinity(), 0, 0};
  std::size_t from = 0;
  double share = 0;
  std::string name;
  for (std::size_t g = 0; g < gates.size(); ++g) {
    const GatePassage passage = gate_passage(gates[g], path, from, tolerances::kClearance, share);
    if (passage.outside > worst.outside) {
      worst = passage;
      name = "gate " + std::to_string(g + 1) + " (" + gates[g].name + ")";
    }
    if (!std::isfinite(passage.outside)) break;
    from = passage.after;
    share = passage.share;
  }
  Check check = judged(make_check("gates"), worst.outside, 0.0, tolerances::kClearance, worst.time);
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
    if (gate.corners.size() < 3 || !(outside_of(gate.corners, Vector2d::Zero()) < 0))
      add("needs three corners or more, counter-clockwise around its middle");
    if (!(gate.tunnel_length >= 0)) add("has a tunnel of negative length");
  }
}

}  // namespace lapwing
