// SPDX-License-Identifier: Apache-2.0
// Maps: brick against octomap on the same scans, rays and boxes.
#include <benchmark/benchmark.h>
#include <octomap/OcTree.h>

#include <sstream>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/depth_camera.h"
#include "framework/map/map_file.h"
#include "framework/map/scan.h"
#include "tests/bench/bench_registry.h"
#include "tests/plugins/maps/depth_frames.h"

namespace lapwing {
namespace {

struct Scan {
  std::vector<Eigen::Vector3f> points;
  Eigen::Vector3f origin;
};

// The real frames as points, every `step`-th pixel; empty where they are not there.
const std::vector<Scan>& real_scans(int step) {
  static std::map<int, std::vector<Scan>> scans;
  if (scans[step].empty() && data_folder())
    for (const PosedDepthImage& frame : real_frames(50)) {
      Scan scan{{}, frame.camera.position.cast<float>()};
      scan_points(frame, step, 1e3, 0.05, scan.points);
      scans[step].push_back(std::move(scan));
    }
  return scans[step];
}

std::unique_ptr<Map> new_map(const char* name, double resolution, const char* mode) {
  Value value = Value::map();
  value.set("resolution", resolution);
  value.set("mode", mode);
  value.set("maximum_range", 30.0);
  return bench_registry().create<Map>(name, value);
}

void note(benchmark::State& state, const Map& map) {
  state.counters["MB"] = static_cast<double>(map.bytes()) / 1e6;
}

void map_insert(benchmark::State& state, const char* name, const char* mode, int step) {
  const std::vector<Scan>& scans = real_scans(step);
  if (scans.empty()) return state.SkipWithError("no ../shared/data (LAPWING_DATA)");
  for (auto _ : state) {
    const std::unique_ptr<Map> map = new_map(name, 0.05, mode);
    for (const Scan& scan : scans) map->integrate(scan.points, scan.origin);
    note(state, *map);
  }
}

// The room of the real frames and the street, in both backends, scan by scan as a flight makes
// them: a tree whose nodes came one after the other lies otherwise in memory than one that was
// read.
struct Maps {
  std::unique_ptr<Map> brick, octomap;
  const Map& of(const std::string& name) const { return name == "brick" ? *brick : *octomap; }
};

Maps two_maps(double resolution) {
  return {new_map("brick", resolution, "discretised"),
          new_map("octomap", resolution, "discretised")};
}

const Maps& room() {
  static const Maps maps = [] {
    Maps made = two_maps(0.05);
    for (Map* map : {made.brick.get(), made.octomap.get()})
      for (const Scan& scan : real_scans(2)) map->integrate(scan.points, scan.origin);
    return made;
  }();
  return maps;
}

const Maps& street() {
  static const Maps maps = [] {
    Maps made = two_maps(0.2);
    const std::vector<PosedDepthImage> frames = street_frames(160, 160, 120);
    for (Map* map : {made.brick.get(), made.octomap.get()})
      for (const PosedDepthImage& frame : frames) map->integrate(frame);
    return made;
  }();
  return maps;
}

// Every eighth pixel of every fifth real frame, to 10 m.
std::vector<MapRay> room_rays() {
  std::vector<MapRay> rays;
  const std::vector<PosedDepthImage> frames = real_frames(50);
  for (std::size_t k = 0; k < frames.size(); k += 5) {
    const Pinhole& pinhole = frames[k].image.pinhole;
    const Pose& camera = frames[k].camera;
    for (int y = 0; y < pinhole.height; y += 8)
      for (int x = 0; x < pinhole.width; x += 8)
        rays.push_back(
            {camera.position, (camera.orientation * pixel_ray(pinhole, x, y)).normalized(), 10});
  }
  return rays;
}

// 60 m rays through the street: all pixels of views of 600 x 450 from within it (thesis 4.9), in
// the order in which VisibleVoxels asks for them,
// ...
std::vector<MapRay> view_rays(int view) {
  std::vector<MapRay> rays;
  const Pinhole pinhole{600, 450, 345, 345, 299.5, 224.5};
  const Pose camera =
      camera_pose({-36 + 8.0 * view, 1.5 * std::sin(view), 2.0 + view % 4 * 3}, 1.1 * view, -0.2);
  for (const Eigen::Vector3d& ray_C : tiled_pixel_rays(pinhole))
    rays.push_back({camera.position, (camera.orientation * ray_C).normalized(), 60});
  return rays;
}

std::vector<MapRay> street_rays() {
  std::vector<MapRay> rays;
  for (const int view : {1, 4, 7})
    for (const MapRay& ray : view_rays(view)) rays.push_back(ray);
  return rays;
}

// ... and one by one, no two from one place, along the street from either end.
std::vector<MapRay> single_rays() {
  std::vector<MapRay> rays;
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const double side = k % 2 ? 1 : -1;
    rays.push_back({{-38 * side, random.uniform(-1.5, 1.5), random.uniform(2, 12)},
                    Eigen::Vector3d(side, random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.05))
                        .normalized(),
                    60});
  }
  return rays;
}

