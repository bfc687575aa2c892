// SPDX-License-Identifier: Apache-2.0
// An exploration that a mission flew, and what its report and its plan show of it.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "framework/explore/episode.h"
#include "framework/export/exploration_report.h"
#include "framework/export/map_pictures.h"
#include "framework/plugin/registry.h"
#include "framework/trajectory/trajectory.h"

namespace lapwing {

struct Exploration {
  EpisodeSettings settings;
  EpisodeResult result;
  std::shared_ptr<Map> map;
  Viewpoint start;
  ExplorationRecord record;
  double seconds = 0;  // wall clock of choosing and mapping
};

// How the map grew, in four pictures whenever it ends: after shares of the images that were asked
// for, or, where it ended before them, after as many as the last powers of two. All are drawn in
// the last one's frame.
class Moments {
 public:
  // What is above `below` (m) is left out.
  Moments(int steps, double below) : steps_(steps), below_(below) {}
  void look(int images, const Map& map);
  std::vector<ExplorationMoment> shown(int images, const Map& map) &&;

 private:
  struct Moment {
    int images;
    MapColumns columns;
  };
  int steps_;
  double below_;
  std::vector<Moment> all_;
};

// After which image each voxel became occupied.
class Growth {
 public:
  // The middles of those that are occupied for the first time, m.
  std::vector<Eigen::Vector3f> look(int images, const Map& map);
  // Those that are occupied at the end, by image.
  std::vector<GrownVoxel> grown(const Map& map) &&;

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> first_;  // by morton code
};

// A middle slice of what a learned utility is shown around a view, with as many points ahead,
// across and, of half of that, up. Level by level, the finest first.
GridSlices grid_slices(const EpisodeView& known, const Viewpoint& view, int points, int levels);
// What a view is chosen by: 16 points along an edge, 4 levels, and 12 x 9 rays.
ExplorationSight sight_of(const EpisodeView& known, const Viewpoint& view);

// Under a roof the picture from above is of what lies below the start: a room without its ceiling.
std::optional<double> cut_height(const MeshScene& scene, const Viewpoint& start);

// The flown path: at rest in every view for as long as an image takes.
Trajectory trajectory_of(const Exploration& exploration, bool gimbal);

// A noisy camera is judged by the same views with true depth, as table 5.4 does: noise would be
// taken for surface.
void observe_truly(EpisodeResult& flown, const EpisodeSettings& settings, const GroundTruth& truth,
                   const ObservedSurface::NewMap& new_map);
// What a learned utility is shown at the last view of the flight, in the sizes of figures 5.4
// to 5.7.
void record_grids(Exploration& exploration);
// What an oracle would have seen from the same start.
void compare_with_oracle(Exploration& exploration, const GroundTruth& truth,
                         const ObservedSurface::NewMap& new_map, const Registry& registry);
ExplorationImage image_of(const EpisodeStep& step);
// Figures, curve and path of the record, from the result.
void record_flight(Exploration& exploration);

}  // namespace lapwing
