// SPDX-License-Identifier: Apache-2.0
#include "framework/view/scan_graph.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/core/random.h"
#include "framework/view/graph_parts.h"

namespace lapwing {
namespace {

constexpr std::size_t kChunk = 64;  // views that are held unpacked

struct Told {
  VoxelKey voxel;
  float amount;
};

// The part of the work from `from` to `to` that is done.
class Share {
 public:
  Share(Progress* progress, double from, double to) : progress_(progress), from_(from), to_(to) {}
  void report(std::size_t done, std::size_t of, const char* what) const {
    if (!progress_) return;
    progress_->report(from_ + (to_ - from_) * static_cast<double>(done) / static_cast<double>(of),
                      std::string(what) + " " + std::to_string(done) + " of " + std::to_string(of));
  }

 private:
  Progress* progress_;
  double from_, to_;
};

void throw_if_cancelled(const CancellationToken* cancellation) {
  if (cancellation && cancellation->cancelled()) throw Cancelled();
}

// Calls look(k) for every view, chunk by chunk, and keep(k) in their order.
template <class Look, class Keep>
void in_chunks(std::size_t count, int threads, const CancellationToken* cancellation,
               const Share& share, const char* what, Look look, Keep keep) {
  for (std::size_t first = 0; first < count; first += kChunk) {
    const std::size_t size = std::min(kChunk, count - first);
    parallel_for(size, threads, [&](std::size_t k) {
      if (!(cancellation && cancellation->cancelled())) look(first + k, k);
    });
    throw_if_cancelled(cancellation);
    for (std::size_t k = 0; k < size; ++k) keep(k);
    share.report(first + size, count, what);
  }
}

std::shared_ptr<const ViewScore> score_views(const VisibleVoxels& visible,
                                             const ViewInformation& information, int threads,
                                             const CancellationToken* cancellation,
                                             const Share& share, ScanGraph& graph) {
  const std::vector<Viewpoint>& views = graph.candidates.viewpoints;
  const InterestRegion& region = visible.settings().region;
  VoxelNumbers numbers(region.bounds(), visible.map().grid());
  ViewScoreBuilder builder = ViewScoreBuilder::growing(region.largest_weight());
  std::vector<std::vector<Told>> told(kChunk);
  std::vector<ViewScore::Contribution> contributions;
  const auto look = [&](std::size_t view, std::size_t place) {
    const std::vector<SeenVoxel> seen = visible.seen_from(views[view]);
    const std::vector<float> amounts = contributions_of(seen, information);
    told[place].clear();
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (amounts[i] > 0) told[place].push_back({seen[i].voxel, amounts[i]});
  };
  const auto keep = [&](std::size_t place) {
    contributions.clear();
    for (const Told& t : told[place]) {
      const auto weight = static_cast<float>(visible.weight(t.voxel));
      const std::size_t before = numbers.count();
      contributions.push_back({numbers.number(t.voxel), weight * std::min(t.amount, 1.0f)});
      if (numbers.count() > before) builder.add_voxel(weight);
    }
    builder.add_view(contributions);
  };
  in_chunks(views.size(), threads, cancellation, share, "view", look, keep);
  graph.voxels = numbers.take();
  if (graph.voxels.empty()) {
    const SightSettings& sight = visible.settings();
    char text[200];
    std::snprintf(text, sizeof text,
                  "none of %zu candidates sees the region of interest: it has no surface within "
                  "the usable range of %.4g m of them",
                  views.size(), std::min(sight.range, sight.usable_range));
    throw NothingSeen(text);
  }
  return std::make_shared<const ViewScore>(std::move(builder).take());
}

// In the order of keys, each once.
std::vector<VoxelKey> in_cubes(std::vector<VoxelKey> keys, int level) {
  for (VoxelKey& key : keys)
    key = {static_cast<std::uint16_t>(key.x >> level), static_cast<std::uint16_t>(key.y >> level),
           static_cast<std::uint16_t>(key.z >> level)};
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  keys.shrink_to_fit();
  return keys;
}

}  // namespace

int coarse_level(const VisibleVoxels& visible, int across) {
  const SightSettings& sight = visible.settings();
  const double share = static_cast<double>(across) / sight.pinhole.width;
  const double shown = sight.range / (share * sight.pinhole.focal_x);
  int level = 0;
  while (level < kTreeDepth - 1 && std::ldexp(visible.map().grid().resolution(), level) < shown)
    ++level;
  return level;
}

std::vector<VoxelKey> coarse_cubes(const VisibleVoxels& visible, const Viewpoint& view, int across,
                                   int level) {
  return in_cubes(visible.seen_coarsely_from(view, across), level);
}

std::vector<float> contributions_of(const std::vector<SeenVoxel>& seen,
                                    const ViewInformation& information) {
  std::vector<VoxelSight> sights;
  sights.reserve(seen.size());
  for (const SeenVoxel& voxel : seen) sights.push_back(voxel.sight);
  std::vector<float> values(sights.size(), 0.0f);
  in_plugin(information, "contributions", [&] { information.contributions(sights, values); });
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] >= 0 && std::isfinite(values[k])) continue;
    const std::string wrong = "a voxel " + std::to_string(sights[k].distance) + " m away tells " +
                              std::to_string(values[k]) +
                              "; expected a finite number of at least 0";
    if (!information.plugin_name()) throw Error(wrong);
    throw plugin_failure(information.plugin_name(), "contributions", wrong);
  }
  return values;
}

ScanGraph make_scan_graph(const FreeSpace& space, const VisibleVoxels& visible,
                          const ViewInformation& information, const std::vector<Viewpoint>& given,
                          const ScanGraphSettings& settings, const CancellationToken* cancellation,
                          Progress* progress) {
  constexpr double kGrown = 0.02, kSeen = 0.75, kCompared = 0.8;  // shares of the work
  const Random seeds(settings.seed);
  ScanGraph graph;
  graph.candidates =
      generate_candidates(space, given, settings.candidates, seeds.split(0).bits(), cancellation);
  const std::vector<Viewpoint>& views = graph.candidates.viewpoints;
  graph.score = score_views(visible, information, settings.threads, cancellation,
                            Share(progress, kGrown, kSeen), graph);
  std::vector<std::vector<VoxelKey>> coarse(views.size()), chunk(kChunk);
  if (settings.motions.alpha > 0) {
    std::size_t next = 0;
    const int level = coarse_level(visible, settings.coarse_across);
    in_chunks(
        views.size(), settings.threads, cancellation, Share(progress, kSeen, kCompared),
        "coarse view",
        [&](std::size_t view, std::size_t place) {
          chunk[place] = coarse_cubes(visible, views[view], settings.coarse_across, level);
        },
        [&](std::size_t place) { coarse[next++] = std::move(chunk[place]); });
  }
  const Share motions(progress, kCompared, 1);
  graph.motions = find_motions(
      space, views, coarse, settings.motions, seeds.split(1).bits(), settings.threads, cancellation,
      [&](std::size_t done, std::size_t of) { motions.report(done, of, "way between views"); });
  return graph;
}

ScanGraph score_given_views(const VisibleVoxels& visible, const ViewInformation& information,
                            std::vector<Viewpoint> views, int threads,
                            const CancellationToken* cancellation, Progress* progress) {
  ScanGraph graph;
  graph.candidates.given = static_cast<int>(views.size());
  graph.candidates.viewpoints = std::move(views);
  graph.score =
      score_views(visible, information, threads, cancellation, Share(progress, 0, 1), graph);
  return graph;
}

}  // namespace lapwing
