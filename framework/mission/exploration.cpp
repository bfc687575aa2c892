// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/exploration.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "framework/core/phases.h"
#include "framework/core/units.h"
#include "framework/explore/view_grid.h"
#include "framework/explore/view_rays.h"

namespace lapwing {

namespace {

constexpr std::size_t kShownMoments = 4;
constexpr int kMomentPixels = 480;

// Of the sight of a view: the second finest grid of figures 5.4 to 5.7, and rays across an image.
constexpr int kSightPoints = 16, kSightLevels = 4, kSightRays = 12;

// Whether the map is shown after this many images of so many that are asked for.
bool is_moment(int images, int steps) {
  return images == std::max(1, steps / 10) || images == std::max(1, steps / 4) ||
         images == std::max(1, steps / 2);
}

void record_path(Exploration& e) {
  ExplorationRecord& record = e.record;
  record.path = {e.start.position};
  record.path_images = {0};
  for (std::size_t k = 0; k < e.result.steps.size(); ++k)
    for (const Viewpoint& view : e.result.steps[k].way) {
      if (view.position == record.path.back()) continue;
      record.path.push_back(view.position);
      record.path_images.push_back(static_cast<double>(k));
    }
  for (const ScoredView& view : e.result.candidates)
    record.candidates.push_back({view.view.position, view.view.direction(), view.value});
}

// The slice in the middle of a grid's height, or one minus it, as a grey picture.
Picture slice_of(const std::vector<float>& grid, const GridShape& shape, int channel,
                 bool inverse) {
  Picture picture{shape.across, shape.ahead, {}};
  for (int y = 0; y < shape.ahead; ++y)
    for (int x = 0; x < shape.across; ++x) {
      const int point = (shape.up / 2 * shape.ahead + (shape.ahead - 1 - y)) * shape.across + x;
      const float value = grid[static_cast<std::size_t>(point) * shape.channels() + channel];
      const float shown = std::clamp(inverse ? 1 - value : value, 0.0f, 1.0f);
      picture.rgb.insert(picture.rgb.end(), 3, static_cast<std::uint8_t>(std::lround(255 * shown)));
    }
  return picture;
}

template <class Visit>
void for_each_occupied(const Map& map, Visit visit) {
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    if (map.settings().state(leaf.log_odds) != VoxelState::occupied) return;
    const int edge = 1 << leaf.level;
    for (int z = 0; z < edge; ++z)
      for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
          visit(VoxelKey{static_cast<std::uint16_t>(leaf.key.x + x),
                         static_cast<std::uint16_t>(leaf.key.y + y),
                         static_cast<std::uint16_t>(leaf.key.z + z)});
  });
}

}  // namespace

void Moments::look(int images, const Map& map) {
  if (is_moment(images, steps_) || std::has_single_bit(static_cast<unsigned>(images)))
    all_.push_back({images, map_columns(map, below_)});
}

std::vector<ExplorationMoment> Moments::shown(int images, const Map& map) && {
  const bool whole = images == steps_;
  std::erase_if(all_, [&](const Moment& moment) {
    return whole ? !is_moment(moment.images, steps_)
                 : !std::has_single_bit(static_cast<unsigned>(moment.images));
  });
  if (images > 0 && (all_.empty() || all_.back().images < images))
    all_.push_back({images, map_columns(map, below_)});
  if (all_.size() > kShownMoments)
    all_.erase(all_.begin(), all_.end() - static_cast<std::ptrdiff_t>(kShownMoments));
  std::vector<ExplorationMoment> drawn;
  for (const Moment& moment : all_) {
    MapPicture made = height_picture(moment.columns, all_.back().columns, kMomentPixels);
    drawn.push_back({moment.images, std::move(made.picture), made.lowest, made.highest});
  }
  return drawn;
}

std::vector<Eigen::Vector3f> Growth::look(int images, const Map& map) {
  std::vector<Eigen::Vector3f> fresh;
  for_each_occupied(map, [&](const VoxelKey& key) {
    if (first_.try_emplace(key.morton(), static_cast<std::uint32_t>(images)).second)
      fresh.push_back(map.grid().center(key).cast<float>());
  });
  return fresh;
}

std::vector<GrownVoxel> Growth::grown(const Map& map) && {
  std::vector<GrownVoxel> voxels;
  for_each_occupied(map, [&](const VoxelKey& key) {
    if (const auto found = first_.find(key.morton()); found != first_.end())
      voxels.push_back({map.grid().center(key).cast<float>(), found->second});
  });
  std::stable_sort(voxels.begin(), voxels.end(),
                   [](const GrownVoxel& a, const GrownVoxel& b) { return a.image < b.image; });
  return voxels;
}

