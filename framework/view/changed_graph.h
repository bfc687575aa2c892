// SPDX-License-Identifier: Apache-2.0
// The graph of a plan before, changed for another region, other zones or other starts: for
// estimates while these are dragged.
#pragma once

#include <span>
#include <vector>

#include "framework/view/scan_graph.h"

namespace lapwing {

// How: the views that are still allowed stay, with their motions that are still free, and tell what
// they told of voxels that are still in the region. What the region has gained 160 of them look at
// anew, evenly chosen, through at most 320 pixels a row.
// Views are added for starts and pinned views alone: the map, and places to look from, are those of
// the plan before. Motions are not matched again for the new region.
//
// `was`: the region of `before`; `pinned_before`: its views that were pinned, which go unless they
// are among `pinned`; `rules`: where zones and a pilot's sight alone leave the space
// open, null where they leave all of it; `space` is free in map and mesh as well. `starts` come
// first, then those given before that are not among them, then `pinned`; all are free. NothingSeen
// where the views see nothing of the region, else throws as make_scan_graph.
ScanGraph changed_graph(const ScanGraph& before, const InterestRegion& was,
                        std::span<const int> pinned_before, const FreeSpace& space,
                        const FreeSpace* rules, const VisibleVoxels& visible,
                        const ViewInformation& information, const std::vector<Viewpoint>& starts,
                        const std::vector<Viewpoint>& pinned, const ScanGraphSettings& settings,
                        const CancellationToken* cancellation = nullptr);

}  // namespace lapwing
