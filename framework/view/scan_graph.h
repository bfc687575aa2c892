// SPDX-License-Identifier: Apache-2.0
// All that a tour of views is planned on, made from what is known of a place: candidates, what each
// of them tells of which voxels, and the ways between those whose pictures match (thesis 4.4.4).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "framework/core/error.h"
#include "framework/core/progress.h"
#include "framework/path/free_space.h"
#include "framework/view/candidates.h"
#include "framework/view/motions.h"
#include "framework/view/view_information.h"
#include "framework/view/view_score.h"
#include "framework/view/visible_voxels.h"

namespace lapwing {

struct ScanGraphSettings {
  CandidateSettings candidates;
  MotionSettings motions;
  // Pixels, of the views that (4.8) compares, in cubes of voxels no smaller than what such a pixel
  // shows at the end of the rays: smaller ones would be hit here by one view, there by the other.
  int coarse_across = 120;
  std::uint64_t seed = 1;
  int threads = 1;
};

// No candidate sees anything of the region.
class NothingSeen : public InputError {
 public:
  using InputError::InputError;
};

struct ScanGraph {
  Candidates candidates;
  MotionGraph motions;
  std::shared_ptr<const ViewScore> score;  // one view for each candidate
  std::vector<VoxelKey> voxels;            // of the score, in its order
};

// Views are looked from in chunks, shared among threads, and only what the score needs is kept; the
// graph is the same for any number of threads. InputError as generate_candidates, and for a region
// of more than 2^37 voxels or one of which no candidate sees anything; Cancelled when told to stop.
ScanGraph make_scan_graph(const FreeSpace& space, const VisibleVoxels& visible,
                          const ViewInformation& information, const std::vector<Viewpoint>& given,
                          const ScanGraphSettings& settings,
                          const CancellationToken* cancellation = nullptr,
                          Progress* progress = nullptr);

// Of views as they are given, without motions and without a look at free space: their score and its
// voxels. Throws as make_scan_graph.
ScanGraph score_given_views(const VisibleVoxels& visible, const ViewInformation& information,
                            std::vector<Viewpoint> views, int threads,
                            const CancellationToken* cancellation = nullptr,
                            Progress* progress = nullptr);

// What one view tells of the voxels that it sees, as the graph's score has it.
std::vector<float> contributions_of(const std::vector<SeenVoxel>& seen,
                                    const ViewInformation& information);

}  // namespace lapwing
