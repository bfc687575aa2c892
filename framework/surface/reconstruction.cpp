// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/reconstruction.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/surface/grid_points.h"

namespace lapwing {
namespace {

constexpr int kShardBits = 6, kShards = 1 << kShardBits;
constexpr int kBatch = 16;             // images measured before they are put in
constexpr int kMostParts = 8;          // of a pixel, across
constexpr double kLeastTowards = 0.5;  // a ray beside a pixel's middle is nearly as steep as that

int shard_of(GridKey key) {
  return static_cast<int>(mixed(key) >> (64 - kShardBits));
}

struct SumInCube : PointSum {
  GridKey cube = kNoPlace;  // that it lies in
};

struct Agreement {
  std::int32_t images = 0, last = -1;
};

}  // namespace

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
  check_reconstruction(settings);
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
  const GridPlaces cube = cubes_of(settings);
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
  const GridPlaces grid = grid_of(settings);
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
  std::vector<std::vector<KeyedPoint>> of_shard(kShards);
  parallel_for(kShards, threads, [&](std::size_t shard) {
    for (const auto& slot : parts_->means[shard].slots()) {
      if (slot.key == kNoPlace) continue;
      const Agreement* agreement = parts_->cubes[shard].find(slot.entry.cube);
      if (agreement && agreement->images >= least) {
        of_shard[shard].push_back({slot.key, slot.entry.mean()});
      }
    }
  });
  std::vector<KeyedPoint> placed;
  for (const auto& part : of_shard) placed.insert(placed.end(), part.begin(), part.end());
  return in_order(std::move(placed));
}

}  // namespace lapwing
