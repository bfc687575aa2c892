// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/reconstruction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/surface/grid_table.h"

namespace lapwing {
namespace {

constexpr int kShardBits = 6, kShards = 1 << kShardBits;
constexpr int kBatch = 16;          // images measured before they are put in
constexpr double kMostArea = 0.25;  // m^2, of a triangle that gives points (reading 4.7)
constexpr int kEdgeParts = 10;      // 100 points to a triangle: the middles of as many parts of it
constexpr int kMostParts = 8;       // of a pixel, across
constexpr double kLeastTowards = 0.5;  // a ray beside a pixel's middle is nearly as steep as that
constexpr double kMostPlaces = 1 << 20;
// The grids do not begin at round numbers of metres, where walls and floors are wont to lie: the
// rounding of a depth would strew one surface over two layers of places.
constexpr double kShift = 0.3719;  // of the larger one's edge

void check_settings(const ReconstructionSettings& s) {
  const auto sound = [](double number) { return std::isfinite(number) && number > 0; };
  if (s.region.isEmpty()) throw InputError("reconstruction: the region is empty");
  if (!sound(s.grid) || !sound(s.near) || !sound(s.range)) {
    throw InputError("reconstruction: grid, near and range must be above 0 m");
  }
  const double parts = s.near / s.grid;
  if (std::abs(parts - std::round(parts)) > 1e-6 || parts < 0.5) {
    throw InputError("reconstruction: near must be a whole multiple of grid");
  }
  if (s.images < 1) throw InputError("reconstruction: at least 1 image must agree");
  if (!sound(s.incidence) || s.incidence > 1.5708) {
    throw InputError("reconstruction: incidence must be above 0 and at most 90 degrees");
  }
  const double reach = s.region.min().cwiseAbs().cwiseMax(s.region.max().cwiseAbs()).maxCoeff();
  if (!((reach + 1) / std::min(s.grid, s.near) < kMostPlaces)) {
    throw InputError("reconstruction: the region has more than 2^20 places of the grid to an edge");
  }
}

struct Places {
  double edge, shift;  // m
  GridKey of(const Eigen::Vector3d& p) const {
    const auto at = [&](double x) {
      return static_cast<std::int64_t>(std::floor((x + shift) / edge));
    };
    return grid_key(at(p.x()), at(p.y()), at(p.z()));
  }
};

Places grid_of(const ReconstructionSettings& s) {
  return {s.grid, kShift * s.near};
}
Places cubes_of(const ReconstructionSettings& s) {
  return {s.near, kShift * s.near};
}

int shard_of(GridKey key) {
  return static_cast<int>(mixed(key) >> (64 - kShardBits));
}

struct Sum {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::int64_t count = 0;