GridSlices grid_slices(const EpisodeView& known, const Viewpoint& view, int points, int levels) {
  const GridShape shape{points, points, points / 2, levels};
  known.means->refresh(levels);
  std::vector<float> grid(shape.size());
  sample_grid(known, view, shape, grid);
  GridSlices slices;
  slices.points = points;
  for (int level = 0; level < levels; ++level) {
    slices.occupancy.push_back(slice_of(grid, shape, 2 * level, false));
    slices.certainty.push_back(slice_of(grid, shape, 2 * level + 1, true));
    slices.edges.push_back(points * std::ldexp(known.map->grid().resolution(), level + 1));
  }
  return slices;
}

ExplorationSight sight_of(const EpisodeView& known, const Viewpoint& view) {
  ExplorationSight sight;
  sight.grid = grid_slices(known, view, kSightPoints, kSightLevels);
  const Map& map = *known.map;
  const int step = std::max(1, known.pinhole.width / kSightRays);
  for (const Eigen::Vector3d& direction : view_rays(view, known.pinhole, step)) {
    double end = known.range, unknown_from = known.range;
    ExplorationRay ray;
    walk_ray(map, view.position, direction, known.range,
             [&](const VoxelReading& reading, double distance) {
               if (reading.state == VoxelState::unknown && ray.unknown++ == 0)
                 unknown_from = distance;
               if (reading.state == VoxelState::occupied) end = distance;
               return reading.state != VoxelState::occupied;
             });
    ray.end = (view.position + end * direction).cast<float>();
    ray.unknown_from = end > 0 ? static_cast<float>(std::min(unknown_from, end) / end) : 1;
    sight.rays.push_back(ray);
  }
  return sight;
}

std::optional<double> cut_height(const MeshScene& scene, const Viewpoint& start) {
  const bool roofed = scene.blocked({start.position, Eigen::Vector3d::UnitZ()});
  return roofed ? std::optional(start.position.z()) : std::nullopt;
}

namespace {

// Positions and headings alone.
Trajectory path_of(const Exploration& e, bool gimbal) {
  Trajectory trajectory;
  trajectory.motion = path_motion();
  trajectory.has_gimbal = gimbal;
  const MoveTimes times = move_times(e.settings);
  const auto add = [&](const Viewpoint& view, double time) {
    Sample sample;
    sample.time = time;
    sample.position = view.position;
    const double before = trajectory.samples.empty() ? view.yaw : trajectory.samples.back().yaw;
    sample.yaw = before + std::remainder(view.yaw - before, 2 * EIGEN_PI);
    sample.gimbal_pitch = view.pitch;
    trajectory.samples.push_back(sample);
  };
  Viewpoint at = e.start;
  double time = 0;
  add(at, 0);
  for (const EpisodeStep& step : e.result.steps) {
    for (const Viewpoint& next : step.way) {
      time += times.of(at, next);
      add(next, time);
      at = next;
    }
    time += e.settings.pause;
    if (e.settings.pause > 0) add(at, time);
  }
  return trajectory;
}

// From rest to rest along every move, as the motion model `force`.
class RestFlight {
 public:
  RestFlight(const Exploration& e, const Vehicle& vehicle)
      : vehicle_(vehicle), times_(move_times(e.settings)), at_(e.start) {
    trajectory_.has_gimbal = vehicle.gimbal.has_value();
    now_.position = at_.position;
    now_.yaw = at_.yaw;
    now_.gimbal_pitch = at_.pitch;
  }

  void move(const Viewpoint& to) {
    const RestProfile way = times_.way(at_, to), turn = times_.turn(at_, to);
    const Eigen::Vector3d between = to.position - at_.position;
    const Eigen::Vector3d along = between.stableNormalized();
    const double turned = std::remainder(to.yaw - at_.yaw, 2 * EIGEN_PI);
    const double yaw = now_.yaw + turned, h = MoveTimes::kStep;
    for (int k = 0; k < std::max(way.steps(), turn.steps()); ++k) {
      const Eigen::Vector3d a = way.acceleration(k) * along;
      const double spin = turned < 0 ? -turn.acceleration(k) : turn.acceleration(k);
      sample(a, spin);
      now_.time += h;
      now_.position += h * now_.velocity + h * h / 2 * a;
      now_.velocity += h * a;
      now_.yaw += h * now_.yaw_rate + h * h / 2 * spin;
      now_.yaw_rate += h * spin;
    }
    // What rounding has left over.
    now_.position = to.position;
    now_.velocity.setZero();
    now_.yaw = yaw;
    now_.yaw_rate = 0;
    at_ = to;
  }
  void rest(double seconds) {
    if (!(seconds > 0)) return;
    sample(Eigen::Vector3d::Zero(), 0);
    now_.time += seconds;
  }
  Trajectory end() && {
    sample(Eigen::Vector3d::Zero(), 0);
    return std::move(trajectory_);
  }

