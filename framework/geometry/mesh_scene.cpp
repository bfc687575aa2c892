// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/mesh_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/geometry/tracing_device.h"
#include "framework/geometry/triangle_tests.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostTrianglesWide = 3000000;

RTCRay embree_ray(const MeshRay& ray) {
  RTCRay out{};
  out.org_x = static_cast<float>(ray.origin.x());
  out.org_y = static_cast<float>(ray.origin.y());
  out.org_z = static_cast<float>(ray.origin.z());
  out.dir_x = static_cast<float>(ray.direction.x());
  out.dir_y = static_cast<float>(ray.direction.y());
  out.dir_z = static_cast<float>(ray.direction.z());
  out.tfar = static_cast<float>(ray.farthest);
  out.mask = ~0u;
  return out;
}

Triangle triangle_of(const TriangleMesh& mesh, std::size_t i) {
  return {mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2)};
}

// Wider by what single precision loses of a coordinate.
float widened(double radius, const Vector3d& p) {
  return static_cast<float>(radius * (1 + 1e-6) + 1e-6 * (1 + p.cwiseAbs().maxCoeff()));
}

struct NearestSearch {
  const TriangleMesh& mesh;
  Vector3d p;
  double reach;
  NearestTriangle best{kInfinite, -1, Vector3d::Zero()};
};

struct BoxSearch {
  const TriangleMesh& mesh;
  Vector3d from, to, half;
  bool found = false;
};

bool visit_nearest(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<NearestSearch*>(args->userPtr);
  const int triangle = static_cast<int>(args->primID);
  const Vector3d point = nearest_point(triangle_of(search.mesh, args->primID), search.p);
  double distance = (point - search.p).norm();
  // On a triangle the difference is rounding, and its direction means nothing.
  if (distance <= 1e-12 * (1 + search.p.cwiseAbs().maxCoeff())) distance = 0;
  if (!(distance <= search.reach) || distance > search.best.distance ||
      (distance == search.best.distance && triangle > search.best.triangle)) {
    return false;
  }
  search.best = {distance, triangle, point};
  args->query->radius = std::min(args->query->radius, widened(distance, search.p));
  return true;
}

bool visit_box(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<BoxSearch*>(args->userPtr);
  if (search.found) return false;
  if (!swept_box_meets(triangle_of(search.mesh, args->primID), search.from, search.to,
                       search.half)) {
    return false;
  }
  search.found = true;
  args->query->radius = 0;
  return true;
}

void query(RTCScene scene, const Vector3d& p, double radius, RTCPointQueryFunction visit,
           void* search) {
  RTCPointQuery embree{};
  embree.x = static_cast<float>(p.x());
  embree.y = static_cast<float>(p.y());
  embree.z = static_cast<float>(p.z());
  embree.radius = widened(radius, p);
  RTCPointQueryContext stack;
  rtcInitPointQueryContext(&stack);
  rtcPointQuery(scene, &embree, &stack, visit, search);
}

}  // namespace

