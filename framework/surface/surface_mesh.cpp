// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/surface_mesh.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/surface/local_field.h"
#include "framework/surface/poisson_field.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kMostCells = 2e7;

// Corners are numbered along x, then y, then z of a box of (count + 1)^3.
class Grid {
 public:
  Grid(const Eigen::AlignedBox3d& box, double cell) : lower_(box.min()), cell_(cell) {
    for (int i = 0; i < 3; ++i) {
      counts_[i] = static_cast<std::int64_t>(std::ceil(box.sizes()[i] / cell)) + 2;
    }
  }
  Vector3i cell_of(const Vector3d& p) const {
    return ((p - lower_) / cell_).array().floor().cast<int>();
  }
  bool holds(const Vector3i& c) const {
    return c.minCoeff() >= 0 && c.x() + 1 < counts_[0] && c.y() + 1 < counts_[1] &&
           c.z() + 1 < counts_[2];
  }
  std::int64_t number(const Vector3i& c) const {
    return (c.z() * counts_[1] + c.y()) * counts_[0] + c.x();
  }
  Vector3i place(std::int64_t number) const {
    return {static_cast<int>(number % counts_[0]),
            static_cast<int>(number / counts_[0] % counts_[1]),
            static_cast<int>(number / counts_[0] / counts_[1])};
  }
  Vector3d corner(std::int64_t number) const {
    return lower_ + cell_ * place(number).cast<double>();
  }

 private:
  Vector3d lower_;
  double cell_;
  std::int64_t counts_[3];
};

