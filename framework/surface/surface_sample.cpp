// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/surface/grid_points.h"

namespace lapwing {
namespace {

constexpr double kMostArea = 0.25;  // m^2, of a triangle that gives points (reading 4.7)
constexpr int kEdgeParts = 10;      // 100 points to a triangle: the middles of as many parts of it

}  // namespace

// Points in cubes of edge `near`, so that what is close lies in the same or in neighbouring ones.
struct SurfaceSample::Index {
  explicit Index(const ReconstructionSettings& s) : settings(s), cubes(cubes_of(s)) {}

  struct Sorted {
    GridPoints points;
    std::vector<GridKey> cubes;       // that hold any, ascending
    std::vector<std::int32_t> first;  // point of each, and one past the last point
  };

  Sorted sorted(const GridPoints& from) const {
    Sorted result;
    std::vector<std::pair<GridKey, std::int32_t>> order(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
      order[i] = {cubes.of(from[i].cast<double>()), static_cast<std::int32_t>(i)};
    }
    std::sort(order.begin(), order.end());
    result.points.reserve(from.size());
    for (const auto& [key, i] : order) {
      if (result.cubes.empty() || result.cubes.back() != key) {
        result.cubes.push_back(key);
        result.first.push_back(static_cast<std::int32_t>(result.points.size()));
      }
      result.points.push_back(from[static_cast<std::size_t>(i)]);
    }
    result.first.push_back(static_cast<std::int32_t>(result.points.size()));
    return result;
  }

  // Where among `to` points can be that are close to those of one cube. Three cubes above each
  // other follow each other there, so nine columns of three are looked at; asked for ascending
  // cubes each column goes through `to` once.
  class Columns {
   public:
    Columns(const Sorted& to, GridKey first_cube) : to_(to) {
      for (std::size_t k = 0; k < kColumns; ++k) {
        const auto begin = to.cubes.begin();
        const auto found = std::lower_bound(begin, to.cubes.end(), lowest(k, first_cube));
        at_[k] = static_cast<std::size_t>(found - begin);
      }
    }

    void go_to(GridKey cube) {
      for (std::size_t k = 0; k < kColumns; ++k) {
        const GridKey low = lowest(k, cube);
        std::size_t& at = at_[k];
        while (at < to_.cubes.size() && to_.cubes[at] < low) ++at;
        std::size_t end = at;
        while (end < to_.cubes.size() && to_.cubes[end] <= low + 2) ++end;
        runs_[k] = {to_.first[at], to_.first[end]};
      }
    }

    bool any_within(const Eigen::Vector3f& p, double limit_squared) const {
      for (const auto& [begin, end] : runs_) {
        for (std::int32_t i = begin; i < end; ++i) {
          const Eigen::Vector3f& q = to_.points[static_cast<std::size_t>(i)];
          if ((q - p).cast<double>().squaredNorm() <= limit_squared) return true;
        }
      }
      return false;
    }

   private:
    static constexpr std::size_t kColumns = 9;
    // The lowest cube of a column; the cube's own column comes first.
    static GridKey lowest(std::size_t column, GridKey cube) {
      constexpr std::array<std::array<int, 2>, kColumns> kBeside = {
          {{0, 0}, {-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 1}, {1, -1}, {1, 0}, {1, 1}}};
      return grid_key_beside(cube, kBeside[column][0], kBeside[column][1], -1);
    }

    const Sorted& to_;
    std::array<std::size_t, kColumns> at_;
    std::array<std::pair<std::int32_t, std::int32_t>, kColumns> runs_{};
  };

  // Of the points within the region.
  std::int64_t count_close(const Sorted& from, const Sorted& to, int threads) const {
    constexpr std::size_t kPart = 1 << 13;  // cubes
    const double limit = settings.near * settings.near * (1 + 1e-6);
    std::vector<std::int64_t> counts((from.cubes.size() + kPart - 1) / kPart, 0);
    parallel_for(counts.size(), threads, [&](std::size_t part) {
      Columns columns(to, from.cubes[part * kPart]);
      const std::size_t end = std::min(from.cubes.size(), (part + 1) * kPart);
      for (std::size_t cube = part * kPart; cube < end; ++cube) {
        columns.go_to(from.cubes[cube]);
        for (std::int32_t i = from.first[cube]; i < from.first[cube + 1]; ++i) {
          const Eigen::Vector3f& p = from.points[static_cast<std::size_t>(i)];
          counts[part] +=
              settings.region.contains(p.cast<double>()) && columns.any_within(p, limit);
        }
      }
    });
    std::int64_t sum = 0;
    for (const std::int64_t count : counts) sum += count;
    return sum;
  }

