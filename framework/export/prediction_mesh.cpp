// SPDX-License-Identifier: Apache-2.0
#include "framework/export/prediction_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <set>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/export/gltf_document.h"
#include "framework/export/scan_colors.h"

namespace lapwing {
namespace {

constexpr double kBest = 0.02, kWorst = 0.98;  // shares of the area, ends of the colours

void append_bytes(std::string& bytes, const auto& number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

// -1 outside the region.
std::int32_t images_shown(const ScanPrediction& p, std::size_t t) {
  return p.counted[t] ? p.triangles[t].images : -1;
}

// incidence, deg; mm a pixel; parallax, deg; accuracy, mm. -1 where there is none.
std::array<float, 4> figures_of(const TrianglePrediction& told) {
  const auto figure = [](bool known, double value) {
    return static_cast<float>(known && std::isfinite(value) ? value : -1);
  };
  const bool one = told.images >= 1, two = told.images >= 2;
  return {figure(one, degrees(told.incidence)), figure(one, 1000.0 * told.pixel_size),
          figure(two, degrees(told.parallax)), figure(two, 1000.0 * told.accuracy)};
}

// Which corners fall into one, and of the triangles that keep three different ones the first of
// each kind.
struct Coarse {
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::array<std::uint16_t, 3>> triangles;
  std::vector<std::size_t> of;  // the surface's
};

std::optional<Coarse> coarse_within(const TriangleMesh& mesh, double edge, std::size_t most) {
  constexpr std::size_t kMostCorners = 65535;
  const Eigen::Vector3d lower = mesh.bounds().min();
  std::map<std::array<std::int64_t, 3>, std::uint16_t> cells;
  std::vector<std::uint16_t> corner_of(mesh.vertices.size());
  std::vector<Eigen::Vector3d> sums;
  std::vector<double> counts;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d at = (mesh.vertices[v] - lower) / edge;
    const std::array<std::int64_t, 3> cell{static_cast<std::int64_t>(at.x()),
                                           static_cast<std::int64_t>(at.y()),
                                           static_cast<std::int64_t>(at.z())};
    const auto [found, fresh] = cells.try_emplace(cell, static_cast<std::uint16_t>(sums.size()));
    if (fresh) {
      if (sums.size() == kMostCorners) return std::nullopt;
      sums.emplace_back(Eigen::Vector3d::Zero());
      counts.push_back(0);
    }
    corner_of[v] = found->second;
    sums[found->second] += mesh.vertices[v];
    counts[found->second] += 1;
  }
  Coarse coarse;
  std::set<std::array<std::uint16_t, 3>> kinds;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<std::uint16_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = corner_of[static_cast<std::size_t>(mesh.triangles[t][k])];
    std::array<std::uint16_t, 3> kind = corners;
    std::sort(kind.begin(), kind.end());
    if (kind[0] == kind[1] || kind[1] == kind[2] || !kinds.insert(kind).second) continue;
    if (coarse.triangles.size() == most) return std::nullopt;
    coarse.triangles.push_back(corners);
    coarse.of.push_back(t);
  }
  for (std::size_t k = 0; k < sums.size(); ++k) coarse.corners.push_back(sums[k] / counts[k]);
  return coarse;
}

Coarse coarse_of(const TriangleMesh& mesh, std::size_t most) {
  constexpr double kCoarser = 1.2;
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area += mesh.area(t);
  const double extent = mesh.bounds().sizes().maxCoeff();
  // Two triangles a cell, if the surface were flat.
  double edge = std::max(std::sqrt(area / static_cast<double>(most)), 1e-6 * extent);
  for (;; edge *= kCoarser)
    if (std::optional<Coarse> coarse = coarse_within(mesh, edge, most)) return std::move(*coarse);
}

}  // namespace

double area_quantile(const ScanPrediction& p, float TrianglePrediction::*value, double share) {
  return quantile_by_area(p.surface->mesh(), p.triangles, value, share);
}

PredictionColors prediction_colors(const ScanPrediction& p) {
  PredictionColors range{area_quantile(p, &TrianglePrediction::accuracy, kBest),
                         area_quantile(p, &TrianglePrediction::accuracy, kWorst)};
  if (!(range.best > 0) || !std::isfinite(range.best)) range.best = 1e-3;
  if (!std::isfinite(range.worst)) range.worst = 100 * range.best;
  range.worst = std::max(range.worst, 1.01 * range.best);
  return range;
}

std::vector<Rgb> triangle_colors(const ScanPrediction& p, const PredictionColors& range) {
  std::vector<Rgb> colors(p.triangles.size(), kPlainSurface);
  for (std::size_t t = 0; t < colors.size(); ++t) {
    if (!p.counted[t]) continue;
    const TrianglePrediction& told = p.triangles[t];
    colors[t] = told.images == 0 ? kNeverSeen : kNotSeen;
    if (told.located())
      colors[t] = color_of_share(1 - std::log(told.accuracy / range.best) /
                                         std::log(range.worst / range.best));
  }
  return colors;
}

std::string prediction_ply(const ScanPrediction& p) {
  const TriangleMesh& mesh = p.surface->mesh();
  const std::vector<Rgb> colors = triangle_colors(p, prediction_colors(p));
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment metres, z up\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) +
      "\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty int images\nproperty float incidence_deg\n"
      "property float mm_per_pixel\nproperty float parallax_deg\nproperty float accuracy_mm\n"
      "end_header\n";
  for (const Eigen::Vector3d& v : mesh.vertices)
    for (int i = 0; i < 3; ++i) append_bytes(bytes, static_cast<float>(v[i]));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    bytes.push_back(3);
    for (const std::int32_t index : mesh.triangles[t]) append_bytes(bytes, index);
    for (const std::uint8_t part : colors[t]) bytes.push_back(static_cast<char>(part));
    append_bytes(bytes, images_shown(p, t));
    for (const float figure : figures_of(p.triangles[t])) append_bytes(bytes, figure);
  }
  return bytes;
}

std::string coarse_prediction(const ScanPrediction& p, std::size_t most) {
  if (most < 1 || most > kMostCoarse)
    throw InputError("a coarse surface has 1 to " + std::to_string(kMostCoarse) +
                     " triangles, not " + std::to_string(most));
  const TriangleMesh& mesh = p.surface->mesh();
  const std::vector<Rgb> colors = triangle_colors(p, prediction_colors(p));
  const Coarse coarse = coarse_of(mesh, most);
  const Eigen::AlignedBox3d box = mesh.bounds();
  const Eigen::Vector3d size = box.sizes().cwiseMax(1e-9);
  std::string bytes = "WLP1";
  append_bytes(bytes, static_cast<std::uint32_t>(coarse.corners.size()));
  append_bytes(bytes, static_cast<std::uint32_t>(coarse.triangles.size()));
  for (const Eigen::Vector3d& v : {Eigen::Vector3d(box.min()), size})
    for (int i = 0; i < 3; ++i) append_bytes(bytes, static_cast<float>(v[i]));
  for (const Eigen::Vector3d& v : coarse.corners)
    for (int i = 0; i < 3; ++i)
      append_bytes(bytes, static_cast<std::uint16_t>(std::lround(
                              65535 * std::clamp((v[i] - box.min()[i]) / size[i], 0.0, 1.0))));
  for (std::size_t k = 0; k < coarse.triangles.size(); ++k) {
    const std::size_t t = coarse.of[k];
    for (const std::uint16_t corner : coarse.triangles[k]) append_bytes(bytes, corner);
    append_bytes(bytes, static_cast<std::int16_t>(images_shown(p, t)));
    for (const std::uint8_t part : colors[t]) bytes.push_back(static_cast<char>(part));
    bytes.push_back(0);
    for (const float figure : figures_of(p.triangles[t])) {
      std::string whole;
      append_bytes(whole, figure);
      bytes.append(whole, 1, 3);
    }
  }
  return bytes;
}

std::string prediction_glb(const ScanPrediction& p) {
  const TriangleMesh& mesh = p.surface->mesh();
  std::vector<GltfDocument::TriangleNumbers> numbers{{"_IMAGES", {}},
                                                     {"_INCIDENCE_DEG", {}},
                                                     {"_MM_PER_PIXEL", {}},
                                                     {"_PARALLAX_DEG", {}},
                                                     {"_ACCURACY_MM", {}}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    numbers[0].values.push_back(static_cast<float>(images_shown(p, t)));
    const std::array<float, 4> figures = figures_of(p.triangles[t]);
    for (std::size_t k = 0; k < figures.size(); ++k) numbers[k + 1].values.push_back(figures[k]);
  }
  GltfDocument document;
  Value node = Value::map();
  node.set("mesh",
           document.add_colored_triangles(mesh, triangle_colors(p, prediction_colors(p)), numbers));
  document.add_node("prediction", "", node);
  return document.binary("what the images will show");
}

}  // namespace lapwing
