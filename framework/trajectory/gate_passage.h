// SPDX-License-Identifier: Apache-2.0
// How a path goes through a gate: where, when, and how far outside its opening at worst.
#pragma once

#include <limits>
#include <span>

#include "framework/trajectory/gate.h"

namespace lapwing {

struct PathPoint {
  double time = 0;                                     // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
};

struct GatePassage {
  // m outside the opening, and the tunnel, at worst; negative inside. Infinite: never through.
  double outside = std::numeric_limits<double>::infinity();
  double time = 0;        // s, of that
  std::size_t after = 0;  // the chord from which the next gate is looked for
  double share = 0;       // of that chord, where the gate was left
};

// By the chords of the path from `share` of the one that begins at point `from` on: the first
// passage in the gate's direction that is at most `tolerance` metres outside, else the best one. A
// path that ends at most `tolerance` before the gate's plane, or its tunnel's end, has reached it.
GatePassage gate_passage(const GateTask& gate, std::span<const PathPoint> path, std::size_t from,
                         double tolerance, double share = 0);

// m outside a convex polygon with corners in counter-clockwise order; negative inside.
double outside_of(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p);

}  // namespace lapwing
