// SPDX-License-Identifier: Apache-2.0
#include "framework/core/checksum.h"
#include "framework/core/json.h"
#include "framework/export/episode_file.h"
#include "framework/export/prediction_mesh.h"
#include "framework/export/prediction_report.h"
#include "framework/export/scan_report.h"
#include "framework/export/surroundings.h"
#include "framework/studio/blob_store.h"
#include "framework/studio/plan_message.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostDrawn = 500;  // surfaces that are kept
constexpr std::size_t kCoarseTriangles = 16000;

Value place_of(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

Value track_of(const Obstacle& obstacle) {
  Value track = Value::list();
  for (std::size_t i = 0; i < obstacle.times.size(); ++i) {
    Value entry = Value::map();
    entry.set("time", obstacle.times[i]);
    entry.set("move", place_of(obstacle.moves[i]));
    track.push_back(std::move(entry));
  }
  return track;
}

// Of the surface without its moves; "" where there is none.
std::string blob_of(const Obstacle& obstacle, const Plan& plan, const std::filesystem::path& folder,
                    DrawnSurfaces& drawn) {
  const std::string stated = obstacle.type + to_json(obstacle.parameters, -1);
  if (const auto found = drawn.find(stated); found != drawn.end()) return found->second;
  const TriangleMesh mesh = drawn_surface(obstacle, plan, folder);
  if (drawn.size() >= kMostDrawn) drawn.clear();
  return drawn[stated] = mesh.triangles.empty() ? "" : triangles_blob(mesh);
}

Value bounds_of(const Plan& plan) {
  Eigen::AlignedBox3d box;
  for (const Subject& subject : plan.environment.subjects)
    for (const Eigen::Vector3d& p : subject.positions) box.extend(p);
  for (const Obstacle& obstacle : plan.environment.obstacles) {
    if (!obstacle.shape) continue;
    const Eigen::AlignedBox3d own = obstacle.shape->bounds();
    if (own.isEmpty() || !(own.sizes().maxCoeff() < 1e5)) continue;
    box.extend(own);
  }
  Value bounds = Value::map();
  if (box.isEmpty()) return bounds;
  bounds.set("lower", place_of(box.min()));
  bounds.set("upper", place_of(box.max()));
  return bounds;
}

Value places_of(const std::vector<Eigen::Vector3d>& places) {
  Value list = Value::list();
  for (const Eigen::Vector3d& p : places) list.push_back(place_of(p));
  return list;
}

Value polygon_of(const GroundPolygon& polygon) {
  Value list = Value::list();
  for (const Eigen::Vector2d& p : polygon) list.push_back(Value(Value::List{p.x(), p.y()}));
  return list;
}

Value prism_of(const RegionPrism& prism) {
  Value value = Value::map();
  value.set("name", as_utf8(prism.name));
  value.set("corners", polygon_of(prism.outline));
  Value& holes = value.set("holes", Value::list());
  for (const GroundPolygon& hole : prism.holes) holes.push_back(polygon_of(hole));
  value.set("low", prism.low);
  value.set("high", prism.high);
  value.set("weight", prism.weight);
  return value;
}

Value region_of(const InterestRegion& region) {
  Value list = Value::list();
  for (const RegionPrism& prism : region.prisms()) list.push_back(prism_of(prism));
  if (!region.is_box() || region.is_empty()) return list;
  const Eigen::Vector3d &a = region.bounds().min(), &b = region.bounds().max();
  RegionPrism box;
  box.outline = {{a.x(), a.y()}, {b.x(), a.y()}, {b.x(), b.y()}, {a.x(), b.y()}};
  box.low = a.z();
  box.high = b.z();
  list.push_back(prism_of(box));
  return list;
}

// Of the tour of this number, from 0; none is told of a single one.
void add_views(const ScanTask& task, std::optional<std::size_t> tour, Value& list) {
  for (const PlannedView& view : task.views) {
    Value one = Value::map();
    if (tour) one.set("tour", static_cast<std::int64_t>(*tour));
    one.set("time", view.time);
    one.set("position", place_of(view.position));
    one.set("yaw", view.yaw);
    one.set("pitch", view.pitch);
    one.set("matching", view.kind == ViewKind::matching);
    list.push_back(std::move(one));
  }
}

// The ends of what is known, and the edge of a voxel, m.
Value map_of(const Map& map) {
  Value value = Value::map();
  value.set("resolution", map.grid().resolution());
  if (const auto bounds = map.bounds()) {
    const VoxelKey &low = bounds->lower, &high = bounds->upper;
    value.set("lower", place_of(map.grid().corner(low)));
    value.set("upper", place_of({map.grid().face(high.x + 1), map.grid().face(high.y + 1),
                                 map.grid().face(high.z + 1)}));
  }
  return value;
}

// What a scan was planned on, and what its images will show: the figures of `lapwing run --json`.
Value scan_of(const Plan& plan, const ScanRecord& record, const std::vector<const Plan*>& tours) {
  const ScanTask& task = *plan.task.scan;
  Value value = Value::map();
  value.set("region", region_of(task.region));
  Value& views = value.set("views", Value::list());
  if (tours.empty()) add_views(task, std::nullopt, views);
  for (std::size_t t = 0; t < tours.size(); ++t)
    if (tours[t]->task.scan) add_views(*tours[t]->task.scan, t, views);
  value.set("image",
            Value(Value::List{std::int64_t{task.camera.width}, std::int64_t{task.camera.height},
                              task.camera.focal_x, task.camera.focal_y, task.camera.principal_x,
                              task.camera.principal_y}));
  value.set("first_views", places_of(record.first_views));
  Value& footprints = value.set("footprints", Value::list());
  for (const GroundPolygon& polygon : record.footprints) footprints.push_back(polygon_of(polygon));
  value.set("candidates", places_of(record.candidates));
  value.set("candidate_scores", Value(Value::List(record.alone.begin(), record.alone.end())));
  value.set("seconds", Value(Value::List(record.seconds.begin(), record.seconds.end())));
  value.set("score", Value(Value::List(record.score.begin(), record.score.end())));
  if (record.map) value.set("map", map_of(*record.map));
  value.set("areas", areas_as_value(record));
  value.set("words", areas_in_words(record));
  if (!record.prediction) return value;
  value.set("prediction", prediction_as_value(*record.prediction));
  value.set("prediction_words", prediction_in_words(*record.prediction));
  return value;
}

}  // namespace