 private:
  void sample(const Eigen::Vector3d& a, double spin) {
    now_.acceleration = a;
    now_.columns.set("force",
                     Eigen::Vector3d(vehicle_.mass * (a + Eigen::Vector3d(0, 0, kGravity))));
    now_.columns.set("yaw_torque", vehicle_.inertia.z() * spin);
    trajectory_.samples.push_back(now_);
  }

  const Vehicle& vehicle_;
  const MoveTimes times_;
  Viewpoint at_;
  Sample now_;
  Trajectory trajectory_;
};

}  // namespace

Trajectory trajectory_of(const Exploration& e, const Vehicle& vehicle) {
  if (!(e.settings.acceleration > 0) || !vehicle.has_rotors)
    return path_of(e, vehicle.gimbal.has_value());
  RestFlight flight(e, vehicle);
  for (const EpisodeStep& step : e.result.steps) {
    for (const Viewpoint& next : step.way) flight.move(next);
    flight.rest(e.settings.pause);
  }
  return std::move(flight).end();
}

void observe_truly(EpisodeResult& flown, const EpisodeSettings& settings, const GroundTruth& truth,
                   const ObservedSurface::NewMap& new_map) {
  if (!settings.sensor.noise && !settings.sensor.stereo) return;
  ObservedSurface observed(truth, settings.sensor, new_map);
  const auto map = new_map();
  const std::vector<double> curve = replay(settings, flown, truth, observed, *map);
  for (std::size_t k = 0; k < curve.size(); ++k) flown.steps[k].observed = curve[k];
}

void compare_with_oracle(Exploration& e, const GroundTruth& truth,
                         const ObservedSurface::NewMap& new_map, const Registry& registry) {
  EpisodeSettings settings = e.settings;
  settings.show_truth = true;
  settings.list_candidates = false;
  settings.wall_clock_guard.reset();  // of the mission's own exploration
  begin_phase(settings.progress, "oracle");
  const auto oracle = registry.create<ViewUtility>("oracle");
  ObservedSurface observed(truth, settings.sensor, new_map);
  const auto map = new_map();
  EpisodeResult best = explore(settings, e.start, truth, observed, *oracle, *map);
  if (best.end == EpisodeEnd::cancelled) return;
  observe_truly(best, settings, truth, new_map);
  // Over the same time of flight: that of the one that takes longer.
  if (settings.per_second) {
    const double until = std::max(best.time(), e.result.time());
    e.record.efficiency = e.result.efficiency_in_time(until);
    e.record.oracle_efficiency = best.efficiency_in_time(until);
  } else {
    e.record.oracle_efficiency = best.efficiency(settings.steps);
  }
  if (best.end != EpisodeEnd::steps) e.record.oracle_end = explain(best.end);
  for (const EpisodeStep& step : best.steps) e.record.oracle.push_back(step.observed);
}

void record_grids(Exploration& e) {
  const auto bounds = e.map->bounds();
  if (e.result.steps.empty() || !bounds) return;
  MapMeans means(*e.map);
  means.touch(*bounds);
  EpisodeView known;
  known.map = e.map.get();
  known.means = &means;
  known.pinhole = e.settings.sensor.pinhole;
  known.range = e.settings.sensor.range;
  known.pitch = e.start.pitch;
  for (const auto& [points, levels] : {std::pair{8, 5}, {16, 4}, {32, 3}, {64, 2}})
    e.record.grids.push_back(grid_slices(known, e.result.steps.back().view, points, levels));
}

ExplorationImage image_of(const EpisodeStep& step) {
  return {step.time, step.view.position, step.view.yaw, step.view.pitch, step.value, step.scored};
}

void record_flight(Exploration& e) {
  ExplorationRecord& record = e.record;
  for (const EpisodeStep& step : e.result.steps) {
    record.observed.push_back(step.observed);
    record.images.push_back(image_of(step));
    e.seconds += step.seconds;
  }
  record.end = explain(e.result.end);
  record.surface = e.result.surface;
  record.length = e.result.length();
  record.per_second = e.settings.per_second;
  record.efficiency = e.settings.per_second ? e.result.efficiency_in_time(e.result.time())
                                            : e.result.efficiency(e.settings.steps);
  record.resolution = e.map->grid().resolution();
  record_path(e);
}

}  // namespace lapwing
