// SPDX-License-Identifier: Apache-2.0
// Ways between viewpoints that a vehicle can fly and whose pictures can be matched (thesis 4.4.4,
// algorithm 4; reading 4.5).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "framework/core/progress.h"
#include "framework/path/path_planner.h"
#include "framework/view/viewpoint.h"
#include "framework/view/visible_voxels.h"

namespace lapwing {

struct MotionSettings {
  Eigen::AlignedBox3d allowed;
  Eigen::Vector3d half = {1, 1, 0.5};  // m, half edges of the vehicle's box
  // Each viewpoint is joined with so many of the nearest `among` whose pictures match its own
  // (reading 4.11): views of one place look everywhere, and few of the nearest look the same way.
  int neighbours = 12, among = 120;
  double alpha = 0.4;  // of (4.8); 0: every pair can be matched
  // Where the straight line is blocked; null: such neighbours stay apart.
  const PathPlanner* planner = nullptr;
  // A way round that is longer than this many straight lines is none.
  double longest_detour = 4;
  // Whether a planner searches only where ways of that length can lead. Elsewhere it finds more
  // ways, and takes long to find none: where zones and a pilot's sight part many pairs.
  bool search_near = false;
};

// Between two viewpoints, both ways.
struct ViewMotion {
  int a = 0, b = 0;                     // a < b
  std::vector<Eigen::Vector3d> points;  // from a to b, both included
  double length = 0;                    // m
};

struct MotionGraph {
  std::vector<ViewMotion> motions;  // by a, then b
  std::int64_t tried = 0;           // the sum of what follows, and motions
  std::int64_t unmatched = 0;       // pictures share too little: seen from either view of a pair
  std::int64_t blocked = 0;         // no way was found
  std::int64_t planned = 0;         // motions that are not straight
};

// `seen`: what every viewpoint sees at the common low resolution, in the order of keys. Pairs are
// shared among threads; the graph is the same for any number. Throws InputError for numbers of
// neighbours and settings that make no sense, Error when the sizes differ. `report` is told how
// many pairs of how many are done.
MotionGraph find_motions(const FreeSpace& space, const std::vector<Viewpoint>& viewpoints,
                         const std::vector<std::vector<VoxelKey>>& seen,
                         const MotionSettings& settings, std::uint64_t seed, int threads,
                         const CancellationToken* cancellation = nullptr,
                         const std::function<void(std::size_t, std::size_t)>& report = {});

}  // namespace lapwing
