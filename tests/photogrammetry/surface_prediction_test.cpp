// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/surface_prediction.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/core/units.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_builder.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr Pinhole kPinhole{600, 450, 400, 400, 299.5, 224.5};
constexpr double kHeight = 10;

// A small triangle around the origin with that normal.
TriangleMesh triangle_at_origin(const Vector3d& normal) {
  const Vector3d a = normal.unitOrthogonal(), b = normal.cross(a);
  TriangleMesh mesh;
  for (int k = 0; k < 3; ++k) {
    const double angle = radians(120) * k;
    mesh.vertices.push_back(0.1 * (std::cos(angle) * a + std::sin(angle) * b));
  }
  mesh.triangles.push_back({0, 1, 2});
  return mesh;
}

Pose looking_at_origin(const Vector3d& from) {
  const Vector3d ahead = -from.normalized();
  return camera_pose(from, std::atan2(ahead.y(), ahead.x()), std::asin(ahead.z()));
}

Pose looking_down(double x, double y = 0) {
  return camera_pose({x, y, kHeight}, 0, radians(-90));
}

ImageSet images_of(const TriangleMesh& mesh, std::vector<Pose> cameras,
                   ImagingSettings settings = {kPinhole, 60, radians(75), 0.5}) {
  return ImageSet(std::make_shared<MeshScene>(mesh), std::move(cameras), settings);
}

TEST(SurfacePrediction, AStereoPairHasTheAccuracyOfTheTextbook) {
  // Both look down, a base apart: depth is known to sqrt(2) s h^2 / (f b), which is worse than the
  // accuracy across as long as the base is less than twice the height.
  for (const double base : {1., 2., 4., 8.}) {
    const auto told = images_of(triangle_at_origin(Vector3d::UnitZ()),
                                {looking_down(-base / 2), looking_down(base / 2)})
                          .predict(0);
    EXPECT_EQ(told.images, 2);
    EXPECT_NEAR(told.accuracy, std::sqrt(2.0) * 0.5 * kHeight * kHeight / (400 * base), 1e-6);
    EXPECT_NEAR(told.parallax, 2 * std::atan(base / 2 / kHeight), 1e-6);
    EXPECT_NEAR(told.incidence, std::atan(base / 2 / kHeight), 1e-6);
  }
}

TEST(SurfacePrediction, AccuracyIsThatOfTriangulatedNoise) {
  Random random(7);
  for (int scene = 0; scene < 4; ++scene) {
    std::vector<Pose> cameras;
    const int count = 2 + 2 * scene;
    for (int k = 0; k < count; ++k)
      cameras.push_back(
          looking_at_origin(Vector3d(random.uniform(-6, 6), random.uniform(-6, 6), 9)));
    const double predicted =
        images_of(triangle_at_origin(Vector3d::UnitZ()), cameras).predict(0).accuracy;
    // The origin from noisy pixels by Gauss and Newton, the pixels by CameraView's own projection.
    std::vector<CameraView> views;
    for (const Pose& camera : cameras) {
      CameraView view{kPinhole, camera.position, {}};
      const Eigen::Matrix3d turn = camera.orientation.toRotationMatrix();
      view.axes = {turn.col(0), turn.col(1), turn.col(2)};
      views.push_back(view);
    }
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    constexpr int kTrials = 3000;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<Eigen::Vector2d> pixels;
      for (const CameraView& view : views)
        pixels.push_back(*view.project(Vector3d::Zero()) +
                         0.5 * Eigen::Vector2d(random.normal(), random.normal()));
      Vector3d p = Vector3d::Zero();
      for (int round = 0; round < 4; ++round) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Vector3d right = Vector3d::Zero();
        for (std::size_t k = 0; k < views.size(); ++k) {
          Eigen::Matrix<double, 2, 3> j;
          for (int axis = 0; axis < 3; ++axis) {
            const Vector3d step = 1e-5 * Vector3d::Unit(axis);
            j.col(axis) = (*views[k].project(p + step) - *views[k].project(p - step)) / 2e-5;
          }
          normal += j.transpose() * j;
          right += j.transpose() * (pixels[k] - *views[k].project(p));
        }
        p += normal.inverse() * right;
      }
      covariance += p * p.transpose() / kTrials;
    }
    const double measured = std::sqrt(
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff());
    EXPECT_NEAR(predicted / measured, 1, 0.06) << count << " cameras";  // four deviations
  }
}