// Cells that come within `trim` of a point, in order.
std::vector<std::int64_t> cells_near(const std::vector<FusedPoint>& points, const Grid& grid,
                                     const SurfaceOptions& options) {
  const int reach = static_cast<int>(std::ceil(options.trim / options.cell));
  std::vector<std::int64_t> cells;
  for (const FusedPoint& point : points) {
    const Vector3i middle = grid.cell_of(point.position);
    for (int z = -reach; z <= reach; ++z) {
      for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
          const Vector3i c = middle + Vector3i(x, y, z);
          if (!grid.holds(c)) continue;
          const Vector3d center =
              grid.corner(grid.number(c)) + Vector3d::Constant(options.cell / 2);
          if ((center - point.position).norm() <= options.trim) cells.push_back(grid.number(c));
        }
      }
    }
    if (cells.size() > 4 * static_cast<std::size_t>(kMostCells)) {
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
      if (static_cast<double>(cells.size()) > kMostCells) {
        throw InputError("surface from points: more than 20 million cells; choose larger cells");
      }
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

// The values of a field at the corners of cells.
struct CornerValues {
  std::vector<std::int64_t> corners;  // in order
  std::vector<double> values;

  double at(std::int64_t corner) const {
    const auto found = std::lower_bound(corners.begin(), corners.end(), corner);
    return values[static_cast<std::size_t>(found - corners.begin())];
  }
};

// Cuts cells into six tetrahedra each and those into triangles: no case is ambiguous.
class Cutter {
 public:
  Cutter(const Grid& grid, const CornerValues& field) : grid_(grid), field_(field) {}

  void cut(std::int64_t cell) {
    // Around the diagonal from corner 0 to corner 7; the bits of a number are x, y, z.
    static constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    const Vector3i base = grid_.place(cell);
    std::int64_t corners[8];
    double values[8];
    bool behind = false, before = false;
    for (int k = 0; k < 8; ++k) {
      corners[k] = grid_.number(base + Vector3i(k & 1, k >> 1 & 1, k >> 2));
      values[k] = field_.at(corners[k]);
      (values[k] < 0 ? behind : before) = true;
    }
    if (!behind || !before) return;
    for (const auto& t : kTetrahedra) {
      Corner four[4];
      for (int i = 0; i < 4; ++i) four[i] = {corners[t[i]], values[t[i]]};
      tetrahedron(four);
    }
  }

  TriangleMesh take() { return std::move(mesh_); }

 private:
  struct Corner {
    std::int64_t number;
    double value;
  };

  std::int32_t crossing(Corner a, Corner b) {
    if (a.number > b.number) std::swap(a, b);
    const auto [it, fresh] = crossings_.emplace(std::pair{a.number, b.number},
                                                static_cast<std::int32_t>(mesh_.vertices.size()));
    if (fresh)
      mesh_.vertices.push_back(grid_.corner(a.number) +
                               a.value / (a.value - b.value) *
                                   (grid_.corner(b.number) - grid_.corner(a.number)));
    return it->second;
  }

  // Outwards is from the corners behind the surface to those before it.
  void triangle(std::int32_t a, std::int32_t b, std::int32_t c, const Vector3d& outwards) {
    const Vector3d& p = mesh_.vertices[static_cast<std::size_t>(a)];
    const Vector3d normal = (mesh_.vertices[static_cast<std::size_t>(b)] - p)
                                .cross(mesh_.vertices[static_cast<std::size_t>(c)] - p);
    if (normal.dot(outwards) < 0) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
  }

  void tetrahedron(const Corner (&corner)[4]) {
    Corner behind[4], before[4];
    int n = 0, m = 0;
    Vector3d outwards = Vector3d::Zero();
    for (const Corner& c : corner) {
      if (c.value < 0)
        behind[n++] = c;
      else
        before[m++] = c;
    }
    if (n == 0 || m == 0) return;
    for (int i = 0; i < m; ++i) outwards += grid_.corner(before[i].number) / m;
    for (int i = 0; i < n; ++i) outwards -= grid_.corner(behind[i].number) / n;
    if (n == 2) {
      const std::int32_t a = crossing(behind[0], before[0]), b = crossing(behind[0], before[1]);
      const std::int32_t c = crossing(behind[1], before[1]), d = crossing(behind[1], before[0]);
      triangle(a, b, c, outwards);
      triangle(a, c, d, outwards);
      return;
    }
    const Corner& tip = n == 1 ? behind[0] : before[0];
    const Corner* others = n == 1 ? before : behind;
    triangle(crossing(tip, others[0]), crossing(tip, others[1]), crossing(tip, others[2]),
             outwards);
  }

  struct PairHash {
    std::size_t operator()(const std::pair<std::int64_t, std::int64_t>& edge) const {
      const auto mixed = static_cast<std::uint64_t>(edge.first) * 0x9e3779b97f4a7c15ULL ^
                         static_cast<std::uint64_t>(edge.second) * 0xbf58476d1ce4e5b9ULL;
      return static_cast<std::size_t>(mixed ^ mixed >> 31);
    }
  };

  const Grid& grid_;
  const CornerValues& field_;
  std::unordered_map<std::pair<std::int64_t, std::int64_t>, std::int32_t, PairHash> crossings_;
  TriangleMesh mesh_;
};

void check(const std::vector<FusedPoint>& points, const SurfaceOptions& options) {
  if (!(options.cell > 0 && options.trim > 0 && std::isfinite(options.cell) &&
        std::isfinite(options.trim))) {
    throw InputError("surface from points: cell and trim must be above 0 m");
  }
  if (options.trim > 20 * options.cell) {
    throw InputError("surface from points: trim must be at most 20 cells");
  }
  if (points.size() < 10) {
    throw InputError("surface from points: " + std::to_string(points.size()) +
                     " points are too few; at least 10 are needed");
  }
  for (const FusedPoint& p : points) {
    if (!p.position.allFinite() || !p.normal.allFinite() || !(p.normal.norm() > 0.5)) {
      throw InputError("surface from points: a point or its normal is not finite, or no normal");
    }
  }
}

// Whether the points keep clear of every plane, by more than rounding.
bool span_a_volume(const std::vector<FusedPoint>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const FusedPoint& p : points) mean += p.position / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const FusedPoint& p : points) {
    const Vector3d d = p.position - mean;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) spread(i, k) += d[i] * d[k];
  }
  const Eigen::Vector3d extents =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();  // in rising order
  return extents[0] > 1e-12 * extents[2] && extents[2] > 0;
}

