// SPDX-License-Identifier: Apache-2.0
#include "framework/core/checksum.h"
#include "framework/core/json.h"
#include "framework/export/surroundings.h"
#include "framework/studio/blob_store.h"
#include "framework/studio/plan_message.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostDrawn = 500;  // surfaces that are kept

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

}  // namespace

WorldMessage world_message(const Plan& plan, const std::filesystem::path& folder,
                           DrawnSurfaces& drawn) {
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
    std::string blob = blob_of(obstacle, plan, folder, drawn);
    if (!blob.empty()) {
      const std::string name = sha256(blob);
      one.set("blob", name);
      message.blobs.emplace(name, std::move(blob));
    }
    obstacles.push_back(std::move(one));
  }
  world.set("margin", plan.environment.margin);
  world.set("bounds", bounds_of(plan));
  message.text = to_json(world, -1);
  return message;
}

}  // namespace lapwing