TEST(SurfacePrediction, APixelIsAsLargeAsTheRaysBesideItMeasure) {
  for (const double tilt : {0., 30., 60.}) {
    const Vector3d normal(std::sin(radians(tilt)), 0, std::cos(radians(tilt)));
    const auto told = images_of(triangle_at_origin(normal), {looking_down(0)}).predict(0);
    EXPECT_NEAR(told.pixel_size, kHeight / 400 / std::cos(radians(tilt)), 1e-7);
    EXPECT_NEAR(told.incidence, radians(tilt), 1e-6);
  }
  // Off the axis: half a pixel to either side, cut with the plane.
  const Pose camera = looking_down(5);
  const Vector3d in_camera = camera.orientation.conjugate() * (Vector3d::Zero() - camera.position);
  const double x = kPinhole.principal_x + 400 * in_camera.x() / in_camera.z();
  const double y = kPinhole.principal_y + 400 * in_camera.y() / in_camera.z();
  const auto on_plane = [&](double px, double py) {
    const Vector3d ray = camera.orientation * pixel_ray(kPinhole, px, py);
    return Vector3d(camera.position - camera.position.z() / ray.z() * ray);
  };
  double longest = 0;
  for (int k = 0; k < 360; ++k) {
    const double dx = 0.5 * std::cos(radians(k)), dy = 0.5 * std::sin(radians(k));
    longest = std::max(longest, (on_plane(x + dx, y + dy) - on_plane(x - dx, y - dy)).norm());
  }
  const auto told = images_of(triangle_at_origin(Vector3d::UnitZ()), {camera}).predict(0);
  EXPECT_NEAR(told.pixel_size, longest, 1e-5 * longest);
}

TEST(SurfacePrediction, OneImageOrParallelRaysLeaveThePlaceOpen) {
  const TriangleMesh mesh = triangle_at_origin(Vector3d::UnitZ());
  EXPECT_TRUE(std::isinf(images_of(mesh, {}).predict(0).accuracy));
  EXPECT_TRUE(std::isinf(images_of(mesh, {looking_down(1)}).predict(0).accuracy));
  const auto same = images_of(mesh, {looking_down(1), looking_down(1)}).predict(0);
  EXPECT_EQ(same.images, 2);
  EXPECT_TRUE(std::isinf(same.accuracy));
  EXPECT_EQ(same.parallax, 0);
  EXPECT_FALSE(same.located());
  EXPECT_FALSE(images_of(mesh, {looking_down(1), looking_down(1)}).locates(0));
  // 1 degree is 0.175 m at 10 m.
  EXPECT_FALSE(images_of(mesh, {looking_down(0), looking_down(0.16)}).locates(0));
  const ImageSet apart = images_of(mesh, {looking_down(0.1), looking_down(0), looking_down(-0.09)});
  EXPECT_TRUE(apart.locates(0));
  EXPECT_TRUE(apart.predict(0).located());
}

TEST(SurfacePrediction, WhatLimitsAnImage) {
  const TriangleMesh mesh = triangle_at_origin(Vector3d::UnitZ());
  const auto shown = [&](const Pose& camera, double range = 60, double incidence_deg = 75) {
    return images_of(mesh, {camera}, {kPinhole, range, radians(incidence_deg), 0.5}).shows(0, 0);
  };
  EXPECT_TRUE(shown(looking_down(0)));
  EXPECT_FALSE(shown(looking_down(0), 9.9));
  EXPECT_TRUE(shown(looking_down(0), 10.1));
  EXPECT_FALSE(shown(camera_pose({0, 0, kHeight}, 0, radians(80))));  // looks away
  // The image is 600 by 450 pixels: at 10 m it shows 5.625 m ahead and 7.5 m to the sides.
  EXPECT_TRUE(shown(looking_down(5.5)));
  EXPECT_FALSE(shown(looking_down(5.7)));
  EXPECT_TRUE(shown(looking_down(0, 7.4)));
  EXPECT_FALSE(shown(looking_down(0, 7.6)));
  const Pose flat = looking_at_origin(Vector3d(10 * std::tan(radians(70)), 0, 10));
  EXPECT_TRUE(shown(flat, 60, 71));
  EXPECT_FALSE(shown(flat, 60, 69));
  // A roof half way up hides it.
  MeshBuilder builder;
  builder.box({-1, -1, 4}, {1, 1, 5});
  TriangleMesh roofed = builder.take();
  const auto first = static_cast<std::int32_t>(roofed.vertices.size());
  for (const Vector3d& v : mesh.vertices) roofed.vertices.push_back(v);
  roofed.triangles.push_back({first, first + 1, first + 2});
  roofed.colors.clear();
  const std::size_t place = roofed.triangles.size() - 1;
  EXPECT_FALSE(images_of(roofed, {looking_down(0)}).shows(0, place));
  EXPECT_TRUE(images_of(roofed, {looking_at_origin({8, 0, 6})}).shows(0, place));
  EXPECT_THROW(images_of(mesh, {}, {kPinhole, 0, 1, 0.5}), InputError);
  EXPECT_THROW(images_of(mesh, {}, {kPinhole, 60, 1, 0}), InputError);
  EXPECT_THROW(images_of(mesh, {}, {{}, 60, 1, 0.5}), InputError);
}

