// SPDX-License-Identifier: Apache-2.0
#include "framework/view/visible_voxels.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// The same view with `across` pixels a row.
Pinhole coarser(const Pinhole& fine, int across) {
  const double share = static_cast<double>(across) / fine.width;
  const int down = std::max(1, static_cast<int>(std::lround(fine.height * share)));
  return {across,
          down,
          fine.focal_x * share,
          fine.focal_y * share,
          (fine.principal_x + 0.5) * share - 0.5,
          (fine.principal_y + 0.5) * share - 0.5};
}

}  // namespace

VisibleVoxels::VisibleVoxels(std::shared_ptr<const Map> map, std::shared_ptr<const MeshScene> prior,
                             SightSettings settings)
    : map_(std::move(map)), prior_(std::move(prior)), settings_(std::move(settings)) {
  if (!map_) throw Error("VisibleVoxels: no map");
  check_camera(settings_.pinhole, settings_.range);
  if (!(settings_.usable_range > 0) || !(settings_.usable_incidence > 0))
    throw InputError("the usable range and angle of an image must be above 0");
  region_.emplace(settings_.region, map_->grid());
  const Eigen::AlignedBox3d& bounds = settings_.region.bounds();
  const Vector3d reach = Vector3d::Constant(settings_.range);
  if (!map_->grid().contains(bounds.min() - reach) || !map_->grid().contains(bounds.max() + reach))
    throw InputError(
        "the region of interest is too far from the origin for a map of this resolution");
  // Wider by a voxel: rays are only to be spared what cannot count.
  const Vector3d margin = Vector3d::Constant(map_->grid().resolution());
  reach_ = {bounds.min() - margin, bounds.max() + margin};
  if (settings_.within) {
    const Eigen::AlignedBox3d part = settings_.within->intersection(bounds);
    if (part.isEmpty()) throw InputError("the part of the region of interest lies beside it");
    within_ = VoxelBox{map_->grid().key(part.min()), map_->grid().key(part.max())};
    reach_ = {part.min() - margin, part.max() + margin};
  }
  const bool fewer = settings_.across > 0 && settings_.across < settings_.pinhole.width;
  rays_ =
      tiled_pixel_rays(fewer ? coarser(settings_.pinhole, settings_.across) : settings_.pinhole);
}