  ReconstructionSettings settings;
  GridPlaces cubes;
  Eigen::AlignedBox3d wide() const {
    Eigen::AlignedBox3d box = settings.region;
    box.min().array() -= settings.near + settings.grid;
    box.max().array() += settings.near + settings.grid;
    return box;
  }

  GridPoints inside;  // the region
  std::vector<GridKey> inside_keys;
  Sorted around;                  // and as much as is close to it
  std::optional<Sorted> counted;  // of those inside; absent: all
};

namespace {

// The middles of the parts of a triangle, of which each edge has `n`.
template <class Put>
void middles(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, int n,
             const Put& put) {
  const Eigen::Vector3d u = (b - a) / n, v = (c - a) / n;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; i + k < n; ++k) {
      put(a + (i + 1.0 / 3) * u + (k + 1.0 / 3) * v);
      if (i + k + 1 < n) put(a + (i + 2.0 / 3) * u + (k + 2.0 / 3) * v);
    }
  }
}

// Longest edges are halved until the area is small enough, so that parts do not become slivers.
template <class Use>
void cut(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
         const Eigen::AlignedBox3d& box, const Use& use) {
  Eigen::AlignedBox3d bounds(a);
  bounds.extend(b);
  bounds.extend(c);
  if (!box.intersects(bounds)) return;
  if ((b - a).cross(c - a).norm() / 2 < kMostArea) {
    use(a, b, c);
    return;
  }
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  if (ab >= bc && ab >= ca) {
    const Eigen::Vector3d m = (a + b) / 2;
    cut(a, m, c, box, use);
    cut(m, b, c, box, use);
  } else if (bc >= ca) {
    const Eigen::Vector3d m = (b + c) / 2;
    cut(a, b, m, box, use);
    cut(a, m, c, box, use);
  } else {
    const Eigen::Vector3d m = (c + a) / 2;
    cut(a, b, m, box, use);
    cut(m, b, c, box, use);
  }
}

template <class Put>
void sample(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
            const Eigen::AlignedBox3d& box, const Put& put) {
  cut(a, b, c, box,
      [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
        middles(p, q, r, kEdgeParts, put);
      });
}

}  // namespace

SurfaceSample::SurfaceSample(const TriangleMesh& mesh, const ReconstructionSettings& settings,
                             int threads) {
  check_reconstruction(settings);
  auto index = std::make_unique<Index>(settings);
  const GridPlaces grid = grid_of(settings);
  const Eigen::AlignedBox3d wide = index->wide();
  // Triangles in parts, each with a table of its own, which are put together in order; few at once,
  // so that what is held twice stays small.
  constexpr std::size_t kParts = 64, kAtOnce = 8;
  GridTable<PointSum> all;
  for (std::size_t first = 0; first < kParts; first += kAtOnce) {
    std::vector<GridTable<PointSum>> parts(kAtOnce);
    parallel_for(kAtOnce, threads, [&](std::size_t k) {
      const std::size_t n = mesh.triangles.size(), part = first + k;
      for (std::size_t t = part * n / kParts; t < (part + 1) * n / kParts; ++t) {
        sample(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2), wide,
               [&](const Eigen::Vector3d& p) {
                 if (wide.contains(p)) parts[k][grid.of(p)].add(p);
               });
      }
    });
    for (const auto& part : parts) {
      for (const auto& slot : part.slots()) {
        if (slot.key == kNoPlace) continue;
        PointSum& sum = all[slot.key];
        sum.sum += slot.entry.sum;
        sum.count += slot.entry.count;
      }
    }
  }
  std::vector<KeyedPoint> placed;
  placed.reserve(all.size());
  for (const auto& slot : all.slots()) {
    if (slot.key != kNoPlace) placed.push_back({slot.key, slot.entry.mean()});
  }
  sort_by_key(placed);
  GridPoints points;
  points.reserve(placed.size());
  for (const KeyedPoint& p : placed) {
    points.push_back(p.point);
    if (!settings.region.contains(p.point.cast<double>())) continue;
    index->inside.push_back(p.point);
    index->inside_keys.push_back(p.key);
  }
  if (index->inside.empty()) throw InputError("reconstruction: there is no surface in the region");
  index->around = index->sorted(points);
  index_ = std::move(index);
}

