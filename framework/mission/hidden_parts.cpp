// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/hidden_parts.h"

#include <algorithm>

#include "framework/core/parallel.h"
#include "framework/map/known_surface.h"

namespace lapwing {
namespace {

// What views tell something of, each voxel once.
std::vector<VoxelKey> told_by(const std::vector<Viewpoint>& views, const VisibleVoxels& visible,
                              const ViewInformation& information, int threads,
                              const CancellationToken* cancellation) {
  std::vector<std::vector<VoxelKey>> told(views.size());
  parallel_for(views.size(), threads, [&](std::size_t i) {
    if (cancellation && cancellation->cancelled()) return;
    const std::vector<SeenVoxel> seen = visible.seen_from(views[i]);
    const std::vector<float> amounts = contributions_of(seen, information);
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (amounts[k] > 0) told[i].push_back(seen[k].voxel);
  });
  if (cancellation && cancellation->cancelled()) throw Cancelled();
  std::vector<VoxelKey> all;
  for (const auto& one : told) all.insert(all.end(), one.begin(), one.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// m^2 of the known surface in a region that voxels belong to. Their shares: 1 of those that
// candidates see, 0 of the others.
HiddenPart part_of(const ScanWork& work, const InterestRegion& region, const std::string& name,
                   const std::vector<VoxelShare>& voxels) {
  const TriangleMesh& mesh = work.prior->mesh->mesh();
  const SurfaceAreas areas = areas_of(
      mesh, shares_of_triangles(mesh, region, work.prior->mapping.map->grid(), voxels), region);
  return {name, areas.visible, areas.visible - areas.seen};
}

}  // namespace

std::vector<HiddenPart> hidden_parts(const ScanWork& work, const FreeSpace& open,
                                     const VisibleVoxels& visible,
                                     const std::vector<Viewpoint>& starts,
                                     const ScanGraphSettings& settings,
                                     std::vector<Viewpoint>& forbidden,
                                     const CancellationToken* cancellation) {
  CandidateSettings wide = settings.candidates;
  wide.most = 2 * kOpenViews;
  wide.least = 0;
  // A few of the starts are enough to grow from; all of them could be as many as the candidates.
  std::vector<Viewpoint> first(
      starts.begin(),
      starts.begin() + std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(starts.size()), 20));
  const Candidates grown = generate_candidates(open, first, wide, settings.seed, cancellation);
  const auto ruled_space = ruled(space_of(*work.prior, 0), *work.rules, work.prior->mapping.map);
  std::vector<Viewpoint> breaking, keeping;
  for (const Viewpoint& view : grown.viewpoints)
    (ruled_space->swept_box_free(view.position, view.position, wide.half) ? keeping : breaking)
        .push_back(view);
  const auto told = [&](const std::vector<Viewpoint>& views) {
    return told_by(views, visible, *work.information, settings.threads, cancellation);
  };
  std::vector<VoxelKey> seen = told(keeping);
  seen.insert(seen.end(), work.graph.voxels.begin(), work.graph.voxels.end());
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  std::vector<VoxelShare> voxels;
  for (const VoxelKey& voxel : seen) voxels.push_back({voxel, 1});
  for (const VoxelKey& voxel : told(breaking))
    if (!std::binary_search(seen.begin(), seen.end(), voxel)) voxels.push_back({voxel, 0});
  const InterestRegion& region = visible.settings().region;
  std::vector<HiddenPart> parts{part_of(work, region, "", voxels)};
  if (region.prisms().size() > 1)
    for (std::size_t k = 0; k < region.prisms().size(); ++k)
      parts.push_back(part_of(work, InterestRegion(std::vector{region.prisms()[k]}),
                              region.prisms()[k].label(k + 1), voxels));
  forbidden = std::move(breaking);
  return parts;
}

}  // namespace lapwing
