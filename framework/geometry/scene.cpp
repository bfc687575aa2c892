// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/geometry/shape_hits.h"
#include "framework/geometry/tracing_device.h"

namespace lapwing {
namespace {

// What a traversal carries besides Embree's own ray: the ray in double precision and the best hit.
struct Query : RTCIntersectContext {
  Ray ray;
  double farthest = 0;
  std::optional<RayHit> best;
};

float rounded_up(double value) {
  return static_cast<float>(value * (1 + 1e-6) + 1e-4);
}

void offer(const BodyShape& shape, int number, Query& query) {
  const auto found = hit(shape, query.ray);
  if (!found || found->distance >= query.farthest) return;
  if (query.best && (found->distance > query.best->distance ||
                     (found->distance == query.best->distance && number > query.best->shape))) {
    return;
  }
  query.best = RayHit{found->distance, number, found->normal};
}

RTCRay ray_of(const Query& query) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(query.ray.origin.x());
  ray.org_y = static_cast<float>(query.ray.origin.y());
  ray.org_z = static_cast<float>(query.ray.origin.z());
  ray.dir_x = static_cast<float>(query.ray.direction.x());
  ray.dir_y = static_cast<float>(query.ray.direction.y());
  ray.dir_z = static_cast<float>(query.ray.direction.z());
  ray.tfar = std::isfinite(query.farthest) ? rounded_up(query.farthest)
                                           : std::numeric_limits<float>::infinity();
  ray.mask = ~0u;
  return ray;
}

}  // namespace

bool drawable(const BodyShape& shape) {
  return *problem_of(shape) == '\0';
}

struct Scene::Tracer {
  explicit Tracer(std::vector<BodyShape> list) : shapes(std::move(list)) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const std::string problem = problem_of(shapes[i]);
      if (!problem.empty()) {
        throw InputError("shape " + std::to_string(i + 1) + " of the scene: " + problem);
      }
      const bool endless = std::holds_alternative<GroundShape>(shapes[i]);
      (endless ? grounds : bounded).push_back(static_cast<int>(i));
    }
    scene = rtcNewScene(tracing_device());
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(tracing_device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(bounded.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, bound, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    commit(scene, "a scene");
  }
  ~Tracer() { rtcReleaseScene(scene); }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  static void bound(const RTCBoundsFunctionArguments* args) {
    const auto& self = *static_cast<const Tracer*>(args->geometryUserPtr);
    const BlockShape box = bounds_of(self.shape(args->primID));
    // Wide enough for what single precision loses of the ray and of the box.
    constexpr double kSlack = 0.02;
    RTCBounds& out = *args->bounds_o;
    out.lower_x = static_cast<float>(box.lower.x() - kSlack);
    out.lower_y = static_cast<float>(box.lower.y() - kSlack);
    out.lower_z = static_cast<float>(box.lower.z() - kSlack);
    out.upper_x = static_cast<float>(box.upper.x() + kSlack);
    out.upper_y = static_cast<float>(box.upper.y() + kSlack);
    out.upper_z = static_cast<float>(box.upper.z() + kSlack);
  }

  static void intersect(const RTCIntersectFunctionNArguments* args) {
    const auto& self = *static_cast<const Tracer*>(args->geometryUserPtr);
    Query& query = *static_cast<Query*>(args->context);
    if (!args->valid[0]) return;
    offer(self.shape(args->primID), self.bounded[args->primID], query);
    auto& ray = reinterpret_cast<RTCRayHit*>(args->rayhit)->ray;
    if (query.best) ray.tfar = std::min(ray.tfar, rounded_up(query.best->distance));
  }

  static void occlude(const RTCOccludedFunctionNArguments* args) {
    const auto& self = *static_cast<const Tracer*>(args->geometryUserPtr);
    Query& query = *static_cast<Query*>(args->context);
    if (!args->valid[0]) return;
    offer(self.shape(args->primID), self.bounded[args->primID], query);
    if (query.best) {
      reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
    }
  }

  const BodyShape& shape(unsigned primitive) const {
    return shapes[static_cast<std::size_t>(bounded[primitive])];
  }

  std::vector<BodyShape> shapes;
  std::vector<int> bounded, grounds;  // places in `shapes`
  RTCScene scene = nullptr;
};

Scene::Scene(std::vector<BodyShape> shapes)
    : tracer_(std::make_unique<Tracer>(std::move(shapes))) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const std::vector<BodyShape>& Scene::shapes() const {
  return tracer_->shapes;
}

std::optional<RayHit> Scene::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double farthest) const {
  Query query;
  rtcInitIntersectContext(&query);
  query.ray = {origin, direction};
  query.farthest = farthest;
  for (const int i : tracer_->grounds)
    offer(tracer_->shapes[static_cast<std::size_t>(i)], i, query);
  RTCRayHit ray{};
  ray.ray = ray_of(query);
  ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(tracer_->scene, &query, &ray);
  return query.best;
}

bool Scene::blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                    double farthest) const {
  Query query;
  rtcInitIntersectContext(&query);
  query.ray = {origin, direction};
  query.farthest = farthest;
  for (const int i : tracer_->grounds) {
    offer(tracer_->shapes[static_cast<std::size_t>(i)], i, query);
    if (query.best) return true;
  }
  RTCRay ray = ray_of(query);
  rtcOccluded1(tracer_->scene, &query, &ray);
  return query.best.has_value();
}

}  // namespace lapwing
