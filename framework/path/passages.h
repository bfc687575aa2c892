// SPDX-License-Identifier: Apache-2.0
// Passages: classes of ways that deform into one another while every point sees its counterpart
// (thesis 6.1), and convex regions grown round a way. World frame, metres.
//
// In three dimensions bounded obstacles leave one homotopy class, so what is told apart here is
// finer: visibility deformation. Two ways are of one class when places at equal shares of their
// lengths are joined by free straight lines.
#pragma once

#include <span>

#include "framework/path/path_planner.h"

namespace lapwing {

// At `samples` shares of the length, the ends apart, of ways between the same two places.
bool same_passage(const FreeSpace& space, std::span<const Eigen::Vector3d> a,
                  std::span<const Eigen::Vector3d> b, int samples = 100);

// The place, `share` of the way's length from its start.
Eigen::Vector3d place_on(std::span<const Eigen::Vector3d> way, double share);

// Where the way has least room for a cube about it, ends apart, and the half edge of that cube.
struct Narrowest {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double room = 0;  // m, 20 at most
};
Narrowest narrowest(const FreeSpace& space, std::span<const Eigen::Vector3d> way);

struct PassageSearch {
  std::vector<std::vector<Eigen::Vector3d>> excluded;  // ways whose passages are closed
  int tries = 20;                                      // of the planner
};
struct PassageResult {
  PathResult path;  // of another passage than any excluded one, where found
  int tries = 0;    // of the planner, the last one included
};
// Asks the planner until it finds a way of a passage that is not excluded. Every try has a seed of
// its own, and from the second on the excluded ways are stopped up by balls where they are
// narrowest, larger from try to try; what is found is free in the space as it is. Not found: the
// last report, whose message says how often a known passage came out.
PassageResult find_passage(const PathPlanner& planner, const PathProblem& problem,
                           const PathRequest& request, const PassageSearch& search);

// A chain of boxes along a way: each holds its part of the way, in shares of its length, and is
// free; neighbours share the place where one part ends and the next begins.
struct CorridorBox {
  double from = 0, to = 0;  // shares of the way's length
  Eigen::AlignedBox3d box;
};
// Parts are halved until the box about them is free, then grown face by face by up to `growth`
// metres within the bounds. Empty where the way itself is not free.
std::vector<CorridorBox> grow_corridor(const FreeSpace& space, const Eigen::AlignedBox3d& bounds,
                                       std::span<const Eigen::Vector3d> way, double growth = 5);

}  // namespace lapwing