struct MeshScene::Tracer {
  explicit Tracer(TriangleMesh given, const std::string& what) : mesh(std::move(given)) {
    check_mesh(mesh, what);
    scene = rtcNewScene(tracing_device());
    // A compact hierarchy is a little slower, and takes half the memory.
    const bool compact = mesh.triangles.size() > kMostTrianglesWide;
    rtcSetSceneFlags(
        scene, compact ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(tracing_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    auto* corners = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangles.size()));
    if (vertices && corners) fill(vertices, corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    commit(scene, "the scene of a mesh");
  }
  ~Tracer() { rtcReleaseScene(scene); }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  void fill(float* vertices, unsigned* corners) const {
    for (const Vector3d& v : mesh.vertices) {
      for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(v[i]);
    }
    for (const auto& triangle : mesh.triangles) {
      for (const std::int32_t index : triangle) *corners++ = static_cast<unsigned>(index);
    }
  }

  TriangleMesh mesh;
  RTCScene scene = nullptr;
};

MeshScene::MeshScene(TriangleMesh mesh, const std::string& what)
    : tracer_(std::make_unique<Tracer>(std::move(mesh), what)) {}
MeshScene::~MeshScene() = default;
MeshScene::MeshScene(MeshScene&&) noexcept = default;
MeshScene& MeshScene::operator=(MeshScene&&) noexcept = default;

const TriangleMesh& MeshScene::mesh() const {
  return tracer_->mesh;
}

MeshHit MeshScene::cast(const MeshRay& ray) const {
  RTCRayHit embree{};
  embree.ray = embree_ray(ray);
  embree.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext incoherent;
  rtcInitIntersectContext(&incoherent);
  rtcIntersect1(tracer_->scene, &incoherent, &embree);
  if (embree.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  MeshHit hit;
  hit.triangle = static_cast<int>(embree.hit.primID);
  const Triangle triangle = triangle_of(tracer_->mesh, embree.hit.primID);
  const double exact = plane_distance(triangle, ray.origin, ray.direction);
  // Along a plane that is all but parallel to the ray the plane tells nothing.
  const double slack = 1e-3 * (1 + std::abs(static_cast<double>(embree.ray.tfar)));
  const double found = static_cast<double>(embree.ray.tfar);
  hit.distance = std::abs(exact - found) <= slack ? std::max(exact, 0.0) : found;
  hit.normal = (triangle.b - triangle.a).cross(triangle.c - triangle.a).normalized();
  if (hit.normal.dot(ray.direction) > 0) hit.normal = -hit.normal;
  return hit;
}

bool MeshScene::blocked(const MeshRay& ray) const {
  RTCRay embree = embree_ray(ray);
  RTCIntersectContext incoherent;
  rtcInitIntersectContext(&incoherent);
  rtcOccluded1(tracer_->scene, &incoherent, &embree);
  return embree.tfar < 0;
}

void MeshScene::cast(std::span<const MeshRay> rays, std::span<MeshHit> hits, int threads) const {
  if (rays.size() != hits.size()) throw Error("MeshScene::cast: sizes differ");
  constexpr std::size_t kBlock = 256;
  parallel_for((rays.size() + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    const std::size_t end = std::min(rays.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) hits[i] = cast(rays[i]);
  });
}

std::optional<NearestTriangle> MeshScene::nearest(const Vector3d& p_W, double reach) const {
  NearestSearch search{tracer_->mesh, p_W, reach};
  query(tracer_->scene, p_W, reach, visit_nearest, &search);
  if (search.best.triangle < 0) return std::nullopt;
  return search.best;
}

bool MeshScene::box_blocked(const Vector3d& from, const Vector3d& to, const Vector3d& half) const {
  // Balls around pieces of the way, not much longer than the box, hold all triangles that matter.
  const double length = (to - from).norm(), size = std::max(half.norm(), 1e-3);
  const int pieces = static_cast<int>(std::clamp(std::ceil(length / (4 * size)), 1.0, 1e6));
  BoxSearch search{tracer_->mesh, from, to, half};
  for (int i = 0; i < pieces && !search.found; ++i) {
    const Vector3d middle = from + (i + 0.5) / pieces * (to - from);
    query(tracer_->scene, middle, half.norm() + length / (2 * pieces), visit_box, &search);
  }
  return search.found;
}

MeshDistance::MeshDistance(std::shared_ptr<const MeshScene> scene, double reach)
    : scene_(std::move(scene)), reach_(reach) {
  if (!scene_ || !(reach_ > 0 && std::isfinite(reach_))) {
    throw Error("MeshDistance: expected a scene and a finite reach above 0 m");
  }
}

double MeshDistance::distance(const Vector3d& p_W, Vector3d* gradient) const {
  const auto found = scene_->nearest(p_W, reach_);
  if (gradient) {
    gradient->setZero();
    if (found && found->distance > 0) *gradient = (p_W - found->point) / found->distance;
  }
  return found ? found->distance : reach_;
}

}  // namespace lapwing
