// SPDX-License-Identifier: Apache-2.0
// What of a region stays unseen because of zones and a pilot's sight.
#pragma once

#include <vector>

#include "framework/mission/scan_objects.h"

namespace lapwing {

// How: 2 kOpenViews candidates are made once more in `open`, where the rules do not hold, and look
// at the region. A part is hidden when those that break the rules see it, and neither those that
// keep them nor the candidates of the graph do. Areas are of the prior mesh, and estimates: more
// views would see more on either side. The first part is of all regions together; of several prisms
// one part each follows.
//
// `forbidden` gets the views that break the rules and that nothing else forbids.
std::vector<HiddenPart> hidden_parts(const ScanWork& work, const FreeSpace& open,
                                     const VisibleVoxels& visible,
                                     const std::vector<Viewpoint>& starts,
                                     const ScanGraphSettings& settings,
                                     std::vector<Viewpoint>& forbidden,
                                     const CancellationToken* cancellation);

inline constexpr int kOpenViews = 600;

}  // namespace lapwing
