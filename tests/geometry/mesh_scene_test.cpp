// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/core/random.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/triangle_tests.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

MeshScene unit_cube() {
  MeshBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1});
  return MeshScene(builder.take());
}

// Triangles all over a cube of 20 m, of sizes that differ by a factor of a hundred.
TriangleMesh soup(std::uint64_t seed, int count) {
  Random random(seed);
  TriangleMesh mesh;
  const auto within = [&](double r) {
    return Vector3d(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
  };
  for (std::int32_t i = 0; i < count; ++i) {
    const Vector3d middle = within(10);
    const double size = std::pow(10, random.uniform(-1.5, 0.5));
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(middle + within(size));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(MeshScene, RaysMeetACubeWhereTheyShould) {
  const MeshScene scene = unit_cube();
  const MeshHit front = scene.cast({{-5, 0.2, 0.3}, {1, 0, 0}});
  EXPECT_NEAR(front.distance, 4, 1e-12);
  EXPECT_EQ(front.normal, Vector3d(-1, 0, 0));
  const MeshHit from_inside = scene.cast({{0, 0.1, 0.2}, {0, 0, 1}});
  EXPECT_NEAR(from_inside.distance, 0.8, 1e-12);
  EXPECT_EQ(from_inside.normal, Vector3d(0, 0, -1));
  EXPECT_EQ(scene.cast({{-5, 0, 0}, {-1, 0, 0}}).triangle, -1);
  EXPECT_EQ(scene.cast({{-5, 0.2, 0.3}, {1, 0, 0}, 3.9}).triangle, -1);
  EXPECT_TRUE(scene.blocked({{-5, 0.2, 0.3}, {1, 0, 0}, 4.1}));
  EXPECT_FALSE(scene.blocked({{-5, 0.2, 0.3}, {1, 0, 0}, 3.9}));
  // Through edges and corners no ray slips in.
  for (const double y : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    EXPECT_NEAR(scene.cast({{-5, y, y}, {1, 0, 0}}).distance, 4, 1e-6) << y;
  }
}

TEST(MeshScene, EqualsASearchThroughAllTriangles) {
  const MeshScene scene{soup(3, 3000)};
  const TriangleMesh& mesh = scene.mesh();
  Random random(7);
  const auto within = [&](double r) {
    return Vector3d(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
  };
  int hits = 0;
  for (int k = 0; k < 300; ++k) {
    const MeshRay ray{within(15), within(1).normalized(), 30};
    double nearest_hit = ray.farthest, nearest = 100;
    const Vector3d p = within(15);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t{mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2)};
      nearest = std::min(nearest, (nearest_point(t, p) - p).norm());
      const double d = plane_distance(t, ray.origin, ray.direction);
      if (!(d > 0) || d >= nearest_hit) continue;
      const Vector3d at = ray.origin + d * ray.direction;
      if ((nearest_point(t, at) - at).norm() < 1e-9) nearest_hit = d;
    }
    const MeshHit hit = scene.cast(ray);
    if (nearest_hit < ray.farthest) {
      ++hits;
      EXPECT_NEAR(hit.distance, nearest_hit, 1e-4);
    }
    EXPECT_EQ(scene.blocked(ray), hit.triangle >= 0);
    ASSERT_TRUE(scene.nearest(p, 100));
    EXPECT_NEAR(scene.nearest(p, 100)->distance, nearest, 1e-12);
    EXPECT_EQ(scene.nearest(p, nearest * 0.999).has_value(), false);
    EXPECT_EQ(scene.nearest(p, nearest * 1.001).has_value(), true);
  }
  EXPECT_GT(hits, 50);
}

TEST(MeshScene, PointsOfATriangleAreNearestWhereSamplingSaysSo) {
  Random random(5);
  const auto within = [&] {
    return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (int k = 0; k < 200; ++k) {
    const Triangle t{within(), within(), within()};
    const Vector3d p = 2 * within(), q = nearest_point(t, p);
    double best = 1e9;
    for (int i = 0; i <= 60; ++i) {
      for (int j = 0; i + j <= 60; ++j) {
        best = std::min(best, (t.a + i / 60.0 * (t.b - t.a) + j / 60.0 * (t.c - t.a) - p).norm());
      }
    }
    EXPECT_LE((q - p).norm(), best + 1e-12);
    EXPECT_GE((q - p).norm(), best - 0.05);
  }
}

TEST(MeshScene, DistanceHasItsGradient) {
  const auto scene = std::make_shared<const MeshScene>(unit_cube());
  const MeshDistance field(scene, 5);
  Vector3d gradient;
  EXPECT_NEAR(field.distance({3, 0, 0}, &gradient), 2, 1e-12);
  EXPECT_LT((gradient - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(field.distance({2, 2, 0}, &gradient), std::sqrt(2), 1e-12);
  EXPECT_LT((gradient - Vector3d(1, 1, 0).normalized()).norm(), 1e-12);
  EXPECT_NEAR(field.distance({0.5, 0.1, 0}, &gradient), 0.5, 1e-12);
  EXPECT_LT((gradient - Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(field.distance({7, 0, 0}, &gradient), 5);
  EXPECT_EQ(gradient, Vector3d::Zero());
  EXPECT_EQ(field.distance({1, 0.2, 0.2}, &gradient), 0);
  EXPECT_EQ(gradient, Vector3d::Zero());
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Vector3d p(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4));
    const double d = field.distance(p, &gradient);
    if (d >= 5 || p.cwiseAbs().maxCoeff() < 1.01) continue;
    for (int i = 0; i < 3; ++i) {
      const Vector3d step = 1e-6 * Vector3d::Unit(i);
      const double slope =
          (field.distance(p + step, nullptr) - field.distance(p - step, nullptr)) / 2e-6;
      EXPECT_NEAR(gradient[i], slope, 1e-4);
    }
  }
  EXPECT_THROW(MeshDistance(scene, 0), Error);
}

TEST(MeshScene, BoxesPassWhereThereIsRoom) {
  const MeshScene scene = unit_cube();
  const Vector3d half(0.5, 0.5, 0.5);
  // Past the cube at exactly its side: touching is free (reading 5.3).
  EXPECT_FALSE(scene.box_blocked({-5, 1.5, 0}, {5, 1.5, 0}, half));
  EXPECT_TRUE(scene.box_blocked({-5, 1.499, 0}, {5, 1.499, 0}, half));
  EXPECT_FALSE(scene.box_blocked({-5, 0, 0}, {-1.5, 0, 0}, half));
  EXPECT_TRUE(scene.box_blocked({-5, 0, 0}, {-1.49, 0, 0}, half));
  EXPECT_TRUE(scene.box_blocked({-50, 0, 0}, {50, 0, 0}, {0.1, 0.1, 0.1}));
  // Around the corner on the diagonal: the box's own corner leads.
  EXPECT_FALSE(scene.box_blocked({3.01, 0, 0}, {0, 3.01, 0}, half));
  EXPECT_TRUE(scene.box_blocked({2.99, 0, 0}, {0, 2.99, 0}, half));
  // A box that does not move, and one without a size.
  EXPECT_TRUE(scene.box_blocked({1.4, 0, 0}, {1.4, 0, 0}, half));
  EXPECT_FALSE(scene.box_blocked({1.6, 0, 0}, {1.6, 0, 0}, half));
  EXPECT_TRUE(scene.box_blocked({-5, 0.3, 0.2}, {5, 0.3, 0.2}, Vector3d::Zero()));
}

TEST(MeshScene, SweptBoxesEqualManyBoxesAlongTheWay) {
  const MeshScene scene{soup(11, 300)};
  Random random(13);
  const auto within = [&](double r) {
    return Vector3d(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
  };
  int free = 0, blocked = 0;
  for (int k = 0; k < 300; ++k) {
    const Vector3d a = within(12), b = a + within(6), half(0.4, 0.3, 0.2);
    const double step = (b - a).norm() / 400;
    bool sampled = false, sampled_wider = false;
    for (int i = 0; i <= 400; ++i) {
      const Vector3d p = a + i / 400.0 * (b - a);
      sampled = sampled || scene.box_blocked(p, p, half);
      sampled_wider = sampled_wider || scene.box_blocked(p, p, half + Vector3d::Constant(step));
    }
    const bool swept = scene.box_blocked(a, b, half);
    EXPECT_TRUE(swept || !sampled);
    EXPECT_TRUE(!swept || sampled_wider);
    ++(swept ? blocked : free);
  }
  EXPECT_GT(free, 30);
  EXPECT_GT(blocked, 30);
}

TEST(MeshScene, BatchesDoNotDependOnThreads) {
  const MeshScene scene{soup(3, 2000)};
  Random random(2);
  std::vector<MeshRay> rays(3000);
  for (MeshRay& ray : rays) {
    ray.origin = {random.uniform(-12, 12), random.uniform(-12, 12), random.uniform(-12, 12)};
    ray.direction = Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  }
  std::vector<MeshHit> one(rays.size()), two(rays.size());
  scene.cast(rays, one, 1);
  scene.cast(rays, two, 2);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(one[i].triangle, two[i].triangle);
    EXPECT_EQ(one[i].distance, two[i].distance);
    EXPECT_EQ(one[i].distance, scene.cast(rays[i]).distance);
  }
  EXPECT_THROW(scene.cast(rays, std::span(one).first(3), 1), Error);
}

TEST(MeshScene, LeavesTheOtherThreadsToOthers) {
  // Embree may cap the threads of the whole process; a loop beside it must keep its own.
  const MeshScene scene = unit_cube();
  if (available_threads() < 2) GTEST_SKIP() << "one core";
  std::set<std::thread::id> seen;
  std::mutex mutex;
  std::condition_variable both;
  // Whoever comes first waits for the other: a busy machine wakes threads late.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  parallel_for(64, 2, [&](std::size_t) {
    std::unique_lock lock(mutex);
    seen.insert(std::this_thread::get_id());
    both.notify_all();
    both.wait_until(lock, deadline, [&] { return seen.size() >= 2; });
  });
  EXPECT_EQ(seen.size(), 2u);
}

TEST(MeshScene, RefusesAMeshThatIsNone) {
  const auto message = [](const TriangleMesh& mesh) -> std::string {
    try {
      const MeshScene scene(mesh, "hut");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  TriangleMesh good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
  EXPECT_EQ(message(good), "");
  EXPECT_EQ(message({}), "hut: the mesh has no triangle");
  TriangleMesh mesh = good;
  mesh.vertices[1].y() = std::nan("");
  EXPECT_NE(message(mesh).find("hut: vertex 2"), std::string::npos);
  mesh = good;
  mesh.triangles[0][2] = 3;
  EXPECT_NE(message(mesh).find("triangle 1 names vertex 4 of 3"), std::string::npos);
  mesh = good;
  mesh.triangles[0][2] = -1;
  EXPECT_NE(message(mesh), "");
  mesh = good;
  mesh.colors.resize(2);
  EXPECT_NE(message(mesh), "");
  mesh = good;
  mesh.vertices[0].x() = 2e5;
  EXPECT_NE(message(mesh), "");
}

TEST(MeshScene, WeldingJoinsWhatIsEqual) {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}},
                    {{0, 1, 2}, {3, 4, 5}, {0, 1, 3}, {0, 0, 1}},
                    {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {0, 0, 0}}};
  weld(mesh, 0);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[1], (std::array<std::int32_t, 3>{1, 3, 2}));
  EXPECT_EQ(mesh.colors[1], (Rgb{4, 5, 6}));
}

}  // namespace
}  // namespace lapwing
