// SPDX-License-Identifier: Apache-2.0
#include "framework/export/scene_report.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "framework/core/png.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kWidth = 960, kHeight = 600;
constexpr double kViewAcross = 0.9;  // rad
constexpr double kRoof = 1.2;        // m above the floor, where indoor views cut
constexpr double kLookDown = 0.55;   // rad, of the views from the corners
constexpr Rgb kSky = {196, 214, 232}, kPlain = {188, 186, 182};

std::string extent_text(const Eigen::AlignedBox3d& box) {
  const Vector3d size = box.sizes();
  char text[96];
  std::snprintf(text, sizeof text, "%.4g m by %.4g m by %.4g m", size.x(), size.y(), size.z());
  return text;
}

// From far enough that all of the box is in the image.
Pose view_of(const Eigen::AlignedBox3d& box, double yaw, double pitch) {
  const double radius = box.diagonal().norm() / 2;
  const double half = std::atan(std::tan(kViewAcross / 2) * kHeight / kWidth);
  const Vector3d forward(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw),
                         std::sin(pitch));
  return camera_pose(box.center() - 0.8 * radius / std::sin(half) * forward, yaw, pitch);
}

// Without the triangles that lie above a height: a look under the roof.
MeshScene opened(const TriangleMesh& mesh, double height) {
  TriangleMesh low = mesh;
  low.triangles.clear();
  low.colors.clear();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const double bottom =
        std::min({mesh.corner(i, 0).z(), mesh.corner(i, 1).z(), mesh.corner(i, 2).z()});
    if (bottom > height) continue;
    low.triangles.push_back(mesh.triangles[i]);
    if (!mesh.colors.empty()) low.colors.push_back(mesh.colors[i]);
  }
  return MeshScene(std::move(low));
}

}  // namespace

Picture surface_picture(const MeshScene& scene, const Pose& pose, const Pinhole& pinhole,
                        int threads) {
  const Vector3d sun = Vector3d(-0.4, -0.6, 0.9).normalized();
  const MeshView view = render_view(scene, pose, pinhole, 1e6, threads);
  const TriangleMesh& mesh = scene.mesh();
  Picture picture{pinhole.width, pinhole.height, {}};
  picture.rgb.reserve(view.triangles.size() * 3);
  for (std::size_t i = 0; i < view.triangles.size(); ++i) {
    const int triangle = view.triangles[i];
    if (triangle < 0) {
      picture.rgb.insert(picture.rgb.end(), kSky.begin(), kSky.end());
      continue;
    }
    const Rgb& color =
        mesh.colors.empty() ? kPlain : mesh.colors[static_cast<std::size_t>(triangle)];
    const Vector3d normal = view.normals[i].cast<double>();
    const double light = 0.45 + 0.2 * normal.z() + 0.45 * std::max(0.0, normal.dot(sun));
    for (const std::uint8_t channel : color)
      picture.rgb.push_back(static_cast<std::uint8_t>(std::clamp(channel * light, 0.0, 255.0)));
  }
  return picture;
}

Report scene_report(const MeshScene& scene, const SceneReport& given) {
  const TriangleMesh& mesh = scene.mesh();
  const Eigen::AlignedBox3d bounds = mesh.bounds();
  double area = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) area += mesh.area(i);
  Report report;
  report.title = given.title;
  report.subtitle = "a scene of " + std::to_string(mesh.triangles.size()) + " triangles";
  Facts facts;
  const auto add = [&](std::string label, std::string value, std::string unit = "") {
    facts.facts.push_back({std::move(label), std::move(value), std::move(unit)});
  };
  if (!given.origin.empty()) add("made from", given.origin);
  add("triangles", std::to_string(mesh.triangles.size()));
  add("vertices", std::to_string(mesh.vertices.size()));
  add("surface", number_text(area), "m\u00b2");
  add("extent", extent_text(bounds));
  if (!given.region.isEmpty()) add("region of interest", extent_text(given.region));
  report.sections.push_back({"Summary", {facts}});

  const Eigen::AlignedBox3d shown = given.region.isEmpty() ? bounds : given.region;
  const Vector3d middle = shown.center();
  const double half = shown.sizes().z() / 2;
  const bool indoors =
      !given.region.isEmpty() && 2 * half > kRoof &&
      scene.blocked({.origin = middle, .direction = {0, 0, 1}, .farthest = 3 * half});
  const double cut = shown.min().z() + kRoof;
  std::optional<MeshScene> below;
  if (indoors) below = opened(mesh, cut);
  const MeshScene& seen = below ? *below : scene;
  const std::string without =
      indoors ? "; parts that begin above " + number_text(cut) + " m are left out" : "";
  Section views{"Views", {}};
  const char* sides[] = {"south-west", "south-east", "north-east", "north-west"};
  for (int k = 0; k < 4; ++k) {
    const double yaw = EIGEN_PI / 4 + k * EIGEN_PI / 2;
    const Picture picture =
        surface_picture(seen, view_of(shown, yaw, -kLookDown),
                        centered_pinhole(kWidth, kHeight, kViewAcross), given.threads);
    views.blocks.push_back(
        Image{encode_png(picture), std::string("From the ") + sides[k] + without});
  }
  const Picture above =
      surface_picture(seen, view_of(shown, EIGEN_PI / 2, -EIGEN_PI / 2 + 1e-6),
                      centered_pinhole(kWidth, kHeight, kViewAcross), given.threads);
  views.blocks.push_back(Image{encode_png(above), "From above, north is up" + without});
  report.sections.push_back(std::move(views));
  return report;
}

}  // namespace lapwing
