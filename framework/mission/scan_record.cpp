#include "framework/mission/scan_record.h"

namespace lapwing {
namespace {

// What all views of a tour tell of each voxel.
std::vector<VoxelShare> coverage_of(const ScanGraph& graph, const std::vector<int>& walk) {
  const ViewScore& score = *graph.score;
  std::vector<std::int64_t> sums(score.voxels(), 0);
  std::vector<char> counted(static_cast<std::size_t>(score.views()), 0);
  for (const int view : walk) {
    char& done = counted[static_cast<std::size_t>(view)];
    if (done) continue;
    done = 1;
    const auto voxels = score.voxels_of(view);
    const auto amounts = score.amounts_of(view);
    for (std::size_t i = 0; i < voxels.size(); ++i) sums[voxels[i]] += amounts[i];
  }
  std::vector<VoxelShare> coverage;
  for (std::size_t v = 0; v < sums.size(); ++v)
    coverage.push_back(
        {graph.voxels[v],
         static_cast<float>(std::min(
             1.0, static_cast<double>(sums[v]) / static_cast<double>(score.capacities()[v])))});
  return coverage;
}

// The view of the tour that tells most by itself.
int most_telling(const ScanGraph& graph, const std::vector<int>& walk) {
  int best = walk.front();
  for (const int view : walk)
    if (graph.score->alone(view) > graph.score->alone(best)) best = view;
  return best;
}

}  // namespace

std::shared_ptr<const ScanRecord> record_of_scan(const TourObject& tour) {
  const ScanWork& work = *tour.work;
  const ScanGraph& graph = work.graph;
  auto record = std::make_shared<ScanRecord>();
  record->scene = work.prior->scene;
  record->map = work.prior->mapping.map;
  record->prior = work.prior->mesh;
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
  record->coverage = coverage_of(graph, tour.walk);
  ScoreState state(*graph.score);
  double clock = 0;
  for (std::size_t i = 0; i < tour.walk.size(); ++i) {
    if (i > 0) clock += work.leg_seconds(tour.walk[i - 1], tour.walk[i]);
    state.add(tour.walk[i]);
    record->seconds.push_back(clock);
    record->score.push_back(state.score());
  }
  record->reachable = tour.report.reachable_score;
  record->upper_bound = tour.report.upper_bound;
  return record;
}

}  // namespace lapwing
