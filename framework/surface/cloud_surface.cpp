// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/cloud_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/parallel.h"
#include "framework/surface/grid_table.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kAloneReach = 3, kLeastBeside = 3;  // cubes; others in them
constexpr int kPlaneReach = 2, kWiderReach = 3;   // cubes
constexpr std::size_t kLeastOfPlane = 6;          // points
constexpr int kSteps = 4;                         // cubes to each side, that are asked for the sky
constexpr int kSweeps = 20;                       // over those that follow their neighbours
constexpr double kMostAlone = 0.5;                // share of the cubes

struct CoarseCell {
  std::int32_t place = -1;  // in the list of points
};

struct ColumnTop {
  std::int32_t top = std::numeric_limits<std::int32_t>::min();  // cube
};

class SurfaceOfCloud {
 public:
  SurfaceOfCloud(const std::vector<ThinnedPoint>& thinned, const CloudSurfaceSettings& settings)
      : thinned_(thinned), settings_(settings) {
    if (thinned.size() < 10)
      throw InputError("a cloud of " + std::to_string(thinned.size()) +
                       (thinned.size() == 1 ? " point" : " points") +
                       " (thinned) shows no surface; at least 10 are needed");
    if (!(settings.spacing > 0)) throw InputError("the spacing of points must be above 0 m");
  }

  CloudSurface made() {
    gather();
    drop_alone();
    estimate();
    decide();
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (here_[i]) result_.points.push_back(points_[i]);
    return std::move(result_);
  }

 private:
  std::array<std::int64_t, 3> cube_of(const Vector3d& p) const {
    const Vector3d low = (p / settings_.spacing).array().floor();
    return {static_cast<std::int64_t>(low.x()), static_cast<std::int64_t>(low.y()),
            static_cast<std::int64_t>(low.z())};
  }

  // Means over cubes, in the order of their places.
  void gather() {
    std::vector<std::pair<GridKey, std::size_t>> order;
    order.reserve(thinned_.size());
    for (std::size_t i = 0; i < thinned_.size(); ++i) {
      const auto c = cube_of(thinned_[i].position);
      order.emplace_back(grid_key(c[0], c[1], c[2]), i);
    }
    std::sort(order.begin(), order.end());
    cube_.resize(thinned_.size());
    for (std::size_t k = 0; k < order.size();) {
      FusedPoint point;
      point.normal = Vector3d::Zero();
      point.images = 0;
      const GridKey key = order[k].first;
      for (; k < order.size() && order[k].first == key; ++k) {
        const ThinnedPoint& one = thinned_[order[k].second];
        point.position += one.position;
        point.normal += one.normal;
        ++point.images;
        cube_[order[k].second] = static_cast<std::int32_t>(points_.size());
      }
      point.position /= point.images;
      table_[key].place = static_cast<std::int32_t>(points_.size());
      keys_.push_back(key);
      points_.push_back(point);
    }
  }

