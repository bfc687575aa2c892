// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/scan_record.h"

#include <algorithm>

#include "framework/core/parallel.h"
#include "framework/view/true_surface.h"

namespace lapwing {
namespace {

// What all views of a tour tell of each voxel, through every pixel of the camera; voxels that only
// candidates see have nothing.
std::vector<VoxelShare> coverage_of(const ScanWork& work, const std::vector<int>& views,
                                    int threads) {
  std::vector<std::vector<VoxelShare>> told(views.size());
  parallel_for(views.size(), threads, [&](std::size_t i) {
    const auto& viewpoints = work.graph.candidates.viewpoints;
    const std::vector<SeenVoxel> seen =
        work.visible->seen_from(viewpoints[static_cast<std::size_t>(views[i])]);
    const std::vector<float> amounts = contributions_of(seen, *work.information);
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (amounts[k] > 0) told[i].push_back({seen[k].voxel, amounts[k]});
  });
  std::vector<VoxelShare> all;
  for (const VoxelKey& voxel : work.graph.voxels) all.push_back({voxel, 0});
  for (const auto& one : told) all.insert(all.end(), one.begin(), one.end());
  // Stable: amounts are added in the tour's order.
  std::stable_sort(all.begin(), all.end(),
                   [](const VoxelShare& a, const VoxelShare& b) { return a.voxel < b.voxel; });
  std::vector<VoxelShare> coverage;
  for (const VoxelShare& v : all) {
    if (coverage.empty() || coverage.back().voxel != v.voxel) coverage.push_back({v.voxel, 0});
    coverage.back().share = std::min(1.0f, coverage.back().share + v.share);
  }
  return coverage;
}

// The views of a walk, each once, in its order.
std::vector<int> views_of_walk(const std::vector<int>& walk) {
  std::vector<int> views;
  for (const int view : walk)
    if (std::find(views.begin(), views.end(), view) == views.end()) views.push_back(view);
  return views;
}

std::optional<TrueAreas> true_areas(const ScanWork& work, const std::vector<int>& views,
                                    int threads) {
  if (!work.prior->truth) return std::nullopt;
  const SightSettings& sight = work.visible->settings();
  std::optional<TrueSurface> surface;
  try {
    surface.emplace(work.prior->truth, sight.region, work.allowed, threads);
  } catch (const InputError&) {
    return std::nullopt;  // a region without true surface: there is nothing to be told
  }
  std::vector<Viewpoint> tour;
  for (const int view : views)
    tour.push_back(work.graph.candidates.viewpoints[static_cast<std::size_t>(view)]);
  return TrueAreas{surface->area(),
                   surface->seen(work.prior->views, sight.pinhole, sight.range, threads),
                   surface->seen(tour, sight.pinhole, sight.range, threads)};
}

// The view of the tour that tells most by itself.
int most_telling(const ScanGraph& graph, const std::vector<int>& walk) {
  int best = walk.front();
  for (const int view : walk)
    if (graph.score->alone(view) > graph.score->alone(best)) best = view;
  return best;
}

}  // namespace

std::shared_ptr<const ScanRecord> record_of_scan(const TourObject& tour, double pixel_error,
                                                 int threads) {
  const ScanWork& work = *tour.work;
  const ScanGraph& graph = work.graph;
  auto record = std::make_shared<ScanRecord>();
  record->scene = work.prior->scene;
  record->map = work.prior->mapping.map;
  record->prior = work.prior->mesh;
  record->surveyed = work.prior->surveyed;
  for (const Viewpoint& v : work.prior->views) record->first_views.push_back(v.position);
  for (const Viewpoint& v : graph.candidates.viewpoints) record->candidates.push_back(v.position);
  for (const ViewMotion& m : graph.motions.motions) record->motions.emplace_back(m.a, m.b);
  const Viewpoint& shown =
      graph.candidates.viewpoints[static_cast<std::size_t>(most_telling(graph, tour.walk))];
  record->shown = {0, shown.position, shown.yaw, shown.pitch, ViewKind::planned};
  const std::vector<SeenVoxel> seen = work.visible->seen_from(shown);
  const std::vector<float> amounts = contributions_of(seen, *work.information);
  for (std::size_t i = 0; i < seen.size(); ++i)
    record->told.push_back({seen[i].voxel, std::min(amounts[i], 1.0f)});
  const std::vector<int> views = views_of_walk(tour.walk);
  record->coverage = coverage_of(work, views, threads);
  const SightSettings& sight = work.visible->settings();
  record->shares = shares_of_triangles(record->prior->mesh(), sight.region, record->map->grid(),
                                       record->coverage);
  record->areas = areas_of(record->prior->mesh(), record->shares, sight.region);
  record->body_width = 2 * work.body.maxCoeff();
  record->openings =
      unknown_openings(*record->map, record->prior.get(),
                       {sight.region, work.prior->rays, record->body_width, threads});
  record->truth = true_areas(work, views, threads);
  std::vector<char> counted;
  for (const float share : record->shares) counted.push_back(share > kOutsideRegion);
  record->prediction = prediction_of_scan(work, views, std::move(counted), pixel_error, threads);
  ScoreState state(*graph.score);
  double clock = 0;
  for (std::size_t i = 0; i < tour.walk.size(); ++i) {
    if (tour.passing)
      clock = tour.passing->shots[i].time;
    else if (i > 0)
      clock += work.leg_seconds(tour.walk[i - 1], tour.walk[i]);
    state.add(tour.walk[i]);
    record->seconds.push_back(clock);
    record->score.push_back(state.score());
  }
  record->reachable = tour.report.reachable_score;
  record->upper_bound = tour.report.upper_bound;
  return record;
}

}  // namespace lapwing