  void add(const Eigen::Vector3d& p) {
    sum += p;
    ++count;
  }
  Eigen::Vector3f mean() const { return (sum / static_cast<double>(count)).cast<float>(); }
};

struct SumInCube : Sum {
  GridKey cube = kNoPlace;  // that it lies in
};

struct Agreement {
  std::int32_t images = 0, last = -1;
};

struct Placed {
  GridKey key;
  Eigen::Vector3f point;
};

GridPoints in_order(std::vector<Placed> placed) {
  std::sort(placed.begin(), placed.end(),
            [](const Placed& a, const Placed& b) { return a.key < b.key; });
  GridPoints points;
  points.reserve(placed.size());
  for (const Placed& p : placed) points.push_back(p.point);
  return points;
}

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
  Places cubes;
  GridPoints inside;  // the region
  Sorted around;      // and as much as is close to it
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
template <class Put>
void sample(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
            const Eigen::AlignedBox3d& box, const Put& put) {
  Eigen::AlignedBox3d bounds(a);
  bounds.extend(b);
  bounds.extend(c);
  if (!box.intersects(bounds)) return;
  if ((b - a).cross(c - a).norm() / 2 < kMostArea) {
    middles(a, b, c, kEdgeParts, put);
    return;
  }
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  if (ab >= bc && ab >= ca) {
    const Eigen::Vector3d m = (a + b) / 2;
    sample(a, m, c, box, put);
    sample(m, b, c, box, put);
  } else if (bc >= ca) {
    const Eigen::Vector3d m = (b + c) / 2;
    sample(a, b, m, box, put);
    sample(a, m, c, box, put);
  } else {
    const Eigen::Vector3d m = (c + a) / 2;
    sample(a, b, m, box, put);
    sample(m, b, c, box, put);
  }
}

}  // namespace

SurfaceSample::SurfaceSample(const TriangleMesh& mesh, const ReconstructionSettings& settings,
                             int threads) {
  check_settings(settings);
  auto index = std::make_unique<Index>(settings);
  const Places grid = grid_of(settings);
  Eigen::AlignedBox3d wide = settings.region;
  wide.min().array() -= settings.near + settings.grid;
  wide.max().array() += settings.near + settings.grid;
  // Triangles in parts, each with a table of its own, which are put together in order; few at once,
  // so that what is held twice stays small.
  constexpr std::size_t kParts = 64, kAtOnce = 8;
  GridTable<Sum> all;
  for (std::size_t first = 0; first < kParts; first += kAtOnce) {
    std::vector<GridTable<Sum>> parts(kAtOnce);
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
        Sum& sum = all[slot.key];
        sum.sum += slot.entry.sum;
        sum.count += slot.entry.count;
      }
    }
  }
  std::vector<Placed> placed;
  placed.reserve(all.size());
  for (const auto& slot : all.slots()) {
    if (slot.key != kNoPlace) placed.push_back({slot.key, slot.entry.mean()});
  }
  const GridPoints points = in_order(std::move(placed));
  for (const Eigen::Vector3f& p : points) {
    if (settings.region.contains(p.cast<double>())) index->inside.push_back(p);
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

ReconstructionScore SurfaceSample::score(const GridPoints& reconstructed, int threads) const {
  // What lies just outside the region is close to some of its surface.
  const Index::Sorted made = index_->sorted(reconstructed);
  ReconstructionScore score;
  score.points = std::ranges::count_if(reconstructed, [&](const Eigen::Vector3f& p) {
    return index_->settings.region.contains(p.cast<double>());
  });
  score.surface_points = static_cast<std::int64_t>(index_->inside.size());
  if (score.points == 0) return score;
  const auto share = [](std::int64_t part, std::int64_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  score.precision = share(index_->count_close(made, index_->around, threads), score.points);
  score.recall = share(index_->count_close(index_->around, made, threads), score.surface_points);
  const double sum = score.precision + score.recall;
  score.f = sum > 0 ? 2 * score.precision * score.recall / sum : 0;
  return score;
}

struct Reconstruction::Parts {
  ReconstructionSettings settings;
  int images = 0;
  // A cube's shard holds its places of the grid as well.
  std::vector<GridTable<Agreement>> cubes = std::vector<GridTable<Agreement>>(kShards);
  std::vector<GridTable<SumInCube>> means = std::vector<GridTable<SumInCube>>(kShards);

  struct Measured {
    GridKey cube;
    Eigen::Vector3f point;
    bool middle = true;  // of a pixel; else only the cube counts
  };
  using Image = std::vector<std::vector<Measured>>;  // by shard

  Image measure(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                const DepthNoise* noise, std::uint64_t seed, int number) const;
  void put(const std::vector<Image>& images, int shard);
};

Reconstruction::Reconstruction(const ReconstructionSettings& settings)
    : parts_(std::make_unique<Parts>()) {
  check_settings(settings);
  parts_->settings = settings;
}
Reconstruction::~Reconstruction() = default;
Reconstruction::Reconstruction(const Reconstruction& other)
    : parts_(std::make_unique<Parts>(*other.parts_)) {}
Reconstruction& Reconstruction::operator=(const Reconstruction& other) {
  if (this != &other) parts_ = std::make_unique<Parts>(*other.parts_);
  return *this;
}

int Reconstruction::images() const {
  return parts_->images;
}

Reconstruction::Parts::Image Reconstruction::Parts::measure(const MeshScene& scene,
                                                            const Pose& camera,
                                                            const Pinhole& pinhole,
                                                            const DepthNoise* noise,
                                                            std::uint64_t seed, int number) const {
  Image image(kShards);
  MeshView view = render_view(scene, camera, pinhole, settings.range, 1);
  if (noise) {
    // Images have streams of their own: the seed of one is far from that of the next.
    add_noise(view.depth, *noise, mixed(seed ^ mixed(static_cast<GridKey>(number) + 1)));
  }
  Eigen::AlignedBox3d wide = settings.region;
  wide.min().array() -= 2 * settings.near;
  wide.max().array() += 2 * settings.near;
  const Places cube = cubes_of(settings);
  const double least = std::cos(settings.incidence);
  const Eigen::Matrix3d turned = camera.orientation.toRotationMatrix();
  for (int y = 0; y < pinhole.height; ++y) {
    for (int x = 0; x < pinhole.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * pinhole.width + x;
      const double depth = view.depth.depth[i];
      if (!(depth > 0) || !(depth <= settings.range) || view.triangles[i] < 0) continue;
      const Eigen::Vector3d ray = turned * pixel_ray(pinhole, x, y);
      const Eigen::Vector3d p = camera.position + depth * ray;
      if (!wide.contains(p)) continue;
      if (-ray.dot(view.normals[i].cast<double>()) < least * ray.norm()) continue;
      const GridKey key = cube.of(p);
      image[shard_of(key)].push_back({key, p.cast<float>(), true});
      // A pixel that is larger than a cube measures all cubes that it covers of the surface.
      const Eigen::Vector3d normal = view.normals[i].cast<double>();
      const double facing = -ray.dot(normal);
      const double across = depth / std::min(pinhole.focal_x, pinhole.focal_y);
      const double slant = std::max(facing / ray.norm(), least);
      const int parts =
          std::clamp(static_cast<int>(std::ceil(across / (slant * settings.near))), 1, kMostParts);
      for (int part = 0; parts > 1 && part < parts * parts; ++part) {
        const double sub_x = x + (part % parts + 0.5) / parts - 0.5;
        const double sub_y = y + (part / parts + 0.5) / parts - 0.5;
        const Eigen::Vector3d beside = turned * pixel_ray(pinhole, sub_x, sub_y);
        const double towards = -beside.dot(normal);
        if (towards < kLeastTowards * facing) continue;
        const Eigen::Vector3d q = camera.position + depth * facing / towards * beside;
        const GridKey other = cube.of(q);
        if (other != key && wide.contains(q)) {
          image[shard_of(other)].push_back({other, q.cast<float>(), false});
        }
      }
    }
  }
  return image;
}

void Reconstruction::Parts::put(const std::vector<Image>& batch, int shard) {
  const Places grid = grid_of(settings);
  for (std::size_t k = 0; k < batch.size(); ++k) {
    const int number = images + static_cast<int>(k);
    for (const Measured& measured : batch[k][shard]) {
      Agreement& agreement = cubes[shard][measured.cube];
      if (agreement.last != number) {
        agreement.last = number;
        ++agreement.images;
      }
      if (!measured.middle) continue;
      SumInCube& sum = means[shard][grid.of(measured.point.cast<double>())];
      sum.add(measured.point.cast<double>());
      sum.cube = measured.cube;
    }
  }
}

void Reconstruction::add(const MeshScene& scene, std::span<const Pose> cameras,
                         const Pinhole& pinhole, const std::optional<DepthNoise>& noise,
                         std::uint64_t seed, int threads, const CancellationToken* cancellation) {
  check_camera(pinhole, parts_->settings.range);
  for (std::size_t first = 0; first < cameras.size(); first += kBatch) {
    if (cancellation && cancellation->cancelled()) throw Cancelled();
    const std::size_t count = std::min<std::size_t>(kBatch, cameras.size() - first);
    std::vector<Parts::Image> batch(count);
    parallel_for(count, threads, [&](std::size_t k) {
      batch[k] = parts_->measure(scene, cameras[first + k], pinhole, noise ? &*noise : nullptr,
                                 seed, parts_->images + static_cast<int>(k));
    });
    parallel_for(kShards, threads,
                 [&](std::size_t shard) { parts_->put(batch, static_cast<int>(shard)); });
    parts_->images += static_cast<int>(count);
  }
}

GridPoints Reconstruction::points(int threads) const {
  const int least = parts_->settings.images;
  std::vector<std::vector<Placed>> of_shard(kShards);
  parallel_for(kShards, threads, [&](std::size_t shard) {
    for (const auto& slot : parts_->means[shard].slots()) {
      if (slot.key == kNoPlace) continue;
      const Agreement* agreement = parts_->cubes[shard].find(slot.entry.cube);
      if (agreement && agreement->images >= least) {
        of_shard[shard].push_back({slot.key, slot.entry.mean()});
      }
    }
  });
  std::vector<Placed> placed;
  for (const auto& part : of_shard) placed.insert(placed.end(), part.begin(), part.end());
  return in_order(std::move(placed));
}

}  // namespace lapwing