double VisibleVoxels::leaves_region_after(const Vector3d& origin, const Vector3d& direction,
                                          double range) const {
  double enters = 0, leaves = range;
  for (int i = 0; i < 3; ++i) {
    const double a = (reach_.min()[i] - origin[i]) / direction[i];
    const double b = (reach_.max()[i] - origin[i]) / direction[i];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters < leaves ? leaves : 0;
}

std::vector<VoxelKey> VisibleVoxels::keys_from(const Viewpoint& viewpoint,
                                               std::span<const Vector3d> directions_C,
                                               double range) const {
  constexpr std::size_t kTile = 64;      // whole ones are quickest, see Map::cast
  constexpr std::size_t kAtOnce = 1024;  // few enough to stay at hand
  const Pose camera = viewpoint.camera();
  const Eigen::Matrix3d r = camera.orientation.toRotationMatrix();
  std::vector<MapRay> rays;
  std::vector<MapRayHit> hits;
  std::vector<VoxelKey> keys;
  for (std::size_t first = 0; first < directions_C.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, directions_C.size() - first);
    rays.clear();
    for (std::size_t tile = 0; tile < count; tile += kTile) {
      const std::size_t begin = rays.size();
      double farthest = 0;  // beyond its own a ray meets nothing that counts
      for (const Vector3d& direction_C :
           directions_C.subspan(first + tile, std::min(kTile, count - tile))) {
        const Vector3d direction = r * direction_C;
        farthest = std::max(farthest, leaves_region_after(camera.position, direction, range));
        rays.push_back({camera.position, direction, farthest});
      }
      if (farthest > 0)
        for (std::size_t k = begin; k < rays.size(); ++k) rays[k].range = farthest;
      else
        rays.resize(begin);
    }
    hits.resize(rays.size());
    map_->cast(rays, hits);
    for (const MapRayHit& hit : hits) {
      if (hit.state == VoxelState::free || !counts(hit.voxel)) continue;
      if (keys.empty() || keys.back() != hit.voxel) keys.push_back(hit.voxel);
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

double VisibleVoxels::sight_range() const {
  // A ray meets a voxel at most half its diagonal before its centre.
  return std::min(settings_.range, settings_.usable_range + map_->grid().resolution());
}

std::optional<VoxelSight> VisibleVoxels::usable_sight(const Viewpoint& viewpoint,
                                                      const VoxelKey& key) const {
  const Vector3d towards = map_->grid().center(key) - viewpoint.position;
  const double distance = towards.norm();
  if (distance > settings_.usable_range) return std::nullopt;
  VoxelSight sight{static_cast<float>(distance), 0, std::nullopt};
  if (distance > 0) {
    sight.pixels =
        static_cast<float>(settings_.pinhole.focal_x * map_->grid().resolution() / distance);
    const Vector3d direction = towards / distance;
    if (prior_) {
      const MeshHit hit =
          prior_->cast({viewpoint.position, direction, distance + settings_.normal_tolerance});
      if (hit.triangle >= 0 && std::abs(hit.distance - distance) < settings_.normal_tolerance)
        sight.incidence = static_cast<float>(
            std::atan2(direction.cross(hit.normal).norm(), -direction.dot(hit.normal)));
    }
  }
  if (sight.incidence && *sight.incidence > settings_.usable_incidence) return std::nullopt;
  return sight;
}

std::vector<SeenVoxel> VisibleVoxels::seen_from(const Viewpoint& viewpoint) const {
  std::vector<SeenVoxel> seen;
  for (const VoxelKey& key : keys_from(viewpoint, rays_, sight_range()))
    if (const auto sight = usable_sight(viewpoint, key)) seen.push_back({key, *sight});
  return seen;
}

std::optional<VoxelSight> VisibleVoxels::sight_of(const Viewpoint& viewpoint,
                                                  const VoxelKey& voxel) const {
  if (!counts(voxel)) return std::nullopt;
  // Half a diagonal, and a little for rounding.
  const double radius = 0.87 * map_->grid().resolution();
  const Pose camera = viewpoint.camera();
  const Vector3d towards = camera.orientation.toRotationMatrix().transpose() *
                           (map_->grid().center(voxel) - viewpoint.position);
  const double distance = towards.norm();
  if (distance - radius > sight_range()) return std::nullopt;
  std::vector<Vector3d> near;
  if (distance > radius) {
    const double share = radius / distance;
    const double least = distance * std::sqrt(1 - share * share);
    for (const Vector3d& ray : rays_)
      if (ray.dot(towards) >= least) near.push_back(ray);
  }
  const auto met = keys_from(viewpoint, distance > radius ? near : rays_, sight_range());
  if (!std::binary_search(met.begin(), met.end(), voxel)) return std::nullopt;
  return usable_sight(viewpoint, voxel);
}

std::vector<VoxelKey> VisibleVoxels::voxels_from(const Viewpoint& viewpoint) const {
  return keys_from(viewpoint, rays_, settings_.range);
}

std::vector<VoxelKey> VisibleVoxels::seen_coarsely_from(const Viewpoint& viewpoint,
                                                        int across) const {
  if (across < 1 || across > settings_.pinhole.width)
    throw InputError("a coarse view must have from 1 to as many pixels across as the camera");
  return keys_from(viewpoint, tiled_pixel_rays(coarser(settings_.pinhole, across)),
                   settings_.range);
}

bool matchable(const std::vector<VoxelKey>& a, const std::vector<VoxelKey>& b, double alpha) {
  if (a.empty() || b.empty()) return false;
  std::size_t shared = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (*i == *j)
      ++shared, ++i, ++j;
    else if (*i < *j)
      ++i;
    else
      ++j;
  }
  return static_cast<double>(shared) >= alpha * static_cast<double>(a.size() + b.size()) / 2;
}

}  // namespace lapwing