// A floor of 1 m squares from (0, 0), each of two triangles.
TriangleMesh floor_of(int across, int down) {
  TriangleMesh mesh;
  for (int y = 0; y <= down; ++y)
    for (int x = 0; x <= across; ++x) mesh.vertices.emplace_back(x, y, 0);
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x) {
      const int a = y * (across + 1) + x, b = a + across + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({a + 1, b + 1, b});
    }
  return mesh;
}

TEST(SurfacePrediction, HolesAreNamedWithTheirReasons) {
  // 60 m long. Images show 15 m across around x = 10; candidates also around x = 30; the rest
  // nobody sees. A camera that looks down shows 7.5 m along its image's x, which is -y here.
  const auto surface = std::make_shared<MeshScene>(floor_of(60, 4));
  const auto along_x = [](double x, double y) {
    return camera_pose({x, y, kHeight}, radians(90), radians(-90));
  };
  const ImagingSettings settings{kPinhole, 60, radians(75), 0.5};
  const ImageSet chosen(surface, {along_x(10, 1), along_x(10, 3)}, settings);
  const ImageSet all(surface, {along_x(10, 1), along_x(10, 3), along_x(30, 1), along_x(30, 3)},
                     settings);
  std::vector<char> counted(surface->mesh().triangles.size(), 1);
  const auto told = predict_surface(chosen, counted, 2);
  const auto holes = holes_of(*surface, counted, told, all, nullptr, 2);
  ASSERT_EQ(holes.size(), 4u);  // left of the images, between, the candidates' own, and the rest
  EXPECT_EQ(holes[0].reason, HoleReason::no_view);
  EXPECT_NEAR(holes[0].area, 4 * 22.5, 4);
  EXPECT_NEAR(holes[0].place.x(), 48.75, 1);
  EXPECT_EQ(holes[1].reason, HoleReason::not_chosen);
  EXPECT_NEAR(holes[1].area, 4 * 15, 4);
  EXPECT_NEAR(holes[1].place.x(), 30, 1);
  EXPECT_EQ(holes[2].reason, HoleReason::no_view);
  EXPECT_NEAR(holes[2].area + holes[3].area, 4 * (5 + 2.5), 4);
  // Forbidden views around x = 50 would locate a part of the rest.
  const ImageSet open(surface,
                      {along_x(10, 1), along_x(10, 3), along_x(30, 1), along_x(30, 3),
                       along_x(50, 1), along_x(50, 3)},
                      settings);
  const auto ruled = holes_of(*surface, counted, told, all, &open, 1);
  double zone = 0, unseen = 0;
  for (const SurfaceHole& hole : ruled) {
    zone += hole.reason == HoleReason::zone ? hole.area : 0;
    unseen += hole.reason == HoleReason::no_view ? hole.area : 0;
  }
  EXPECT_NEAR(zone, 4 * 15, 4);
  EXPECT_NEAR(unseen, 4 * (30 - 15), 4);
  // What is not counted is no hole.
  for (std::size_t t = 0; t < counted.size(); ++t) counted[t] = t % 120 < 60;  // x below 30
  const auto fewer = predict_surface(chosen, counted, 1);
  EXPECT_EQ(holes_of(*surface, counted, fewer, all, nullptr, 1).size(), 3u);
  EXPECT_NEAR(quantile_by_area(surface->mesh(), told, &TrianglePrediction::pixel_size, 0.5),
              kHeight / 400, 0.2 * kHeight / 400);
  EXPECT_TRUE(std::isnan(quantile_by_area(
      surface->mesh(), predict_surface(ImageSet(surface, {}, settings), counted, 1),
      &TrianglePrediction::accuracy, 0.5)));
}

TEST(SurfacePrediction, IsTheSameForAnyNumberOfThreads) {
  const auto surface = std::make_shared<MeshScene>(floor_of(40, 10));
  Random random(3);
  std::vector<Pose> cameras;
  for (int k = 0; k < 20; ++k)
    cameras.push_back(camera_pose({random.uniform(0, 40), random.uniform(0, 10), 8},
                                  random.uniform(-3, 3), radians(-60)));
  const ImageSet images(surface, cameras, {kPinhole, 60, radians(75), 0.5});
  const std::vector<char> counted(surface->mesh().triangles.size(), 1);
  const auto one = predict_surface(images, counted, 1), two = predict_surface(images, counted, 2);
  for (std::size_t t = 0; t < one.size(); ++t) {
    EXPECT_EQ(one[t].images, two[t].images);
    EXPECT_EQ(one[t].accuracy, two[t].accuracy);
  }
}

}  // namespace
}  // namespace lapwing