std::string image_message(const TakenImage& image) {
  Value value = image_value(image.taken, image.observed.value_or(0));
  if (!image.observed) value.set("observed", Value());
  value.set("utility", image.utility);
  value.set("image", std::int64_t{image.image});
  value.set("asked", std::int64_t{image.asked});
  value.set("surface", image.surface);
  value.set("resolution", image.resolution);
  std::string text = to_json(value, -1), voxels;
  for (const Eigen::Vector3f& middle : image.grown)
    for (int i = 0; i < 3; ++i) {
      char number[24];
      std::snprintf(number, sizeof number, "%s%.3f", voxels.empty() ? "" : ",",
                    static_cast<double>(middle[i]));
      voxels += number;
    }
  text.pop_back();
  return text + ",\"grown\":[" + voxels + "]}";
}

WorldMessage world_message(const Plan& plan, const std::filesystem::path& folder,
                           const PlannedOn& on, DrawnSurfaces& drawn) {
  WorldMessage message;
  Value world = Value::map();
  world.set("type", "world");
  Value& obstacles = world.set("obstacles", Value::list());
  for (const Obstacle& obstacle : plan.environment.obstacles) {
    Value one = Value::map();
    one.set("name", obstacle.name);
    one.set("shape", obstacle.type);
    one.set("side", obstacle.side == Side::keep_inside ? "keep_inside" : "keep_out");
    one.set("opaque", obstacle.opaque);
    if (!obstacle.still()) one.set("track", track_of(obstacle));
    // What was explored is drawn by its growth, what is scanned by its coarse surface.
    const bool known = obstacle.type == "map" || (on.coarse && obstacle.type == "mesh");
    const bool left_out = known && (on.exploration || on.coarse);
    std::string blob = left_out ? "" : blob_of(obstacle, plan, folder, drawn);
    if (!blob.empty()) {
      const std::string name = sha256(blob);
      one.set("blob", name);
      message.blobs.emplace(name, std::move(blob));
    }
    obstacles.push_back(std::move(one));
  }
  world.set("margin", plan.environment.margin);
  world.set("bounds", bounds_of(plan));
  const auto put = [&](std::string bytes) {
    const std::string name = sha256(bytes);
    message.blobs.emplace(name, std::move(bytes));
    return name;
  };
  if (on.scan && plan.task.scan) {
    Value& told = world.set("scan", scan_of(plan, *on.scan, on.tours));
    if (on.scan->prediction)
      told.set("surface", put(on.coarse ? coarse_prediction(*on.scan->prediction, kCoarseTriangles)
                                        : prediction_ply(*on.scan->prediction)));
  }
  if (on.exploration) {
    Value& told = world.set("exploration", exploration_value(*on.exploration));
    if (!on.exploration->growth.empty()) told.set("growth", put(growth_bytes(*on.exploration)));
    if (!on.exploration->sights.empty())
      told.set("sights", put(sights_bytes(on.exploration->sights)));
  }
  message.text = to_json(world, -1);
  return message;
}

}  // namespace lapwing
