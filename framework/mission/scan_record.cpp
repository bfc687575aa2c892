// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/scan_record.h"

#include <algorithm>

#include "framework/core/parallel.h"
#include "framework/export/prediction_mesh.h"
#include "framework/export/prediction_report.h"
#include "framework/mission/run.h"
#include "framework/view/footprint.h"
#include "framework/view/true_surface.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostPredicted = 3000000;  // triangles of files that viewers can open

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

// The same of a score that was weighed through every pixel.
std::vector<VoxelShare> coverage_in(const ScanGraph& graph, const std::vector<int>& views) {
  const auto capacities = graph.score->capacities();
  std::vector<VoxelShare> coverage(graph.voxels.size());
  for (std::size_t v = 0; v < coverage.size(); ++v) coverage[v] = {graph.voxels[v], 0};
  for (const int view : views) {
    const auto voxels = graph.score->voxels_of(view);
    const auto amounts = graph.score->amounts_of(view);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      float& share = coverage[voxels[i]].share;
      share = std::min(
          1.0f, share + static_cast<float>(amounts[i]) / static_cast<float>(capacities[voxels[i]]));
    }
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

// What was known, and what was considered.
std::shared_ptr<ScanRecord> begun_record(const ScanWork& work) {
  const ScanGraph& graph = work.graph;
  auto record = std::make_shared<ScanRecord>();
  record->scene = work.prior->scene;
  record->map = work.prior->mapping.map;
  record->prior = work.prior->mesh;
  record->surveyed = work.prior->surveyed;
  const SightSettings& sight = work.visible->settings();
  for (const Viewpoint& v : work.prior->views) {
    record->first_views.push_back(v.position);
    record->footprints.push_back(
        footprint_of(v, sight.pinhole, sight.region.bounds().min().z(), sight.range));
  }
  for (const Viewpoint& v : graph.candidates.viewpoints) record->candidates.push_back(v.position);
  for (int view = 0; view < graph.score->views(); ++view)
    record->alone.push_back(graph.score->alone(view));
  for (const ViewMotion& m : graph.motions.motions) record->motions.emplace_back(m.a, m.b);
  record->body_width = 2 * work.body.maxCoeff();
  return record;
}

// One view, and the score over the time of the tour.
void add_progress(const TourObject& tour, ScanRecord& record) {
  const ScanWork& work = *tour.work;
  const ScanGraph& graph = work.graph;
  const Viewpoint& shown =
      graph.candidates.viewpoints[static_cast<std::size_t>(most_telling(graph, tour.walk))];
  record.shown = {0, shown.position, shown.yaw, shown.pitch, ViewKind::planned};
  const std::vector<SeenVoxel> seen = work.visible->seen_from(shown);
  const std::vector<float> amounts = contributions_of(seen, *work.information);
  for (std::size_t i = 0; i < seen.size(); ++i)
    record.told.push_back({seen[i].voxel, std::min(amounts[i], 1.0f)});
  ScoreState state(*graph.score);
  double clock = 0;
  for (std::size_t i = 0; i < tour.walk.size(); ++i) {
    if (tour.passing)
      clock = tour.passing->shots[i].time;
    else if (i > 0)
      clock += work.leg_seconds(tour.walk[i - 1], tour.walk[i]);
    state.add(tour.walk[i]);
    record.seconds.push_back(clock);
    record.score.push_back(state.score());
  }
  record.reachable = tour.report.reachable_score;
  record.upper_bound = tour.report.upper_bound;
}

}  // namespace

SurfaceAreas areas_seen(const ScanWork& work, const std::vector<int>& views, int threads) {
  const TriangleMesh& mesh = work.prior->mesh->mesh();
  const InterestRegion& region = work.visible->settings().region;
  return areas_of(mesh,
                  shares_of_triangles(mesh, region, work.prior->mapping.map->grid(),
                                      work.weighed_fully ? coverage_in(work.graph, views)
                                                         : coverage_of(work, views, threads),
                                      threads),
                  region);
}

namespace {

// What the views show.
void add_coverage(const ScanWork& work, const std::vector<int>& views, double pixel_error,
                  int threads, ScanRecord& record) {
  record.coverage = coverage_of(work, views, threads);
  const SightSettings& sight = work.visible->settings();
  record.shares =
      shares_of_triangles(record.prior->mesh(), sight.region, record.map->grid(), record.coverage);
  record.areas = areas_of(record.prior->mesh(), record.shares, sight.region);
  record.openings = unknown_openings(*record.map, record.prior.get(),
                                     {sight.region, work.prior->rays, record.body_width, threads});
  record.truth = true_areas(work, views, threads);
  std::vector<char> counted;
  for (const float share : record.shares) counted.push_back(share > kOutsideRegion);
  record.prediction = prediction_of_scan(work, views, std::move(counted), pixel_error, threads);
}

}  // namespace

std::shared_ptr<const ScanRecord> record_of_scan(const TourObject& tour, double pixel_error,
                                                 int threads) {
  const std::shared_ptr<ScanRecord> record = begun_record(*tour.work);
  add_progress(tour, *record);
  add_coverage(*tour.work, views_of_walk(tour.walk), pixel_error, threads, *record);
  return record;
}

std::shared_ptr<const ScanRecord> record_of_tour(const TourObject& tour) {
  const std::shared_ptr<ScanRecord> record = begun_record(*tour.work);
  add_progress(tour, *record);
  return record;
}

std::shared_ptr<const ScanRecord> record_of_fleet(std::span<const TourObject> tours,
                                                  double pixel_error, int threads) {
  const ScanWork& work = *tours.front().work;
  const std::shared_ptr<ScanRecord> record = begun_record(work);
  record->tours = static_cast<int>(tours.size());
  std::vector<int> walks;
  for (const TourObject& tour : tours)
    walks.insert(walks.end(), tour.walk.begin(), tour.walk.end());
  add_coverage(work, views_of_walk(walks), pixel_error, threads, *record);
  return record;
}

void tell_scan(const ScanRecord& record, MissionRun& run, const ToldScan& result) {
  if (!result.block.is_map()) result.block = Value::map();
  result.block.set("surface", areas_as_value(record));
  result.notes.push_back(areas_in_words(record));
  result.block.set("prediction", prediction_as_value(*record.prediction));
  result.notes.push_back(prediction_in_words(*record.prediction));
  if (const std::size_t triangles = record.prior->mesh().triangles.size();
      triangles <= kMostPredicted) {
    run.obstacles.keep("prediction.ply", prediction_ply(*record.prediction));
    run.obstacles.keep("prediction.glb", prediction_glb(*record.prediction));
  } else {
    result.notes.push_back("prediction.ply and prediction.glb are left out: the prior mesh has " +
                           std::to_string(triangles) + " triangles, and they are written for " +
                           std::to_string(kMostPredicted) +
                           " at most; a larger surface.cell gives fewer");
  }
  if (record.truth) result.told.push_back(truth_in_words(record));
}

}  // namespace lapwing