SurfaceSample::~SurfaceSample() = default;
SurfaceSample::SurfaceSample(SurfaceSample&&) noexcept = default;

const GridPoints& SurfaceSample::points() const {
  return index_->inside;
}

namespace {

constexpr double kWholeArea = kMostArea / 4;  // m^2; a smaller cut triangle counts as a whole

// The points that `sample` would give of a cut triangle, by quarters that count.
template <class Put>
void put_counted(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                 const SurfaceCounts& counts, const Put& put) {
  const Eigen::Vector3d across = (b - a).cross(c - a);
  const double area = across.norm() / 2;
  if (!(area > 0)) return;
  const Eigen::Vector3d normal = across / (2 * area);
  if (area < kWholeArea) {
    if (counts((a + b + c) / 3, normal)) middles(a, b, c, kEdgeParts, put);
    return;
  }
  const Eigen::Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
  const std::array<std::array<Eigen::Vector3d, 3>, 4> quarters = {
      {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
  for (const auto& q : quarters)
    if (counts((q[0] + q[1] + q[2]) / 3, normal)) middles(q[0], q[1], q[2], kEdgeParts / 2, put);
}

}  // namespace

std::vector<bool> SurfaceSample::counted(const TriangleMesh& mesh, const SurfaceCounts& counts,
                                         int threads) const {
  const GridPlaces grid = grid_of(index_->settings);
  const Eigen::AlignedBox3d wide = index_->wide();
  const std::vector<GridKey>& keys = index_->inside_keys;
  std::vector<std::atomic<char>> marks(keys.size());
  const auto mark = [&](const Eigen::Vector3d& p) {
    const GridKey key = grid.of(p);
    const auto found = std::lower_bound(keys.begin(), keys.end(), key);
    if (found != keys.end() && *found == key)
      marks[static_cast<std::size_t>(found - keys.begin())].store(1, std::memory_order_relaxed);
  };
  constexpr std::size_t kTrianglesAtOnce = 256;
  const std::size_t triangles = mesh.triangles.size();
  parallel_for((triangles + kTrianglesAtOnce - 1) / kTrianglesAtOnce, threads, [&](std::size_t k) {
    const std::size_t end = std::min(triangles, (k + 1) * kTrianglesAtOnce);
    for (std::size_t t = k * kTrianglesAtOnce; t < end; ++t) {
      cut(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2), wide,
          [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
            put_counted(a, b, c, counts, mark);
          });
    }
  });
  std::vector<bool> result(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k) result[k] = marks[k].load();
  return result;
}

void SurfaceSample::count_only(const std::vector<bool>& counted) {
  auto index = std::make_unique<Index>(*index_);
  if (counted.size() != index->inside.size())
    throw InputError("reconstruction: " + std::to_string(counted.size()) + " entries for " +
                     std::to_string(index->inside.size()) + " points of the surface");
  GridPoints chosen;
  for (std::size_t k = 0; k < counted.size(); ++k)
    if (counted[k]) chosen.push_back(index->inside[k]);
  if (chosen.empty())
    throw InputError("reconstruction: no part of the surface in the region counts");
  index->counted = index->sorted(chosen);
  index_ = std::move(index);
}

double SurfaceSample::counted_share() const {
  if (!index_->counted) return 1;
  return static_cast<double>(index_->counted->points.size()) /
         static_cast<double>(index_->inside.size());
}

ReconstructionScore SurfaceSample::score(const GridPoints& reconstructed, int threads) const {
  // What lies just outside the region is close to some of its surface.
  const Index::Sorted made = index_->sorted(reconstructed);
  ReconstructionScore score;
  score.points = std::ranges::count_if(reconstructed, [&](const Eigen::Vector3f& p) {
    return index_->settings.region.contains(p.cast<double>());
  });
  const Index::Sorted& surface = index_->counted ? *index_->counted : index_->around;
  score.surface_points =
      static_cast<std::int64_t>(index_->counted ? surface.points.size() : index_->inside.size());
  if (score.points == 0) return score;
  const auto share = [](std::int64_t part, std::int64_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  score.precision = share(index_->count_close(made, index_->around, threads), score.points);
  score.recall = share(index_->count_close(surface, made, threads), score.surface_points);
  const double sum = score.precision + score.recall;
  score.f = sum > 0 ? 2 * score.precision * score.recall / sum : 0;
  return score;
}

}  // namespace lapwing