std::vector<PoissonField::Sample> samples_of(const std::vector<FusedPoint>& points) {
  std::vector<PoissonField::Sample> samples;
  for (const FusedPoint& p : points) {
    samples.push_back({{p.position.x(), p.position.y(), p.position.z()},
                       {p.normal.x(), p.normal.y(), p.normal.z()}});
  }
  return samples;
}

// The corners of cells, each once.
std::vector<std::int64_t> corners_of(const std::vector<std::int64_t>& cells, const Grid& grid) {
  std::vector<std::int64_t> corners;
  // Layer by layer, so that few are held twice.
  const std::int64_t layer = grid.number({0, 0, 1});
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Vector3i base = grid.place(cells[i]);
    for (int k = 0; k < 8; ++k)
      corners.push_back(grid.number(base + Vector3i(k & 1, k >> 1 & 1, k >> 2)));
    if (i + 1 < cells.size() && cells[i + 1] / layer == cells[i] / layer) continue;
    std::sort(corners.begin() + static_cast<std::ptrdiff_t>(kept), corners.end());
    corners.erase(std::unique(corners.begin() + static_cast<std::ptrdiff_t>(kept), corners.end()),
                  corners.end());
    // Of the next layer's corners some may be there already.
    const std::int64_t above = cells[i] / layer * layer + layer;
    kept = static_cast<std::size_t>(std::lower_bound(corners.begin(), corners.end(), above) -
                                    corners.begin());
  }
  corners.shrink_to_fit();
  return corners;
}

double off_zero(double value) {
  return value == 0 ? 1e-300 : value;  // no corner lies on the surface
}

CornerValues field_at_corners(const std::vector<FusedPoint>& points,
                              const std::vector<std::int64_t>& cells, const Grid& grid,
                              const SurfaceOptions& options,
                              const CancellationToken* cancellation) {
  constexpr std::size_t kAtOnce = 4096;
  constexpr double kReach = 3;  // cells; exp(-9) of the weight is left
  CornerValues field{corners_of(cells, grid), {}};
  field.values.resize(field.corners.size());
  if (options.method == SurfaceMethod::poisson) {
    const PoissonField poisson(samples_of(points));
    for (std::size_t i = 0; i < field.corners.size(); ++i) {
      const Vector3d p = grid.corner(field.corners[i]);
      field.values[i] = off_zero(poisson.value(p.x(), p.y(), p.z()));
    }
    return field;
  }
  const LocalField local(points, options.cell,
                         std::max(kReach * options.cell, options.trim + 2 * options.cell));
  parallel_for((field.corners.size() + kAtOnce - 1) / kAtOnce, options.threads,
               [&](std::size_t part) {
                 if (cancellation && cancellation->cancelled()) return;
                 const std::size_t end = std::min(field.corners.size(), (part + 1) * kAtOnce);
                 for (std::size_t i = part * kAtOnce; i < end; ++i)
                   field.values[i] = off_zero(local.value(grid.corner(field.corners[i])));
               });
  if (cancellation && cancellation->cancelled()) throw Cancelled();
  return field;
}

}  // namespace

TriangleMesh surface_from_points(const std::vector<FusedPoint>& points,
                                 const SurfaceOptions& options,
                                 const CancellationToken* cancellation) {
  check(points, options);
  if (!span_a_volume(points)) {
    throw InputError("surface from points: all points lie nearly in one plane");
  }
  Eigen::AlignedBox3d box;
  for (const FusedPoint& p : points) box.extend(p.position);
  const Vector3d room = Vector3d::Constant(options.trim + options.cell);
  box.extend(box.min() - room);
  box.extend(box.max() + room);
  const Grid grid(box, options.cell);
  const std::vector<std::int64_t> cells = cells_near(points, grid, options);
  const CornerValues field = field_at_corners(points, cells, grid, options, cancellation);
  Cutter cutter(grid, field);
  for (const std::int64_t cell : cells) cutter.cut(cell);
  TriangleMesh mesh = cutter.take();
  weld(mesh, 0);
  if (mesh.triangles.empty()) {
    throw InputError(
        "surface from points: there is no surface near the points; they may be too "
        "far apart for cells of " +
        std::to_string(options.cell) + " m");
  }
  return mesh;
}

}  // namespace lapwing