  // Calls `visit` with the place of every other point within so many cubes, until it says stop.
  template <class Visit>
  void beside(std::size_t i, int reach, const Visit& visit) const {
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const CoarseCell* cell = table_.find(grid_key_beside(keys_[i], x, y, z));
          if (cell && !visit(static_cast<std::size_t>(cell->place))) return;
        }
  }

  void drop_alone() {
    here_.assign(points_.size(), 1);
    parallel_for(points_.size(), settings_.threads, [&](std::size_t i) {
      int count = 0;
      beside(i, kAloneReach, [&](std::size_t) { return ++count < kLeastBeside; });
      here_[i] = count >= kLeastBeside;
    });
    const auto alone = static_cast<double>(std::count(here_.begin(), here_.end(), 0));
    if (alone > kMostAlone * static_cast<double>(points_.size()))
      throw InputError("its points are too far apart: more than half of them have fewer than " +
                       std::to_string(kLeastBeside) + " others within " +
                       plain_number(kAloneReach * settings_.spacing) +
                       " m: choose a larger surface.spacing, resolution and surface.cell");
    result_.kept.resize(thinned_.size());
    for (std::size_t i = 0; i < thinned_.size(); ++i) {
      result_.kept[i] = here_[static_cast<std::size_t>(cube_[i])];
      result_.alone += !result_.kept[i];
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!here_[i]) continue;
      const auto c = cube_of(points_[i].position);
      ColumnTop& column = columns_[grid_key(c[0], c[1], 0)];
      column.top = std::max(column.top, static_cast<std::int32_t>(c[2]));
    }
  }

  Vector3d across_plane(std::size_t i) const {
    std::vector<Vector3d> near;
    for (const int reach : {kPlaneReach, kWiderReach}) {
      near.assign(1, points_[i].position);
      beside(i, reach, [&](std::size_t other) {
        if (here_[other]) near.push_back(points_[other].position);
        return true;
      });
      if (near.size() >= kLeastOfPlane) break;
    }
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& p : near) mean += p / static_cast<double>(near.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Vector3d& p : near) spread += (p - mean) * (p - mean).transpose();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  }

  // 1 for open sky, -1 beneath points, 0 where the column has none.
  int sky_at(const Vector3d& p) const {
    const auto c = cube_of(p);
    const ColumnTop* column = columns_.find(grid_key(c[0], c[1], 0));
    return !column ? 0 : c[2] > column->top ? 1 : -1;
  }

  // Above 0 where the normal's own side is the open one.
  double openness(const Vector3d& p, const Vector3d& normal) const {
    if (!settings_.scanners.empty()) {
      const auto nearest = std::min_element(settings_.scanners.begin(), settings_.scanners.end(),
                                            [&](const auto& a, const auto& b) {
                                              return (a - p).squaredNorm() < (b - p).squaredNorm();
                                            });
      return normal.dot((*nearest - p).normalized());
    }
    double sum = 0;
    for (int step = 1; step <= kSteps; ++step) {
      const Vector3d way = step * settings_.spacing * normal;
      sum += sky_at(p + way) - sky_at(p - way);
    }
    return sum;
  }

  void estimate() {
    of_file_.resize(points_.size());
    sure_.assign(points_.size(), 0);
    parallel_for(points_.size(), settings_.threads, [&](std::size_t i) {
      if (!here_[i]) return;
      Vector3d& normal = points_[i].normal;
      of_file_[i] =
          normal.norm() > 0.5 * points_[i].images ? normal.normalized().eval() : Vector3d::Zero();
      normal = of_file_[i].norm() > 0 ? of_file_[i] : across_plane(i);
      const double open = openness(points_[i].position, normal);
      if (open < 0) normal = -normal;
      sure_[i] = open != 0;
    });
  }

  // Sweep by sweep those beside sure ones become sure.
  void decide() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      std::vector<std::pair<std::size_t, double>> turns;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (!here_[i] || sure_[i]) continue;
        double sum = 0;
        beside(i, kPlaneReach, [&](std::size_t other) {
          if (sure_[other]) sum += points_[i].normal.dot(points_[other].normal);
          return true;
        });
        if (sum != 0) turns.emplace_back(i, sum);
      }
      if (turns.empty()) break;
      for (const auto& [i, sum] : turns) {
        if (sum < 0) points_[i].normal = -points_[i].normal;
        sure_[i] = 1;
      }
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      Vector3d& normal = points_[i].normal;
      if (here_[i] && !sure_[i] && of_file_[i].norm() == 0 && normal.z() < 0) normal = -normal;
    }
  }

  const std::vector<ThinnedPoint>& thinned_;
  const CloudSurfaceSettings& settings_;
  std::vector<std::int32_t> cube_;  // of each thinned point, its place in points_
  std::vector<FusedPoint> points_;
  std::vector<GridKey> keys_;
  std::vector<Vector3d> of_file_;          // normals, or zero
  std::vector<std::uint8_t> here_, sure_;  // of points: no noise; their side is known
  GridTable<CoarseCell> table_;
  GridTable<ColumnTop> columns_;
  CloudSurface result_;
};

}  // namespace

CloudSurface surface_of_cloud(const std::vector<ThinnedPoint>& thinned,
                              const CloudSurfaceSettings& settings) {
  return SurfaceOfCloud(thinned, settings).made();
}

}  // namespace lapwing
