// SPDX-License-Identifier: Apache-2.0
// Estimates of a scan whose region, zones or starts are dragged: the graph of the plan before is
// changed instead of made anew. Internal to this room.
#pragma once

#include <vector>

#include "framework/mission/run.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {

// The share of a region's ground over and under which a mesh has no vertex. It is counted in cells
// of at least 1 m, which is more than vertices are apart.
double ground_without(const TriangleMesh& mesh, const InterestRegion& region);

// Of an estimate: where the prior mesh lacks the ground of a tenth more of `region` than of the
// region of `before`, it tells why there is no estimate and ends the plan (Cancelled).
void require_known(const ScanWork& before, const InterestRegion& region, const MissionRun& run);

// Makes the graph of `work` out of that of a plan before (view/changed_graph.h). Pinned views are
// the last of those that are given. InputError where no view is left to begin at.
void change_graph(const ScanWork& before, ScanWork& work, const FreeSpace& space,
                  const VisibleVoxels& sight, const std::vector<Viewpoint>& starts,
                  const std::vector<Viewpoint>& pinned, const ScanGraphSettings& settings,
                  const CancellationToken* cancellation);

}  // namespace lapwing
