// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/mesh_doubts.h"

#include <cmath>
#include <cstdio>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kFarthest = 1e5;    // m, as check_mesh has it
constexpr double kFar = 5000;        // m
constexpr double kTimesItsSize = 5;  // that what is far is away
constexpr double kTall = 250;        // m
constexpr double kTallShare = 0.25;  // of the width
constexpr double kWallShare = 0.2;   // of the area
constexpr double kSteep = 0.1;       // of a wall's normal, upwards
constexpr double kSmall = 0.3;       // m
constexpr double kBuilding = 60;     // m; few are taller
constexpr double kSinglePrecision = 0x1p-24;

template <class... Numbers>
std::string text_of(const char* format, Numbers... numbers) {
  char text[400];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

Eigen::AlignedBox3d finite_bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices)
    if (v.allFinite()) box.extend(v);
  return box;
}

std::string corners(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d &a = box.min(), &b = box.max();
  return text_of("(%.9g, %.9g, %.9g) and (%.9g, %.9g, %.9g) m", a.x(), a.y(), a.z(), b.x(), b.y(),
                 b.z());
}

bool unit_stated(const MeshFile& file) {
  return file.unit_from == StatedBy::file || file.unit_from == StatedBy::caller;
}

std::string of_a_grid(const Eigen::AlignedBox3d& box) {
  const double error = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  return text_of(
      "such coordinates are those of a map grid (such as UTM), and single precision "
      "resolves them to %.2g m. Subtract a corner from all of them in the program that wrote "
      "the file, so that the place lies at the origin",
      2 * kSinglePrecision * error);
}

// "if the file is in centimetres (7 m), state its unit ..."
std::string other_unit(const MeshFile& file, double metres) {
  const bool centimetres = metres / 100 < kBuilding;
  const double factor = centimetres ? 0.01 : 0.001;
  return text_of(
      "if it is in %s (%.3g m then), state its unit (unit = %g), or convert it to "
      "metres",
      centimetres ? "centimetres" : "millimetres", metres * factor, file.unit * factor);
}

double wall_share(const TriangleMesh& mesh) {
  double walls = 0, all = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double area = mesh.area(t);
    all += area;
    if (std::abs(mesh.normal(t).z()) < kSteep) walls += area;
  }
  return all > 0 ? walls / all : 0;
}

bool far_for_its_size(const Eigen::AlignedBox3d& box) {
  return box.center().norm() > kTimesItsSize * box.diagonal().norm();
}

}  // namespace

void require_near(const MeshFile& file, const std::string& name) {
  const Eigen::AlignedBox3d box = finite_bounds(file.mesh);
  if (box.isEmpty()) return;
  if (box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff() <= kFarthest) return;
  std::string what =
      name + ": it lies between " + corners(box) + ", and coordinates up to 1e5 m are possible: ";
  if (far_for_its_size(box)) throw InputError(what + of_a_grid(box));
  throw InputError(what + text_of("one unit of the file is read as %g m; ", file.unit) +
                   other_unit(file, box.sizes().z()));
}

std::string doubt_of(const MeshFile& file) {
  const Eigen::AlignedBox3d box = file.mesh.bounds();
  const Eigen::Vector3d size = box.sizes();
  if (box.center().norm() > kFar && far_for_its_size(box))
    return "it lies between " + corners(box) + ": " + of_a_grid(box);
  if (unit_stated(file)) return "";
  if (size.maxCoeff() < kSmall)
    return text_of(
        "it is %.2g m large: if one unit of the file is not a metre, state its unit (unit = "
        "..., in m)",
        size.maxCoeff());
  const double width = std::max(size.x(), size.y());
  if (size.z() > kTall && size.z() >= kTallShare * width && wall_share(file.mesh) >= kWallShare)
    return text_of("its walls stand %.4g m tall on %.4g x %.4g m: ", size.z(), size.x(), size.y()) +
           other_unit(file, size.z());
  return "";
}

}  // namespace lapwing
