// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/path_worlds.h"

#include <algorithm>
#include <cmath>

namespace lapwing {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

bool BlockSpace::swept_box_free(const Vector3d& from, const Vector3d& to,
                                const Vector3d& half) const {
  // A point that moves past a block grown by the body; touching is free.
  constexpr double kTouch = 1e-9;
  return std::none_of(blocks_.begin(), blocks_.end(), [&](const AlignedBox3d& block) {
    double enters = 0, leaves = 1;
    for (int i = 0; i < 3; ++i) {
      const double low = block.min()[i] - half[i] + kTouch,
                   high = block.max()[i] + half[i] - kTouch;
      const double d = to[i] - from[i];
      if (d == 0) {
        if (from[i] <= low || from[i] >= high) return false;
        continue;
      }
      const double a = (low - from[i]) / d, b = (high - from[i]) / d;
      enters = std::max(enters, std::min(a, b));
      leaves = std::min(leaves, std::max(a, b));
    }
    return enters < leaves || (enters == leaves && from == to);
  });
}

AlignedBox3d BlockSpace::bounds() const {
  AlignedBox3d box;
  for (const AlignedBox3d& block : blocks_) box.extend(block);
  return box;
}

std::vector<PathWorld> path_worlds() {
  const auto block = [](double x0, double y0, double z0, double x1, double y1, double z1) {
    return AlignedBox3d(Vector3d(x0, y0, z0), Vector3d(x1, y1, z1));
  };
  const AlignedBox3d room = block(-6, -6, 0, 6, 6, 4);
  const Vector3d half(0.3, 0.3, 0.2), start(-5, 0, 2), goal(5, 0, 2);
  const PathProblem across{nullptr, start, goal, half, room};
  std::vector<PathWorld> worlds;
  worlds.push_back({"an empty room", BlockSpace({}), across, PathStatus::found, 10});
  // The way goes round the pillar's corners, grown by the body: 2.3 m aside.
  worlds.push_back({"a pillar", BlockSpace({block(-1, -2, 0, 1, 2, 4)}), across, PathStatus::found,
                    2 * std::hypot(3.7, 2.3) + 2.6});
  // A window 1.4 m wide at y = 3, reached up or down as well.
  worlds.push_back(
      {"a wall with a window",
       BlockSpace({block(-0.2, -6, 0, 0.2, 2.3, 4), block(-0.2, 3.7, 0, 0.2, 6, 4),
                   block(-0.2, 2.3, 0, 0.2, 3.7, 1), block(-0.2, 2.3, 2.4, 0.2, 3.7, 4)}),
       across, PathStatus::found, 2 * std::hypot(4.5, 2.6) + 1});
  worlds.push_back({"two walls to go round",
                    BlockSpace({block(-2, -6, 0, -1.6, 3.5, 4), block(1.6, -3.5, 0, 2, 6, 4)}),
                    across, PathStatus::found,
                    2 * std::hypot(2.7, 3.8) + 2 + std::hypot(2.6, 7.6)});
  worlds.push_back({"a closed wall", BlockSpace({block(-0.2, -7, -1, 0.2, 7, 5)}), across,
                    PathStatus::iteration_limit, 0});
  // A window that the body does not fit through.
  worlds.push_back({"a window too small",
                    BlockSpace({block(-0.2, -7, -1, 0.2, 2.8, 5), block(-0.2, 3.3, -1, 0.2, 7, 5)}),
                    across, PathStatus::iteration_limit, 0});
  worlds.push_back({"a blocked start", BlockSpace({block(-5.5, -0.5, 0, -4.5, 0.5, 1.9)}), across,
                    PathStatus::start_blocked, 0});
  worlds.push_back({"a blocked goal", BlockSpace({block(5.2, -0.5, 0, 6, 0.5, 4)}), across,
                    PathStatus::goal_blocked, 0});
  PathProblem outside = across;
  outside.goal.x() = 6.5;
  worlds.push_back({"a goal out of bounds", BlockSpace({}), outside, PathStatus::goal_blocked, 0});
  PathProblem nowhere = across;
  nowhere.start.z() = std::nan("");
  worlds.push_back(
      {"a start that is not a number", BlockSpace({}), nowhere, PathStatus::unsupported, 0});
  return worlds;
}

}  // namespace lapwing