void cast(benchmark::State& state, const Maps& maps, const std::string& name,
          const std::vector<MapRay>& rays) {
  std::vector<MapRayHit> hits(rays.size()), others(rays.size());
  for (auto _ : state) maps.of(name).cast(rays, hits);
  double length = 0;
  for (const MapRayHit& hit : hits) length += hit.distance / static_cast<double>(hits.size());
  state.counters["ns_a_ray"] = benchmark::Counter(
      static_cast<double>(rays.size()) / 1e9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["mean_m"] = length;
  if (name != "brick") return;
  maps.octomap->cast(rays, others);
  for (std::size_t k = 0; k < rays.size(); ++k)
    if (hits[k].voxel != others[k].voxel || hits[k].state != others[k].state ||
        hits[k].distance != others[k].distance)
      return state.SkipWithError("a ray meets another voxel than in octomap");
}

// The same with OctoMap's own castRay, which takes a voxel for free unless it is more likely
// occupied than not.
void cast_by_octomap(benchmark::State& state, const Maps& maps, const std::vector<MapRay>& rays) {
  std::istringstream bytes(map_file_bytes(".ot", *maps.octomap));
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(bytes));
  const auto& tree = dynamic_cast<const octomap::OcTree&>(*read);
  const auto point = [](const Eigen::Vector3d& p) {
    const Eigen::Vector3f f = p.cast<float>();
    return octomap::point3d(f.x(), f.y(), f.z());
  };
  double length = 0;
  for (auto _ : state) {
    length = 0;
    for (const MapRay& ray : rays) {
      octomap::point3d end;
      const octomap::point3d origin = point(ray.origin);
      tree.castRay(origin, point(ray.direction), end, false, ray.range);
      length += (end - origin).norm() / static_cast<double>(rays.size());
    }
  }
  state.counters["mean_m"] = length;
}

void map_cast_room(benchmark::State& state, const char* name) {
  if (!data_folder()) return state.SkipWithError("no ../shared/data (LAPWING_DATA)");
  cast(state, room(), name, room_rays());
}

void map_cast_street(benchmark::State& state, const char* name) {
  cast(state, street(), name, street_rays());
}

void map_cast_singly(benchmark::State& state, const char* name) {
  cast(state, street(), name, single_rays());
}

void map_castRay_room(benchmark::State& state) {
  if (!data_folder()) return state.SkipWithError("no ../shared/data (LAPWING_DATA)");
  cast_by_octomap(state, room(), room_rays());
}

void map_castRay_street(benchmark::State& state) {
  cast_by_octomap(state, street(), street_rays());
}

// Whole views, on two threads.
void map_view(benchmark::State& state) {
  std::vector<std::vector<MapRay>> views;
  for (int k = 0; k < 10; ++k) views.push_back(view_rays(k));
  Map& map = *street().brick;
  map.set_threads(2);
  std::vector<MapRayHit> hits(views.front().size());
  std::size_t next = 0;
  for (auto _ : state) map.cast(views[next++ % views.size()], hits);
  map.set_threads(1);
}

// Boxes of 1 m^3 over 10 m, along the street; some must get through, for what is blocked at once
// costs nothing.
void map_sweep(benchmark::State& state, const char* name, int count) {
  const Maps& maps = street();
  Random random(9);
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> ways;
  for (int k = 0; k < count; ++k) {
    const double yaw = random.uniform(0, 6.2832);
    const Eigen::Vector3d from(random.uniform(-38, 38), random.uniform(-3, 3),
                               random.uniform(1.5, 14));
    const Eigen::Vector3d way(std::cos(yaw), 0.2 * std::sin(yaw), 0.05);
    ways.emplace_back(from, from + 10 * way.normalized());
  }
  int free = 0;
  for (auto _ : state) {
    free = 0;
    for (const auto& [from, to] : ways)
      free += maps.of(name).swept_box_free(from, to, Eigen::Vector3d::Constant(0.5));
  }
  state.counters["free"] = static_cast<double>(free) / count;
  if (10 * free < count) state.SkipWithError("less than a tenth of the boxes get through");
}

#define MAP_INSERT(name, mode, step, label)              \
  BENCHMARK_CAPTURE(map_insert, label, name, mode, step) \
      ->Unit(benchmark::kMillisecond)                    \
      ->Iterations(1)
MAP_INSERT("brick", "discretised", 2, brick_discretised);
MAP_INSERT("octomap", "discretised", 2, octomap_discretised);
MAP_INSERT("brick", "exact", 2, brick_exact);
MAP_INSERT("octomap", "exact", 2, octomap_exact);
MAP_INSERT("brick", "discretised", 1, brick_discretised_all_pixels);
MAP_INSERT("octomap", "discretised", 1, octomap_discretised_all_pixels);
MAP_INSERT("brick", "exact", 1, brick_exact_all_pixels);
MAP_INSERT("octomap", "exact", 1, octomap_exact_all_pixels);
BENCHMARK_CAPTURE(map_cast_room, brick, "brick")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(map_cast_room, octomap, "octomap")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(map_cast_street, brick, "brick")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(map_cast_street, octomap, "octomap")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(map_cast_singly, brick, "brick")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(map_cast_singly, octomap, "octomap")->Unit(benchmark::kMillisecond);
BENCHMARK(map_castRay_room)->Unit(benchmark::kMillisecond);
BENCHMARK(map_castRay_street)->Unit(benchmark::kMillisecond);
BENCHMARK(map_view)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(map_sweep, brick_10000, "brick", 10000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(map_sweep, octomap_100, "octomap", 100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapwing
