// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/tour_solvers/terrain_scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/core/random.h"

namespace lapwing {
namespace {

struct Vector {
  double x = 0, y = 0, z = 0;
};
Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
double dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double length(const Vector& a) {
  return std::sqrt(dot(a, a));
}

struct Voxel {
  Vector position, normal;
};
struct View {
  Vector position, axis;
};

class Terrain {
 public:
  Terrain(Random& random, const TerrainOptions& options)
      : options_(options), cells_(static_cast<int>(options.size / options.voxel)) {
    heights_.assign(static_cast<std::size_t>(cells_) * cells_, 0);
    for (int b = 0; b < options.blocks; ++b) {
      const auto edge = [&] { return static_cast<int>(random.uniform(0.08, 0.2) * cells_); };
      const int w = edge(), d = edge();
      const int x = static_cast<int>(random.integer(0, cells_ - w));
      const int y = static_cast<int>(random.integer(0, cells_ - d));
      const double height = random.uniform(4, 15);
      for (int i = x; i < x + w; ++i) {
        for (int j = y; j < y + d; ++j) height_of(i, j) = std::max(height_of(i, j), height);
      }
    }
  }

  double height_at(double x, double y) const {
    const int i = static_cast<int>(std::floor(x / options_.voxel));
    const int j = static_cast<int>(std::floor(y / options_.voxel));
    return i < 0 || j < 0 || i >= cells_ || j >= cells_ ? 0 : heights_[i * cells_ + j];
  }

  // Roofs and ground, then walls, in the order of their cells.
  std::vector<Voxel> voxels() const {
    std::vector<Voxel> voxels;
    const double s = options_.voxel;
    for (int i = 0; i < cells_; ++i) {
      for (int j = 0; j < cells_; ++j) {
        const double h = heights_[i * cells_ + j], x = (i + 0.5) * s, y = (j + 0.5) * s;
        voxels.push_back({{x, y, h}, {0, 0, 1}});
        for (const auto& [dx, dy] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
          const double low = height_at(x + dx * s, y + dy * s);
          for (double z = low + s / 2; z < h; z += s) {
            voxels.push_back({{x + dx * s / 2, y + dy * s / 2, z}, {dx, dy, 0}});
          }
        }
      }
    }
    return voxels;
  }

  bool clear(const Vector& from, const Vector& voxel, const Vector& normal) const {
    const Vector to{voxel.x + 0.3 * normal.x, voxel.y + 0.3 * normal.y, voxel.z + 0.3 * normal.z};
    const int steps = static_cast<int>(length(to - from) / options_.voxel) + 1;
    for (int i = 1; i < steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const double x = from.x + t * (to.x - from.x), y = from.y + t * (to.y - from.y);
      if (from.z + t * (to.z - from.z) < height_at(x, y)) return false;
    }
    return true;
  }

 private:
  double& height_of(int i, int j) { return heights_[i * cells_ + j]; }
  TerrainOptions options_;
  int cells_;
  std::vector<double> heights_;
};

// (4.7) with a focal length of 345 px and three perfect views to a voxel.
double contribution(const View& view, const Voxel& voxel, double edge) {
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  const Vector ray = view.position - voxel.position;
  const double distance = length(ray);
  if (distance > 40 || -dot(ray, view.axis) < 0.75 * distance) return 0;
  const double facing = dot(ray, voxel.normal) / distance;
  if (facing <= 0) return 0;
  const double incidence = std::acos(std::min(1.0, facing)) * kDegrees;
  const double pixels = 345 * 0.2 * edge / distance;
  return std::exp(-std::max(incidence - 25, 0.0) / 25) * std::exp(-std::max(6 - pixels, 0.0) / 3) /
         3;
}

std::vector<View> random_views(Random& random, const Terrain& terrain,
                               const TerrainOptions& options) {
  std::vector<View> views;
  while (static_cast<int>(views.size()) < options.views) {
    View view;
    view.position = {random.uniform(-5, options.size + 5), random.uniform(-5, options.size + 5),
                     random.uniform(2, 25)};
    if (view.position.z < terrain.height_at(view.position.x, view.position.y) + 2) continue;
    const double yaw = random.uniform(0, 6.283185307179586), pitch = random.uniform(-1.5, 0);
    view.axis = {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
    views.push_back(view);
  }
  return views;
}

std::vector<TourMotion> motions_between(const std::vector<View>& views, int neighbours) {
  std::vector<TourMotion> motions;
  for (int a = 0; a < static_cast<int>(views.size()); ++a) {
    std::vector<std::pair<double, int>> near;
    for (int b = 0; b < static_cast<int>(views.size()); ++b) {
      if (b != a) near.push_back({length(views[a].position - views[b].position), b});
    }
    std::partial_sort(near.begin(), near.begin() + neighbours, near.end());
    for (int i = 0; i < neighbours; ++i) motions.push_back({a, near[i].second, near[i].first / 3});
  }
  return motions;
}

}  // namespace

TourDefinition terrain_tour(std::uint64_t seed, const TerrainOptions& options) {
  Random random(seed);
  const Terrain terrain(random, options);
  const std::vector<Voxel> voxels = terrain.voxels();
  const std::vector<View> views = random_views(random, terrain, options);
  ViewScoreBuilder builder(voxels.size());
  std::vector<ViewScore::Contribution> seen;
  for (const View& view : views) {
    seen.clear();
    for (std::size_t v = 0; v < voxels.size(); ++v) {
      const double amount = contribution(view, voxels[v], options.voxel);
      if (amount <= 0 || !terrain.clear(view.position, voxels[v].position, voxels[v].normal)) {
        continue;
      }
      seen.push_back({static_cast<std::uint32_t>(v), static_cast<float>(amount)});
    }
    builder.add_view(seen);
  }
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(std::move(builder).take());
  d.view_seconds = {3};
  d.motions = motions_between(views, options.neighbours);
  d.budget = options.budget;
  return d;
}

}  // namespace lapwing
