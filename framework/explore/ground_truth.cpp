// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/ground_truth.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/map/surface_voxels.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostVoxels = std::size_t{1} << 29;
constexpr std::uint16_t kUnreached = 0, kSurface = 65535;

// Labels of connected free voxels in a box, filled row by row.
class SpaceFill {
 public:
  SpaceFill(const int size[3]) : size_{size[0], size[1], size[2]} {
    labels_.assign(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                       static_cast<std::size_t>(size[2]),
                   kUnreached);
  }
  std::uint16_t& at(int x, int y, int z) {
    return labels_[(static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) +
                    static_cast<std::size_t>(y)) *
                       static_cast<std::size_t>(size_[0]) +
                   static_cast<std::size_t>(x)];
  }
  const std::vector<std::uint16_t>& labels() const { return labels_; }

  void fill(int x, int y, int z, std::uint16_t label) {
    std::vector<std::array<int, 3>> open{{x, y, z}};
    while (!open.empty()) {
      const auto [fx, fy, fz] = open.back();
      open.pop_back();
      if (at(fx, fy, fz) != kUnreached) continue;
      int first = fx, last = fx;
      while (first > 0 && at(first - 1, fy, fz) == kUnreached) --first;
      while (last + 1 < size_[0] && at(last + 1, fy, fz) == kUnreached) ++last;
      for (int i = first; i <= last; ++i) at(i, fy, fz) = label;
      constexpr int kBeside[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
      for (const auto& [dy, dz] : kBeside) {
        const int ny = fy + dy, nz = fz + dz;
        if (ny < 0 || nz < 0 || ny >= size_[1] || nz >= size_[2]) continue;
        bool inside = false;
        for (int i = first; i <= last; ++i) {
          const bool free = at(i, ny, nz) == kUnreached;
          if (free && !inside) open.push_back({i, ny, nz});
          inside = free;
        }
      }
    }
  }

 private:
  int size_[3];
  std::vector<std::uint16_t> labels_;
};

}  // namespace

GroundTruth::GroundTruth(std::shared_ptr<const MeshScene> scene, const Eigen::AlignedBox3d& region,
                         double resolution, const std::optional<Eigen::Vector3d>& inside)
    : scene_(std::move(scene)), grid_(resolution), region_(region) {
  if (!scene_) throw Error("ground truth of no scene");
  if (!(resolution > 0)) throw InputError("voxels must have an edge above 0 m");
  const TriangleMesh& mesh = scene_->mesh();
  if (region_.isEmpty()) region_ = mesh.bounds();
  lay_out();
  find_space(surface_voxels(mesh.vertices, mesh.triangles, resolution), inside);
  if (surface_.empty())
    throw InputError("the scene has no surface that is visible from the space around it");
}

void GroundTruth::lay_out() {
  const Eigen::AlignedBox3d bounds = scene_->mesh().bounds();
  const Eigen::Vector3d beside(kBeside, kBeside, 0), above(kBeside, kBeside, kAbove);
  const double reach = grid_.reach() - grid_.resolution();
  const double farthest =
      std::max(bounds.max().cwiseAbs().maxCoeff(), bounds.min().cwiseAbs().maxCoeff());
  if (farthest > reach)
    throw InputError("the scene reaches " + plain_number(farthest) +
                     " m from the world's origin, and a map with voxels of " +
                     plain_number(grid_.resolution()) + " m ends at " + plain_number(reach) +
                     " m: move it nearer, or take larger voxels");
  std::size_t voxels = 1;
  for (int i = 0; i < 3; ++i) {
    low_[i] = grid_.index(std::clamp(bounds.min()[i] - beside[i], -reach, reach));
    size_[i] = grid_.index(std::clamp(bounds.max()[i] + above[i], -reach, reach)) - low_[i] + 1;
    voxels *= static_cast<std::size_t>(size_[i]);
    if (voxels > kMostVoxels)
      throw InputError("the scene takes more than 2^29 voxels of " +
                       plain_number(grid_.resolution()) + " m: take larger ones");
  }
  space_.resize(voxels);
}

void GroundTruth::find_space(std::span<const VoxelKey> all,
                             const std::optional<Eigen::Vector3d>& inside) {
  // A place beyond these voxels is taken for the nearest one within, but not from anywhere.
  const auto text = [](const Eigen::Vector3d& p) {
    return "(" + plain_number(p.x()) + ", " + plain_number(p.y()) + ", " + plain_number(p.z()) +
           ")";
  };
  Eigen::AlignedBox3d near = scene_->mesh().bounds();
  near.min().array() -= kFarthest;
  near.max().array() += kFarthest;
  if (inside && !near.contains(*inside))
    throw InputError("the place " + text(*inside) +
                     " lies far outside the scene: expected within " + text(near.min()) + " to " +
                     text(near.max()) + " m");
  SpaceFill fill(size_);
  for (const VoxelKey& key : all)
    fill.at(key.x - low_[0], key.y - low_[1], key.z - low_[2]) = kSurface;
  int from[3], to[3];
  for (int i = 0; i < 3; ++i) {
    const double low = inside ? (*inside)[i] : region_.min()[i];
    const double high = inside ? (*inside)[i] : region_.max()[i];
    from[i] = std::clamp(grid_.index(low) - low_[i], 0, size_[i] - 1);
    to[i] = std::clamp(grid_.index(high) - low_[i], 0, size_[i] - 1);
  }
  // Spaces in the order in which the region meets them; how many of its voxels each one holds.
  std::vector<std::size_t> held{0};
  for (int z = from[2]; z <= to[2]; ++z)
    for (int y = from[1]; y <= to[1]; ++y)
      for (int x = from[0]; x <= to[0]; ++x) {
        if (fill.at(x, y, z) == kSurface) continue;
        if (fill.at(x, y, z) == kUnreached && held.size() + 1 < kSurface) {
          fill.fill(x, y, z, static_cast<std::uint16_t>(held.size()));
          held.push_back(0);
        }
        if (fill.at(x, y, z) != kUnreached) ++held[fill.at(x, y, z)];
      }
  if (held.size() < 2)
    throw InputError(inside ? "the start lies in a voxel of the surface: in an obstacle"
                            : "the region of interest has no free space");
  const auto label =
      static_cast<std::uint16_t>(std::max_element(held.begin() + 1, held.end()) - held.begin());
  for (std::size_t k = 0; k < space_.size(); ++k) space_[k] = fill.labels()[k] == label;

  constexpr int kFaces[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  for (const VoxelKey& key : all) {
    const int at[3] = {key.x - low_[0], key.y - low_[1], key.z - low_[2]};
    const bool seen = std::any_of(std::begin(kFaces), std::end(kFaces), [&](const int* d) {
      const int n[3] = {at[0] + d[0], at[1] + d[1], at[2] + d[2]};
      for (int i = 0; i < 3; ++i)
        if (n[i] < 0 || n[i] >= size_[i]) return false;
      return static_cast<bool>(space_[place_of(n[0], n[1], n[2])]);
    });
    if (seen) surface_.push_back(key);
  }
  const auto cell_of = [](const VoxelKey& key) {
    return cell_key(key.x >> kCellBits, key.y >> kCellBits, key.z >> kCellBits);
  };
  std::sort(surface_.begin(), surface_.end(), [&](const VoxelKey& a, const VoxelKey& b) {
    const std::uint64_t ca = cell_of(a), cb = cell_of(b);
    return ca != cb ? ca < cb : a < b;
  });
  for (std::size_t k = 0; k < surface_.size(); ++k) {
    Cell& cell = cells_[cell_of(surface_[k])];
    if (cell.last == 0) cell = {cell_of(surface_[k]), static_cast<std::uint32_t>(k), 0};
    cell.last = static_cast<std::uint32_t>(k + 1);
  }
}

OpenWorld with_floor(TriangleMesh mesh) {
  constexpr double kBeyond = 10, kOver = 6;  // m
  const Eigen::AlignedBox3d box = mesh.bounds();
  const Eigen::Vector3d beyond(kBeyond, kBeyond, 0);
  const Eigen::Vector3d low = box.min() - beyond, high = box.max() + beyond;
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (const auto& [x, y] : {std::pair{low.x(), low.y()},
                             {high.x(), low.y()},
                             {high.x(), high.y()},
                             {low.x(), high.y()}})
    mesh.vertices.emplace_back(x, y, low.z());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  if (!mesh.colors.empty()) mesh.colors.resize(mesh.triangles.size(), Rgb{160, 160, 160});
  return {std::move(mesh), {low, high + Eigen::Vector3d(0, 0, kOver)}};
}

bool GroundTruth::in_space(const Eigen::Vector3d& p_W) const {
  if (!grid_.contains(p_W)) return false;
  int at[3];
  for (int i = 0; i < 3; ++i) {
    at[i] = grid_.index(p_W[i]) - low_[i];
    if (at[i] < 0 || at[i] >= size_[i]) return false;
  }
  return space_[place_of(at[0], at[1], at[2])];
}

Eigen::AlignedBox3d cleared_box(const VoxelGrid& grid, const Eigen::Vector3d& middle, double edge) {
  const double half = edge / 2 - 1e-6 * grid.resolution();
  Eigen::Vector3d low, high;
  for (int i = 0; i < 3; ++i) {
    low[i] = grid.face(grid.index(middle[i] - half));
    high[i] = grid.face(grid.index(middle[i] + half) + 1);
  }
  return {low, high};
}

VoxelBox reach_box(const VoxelGrid& grid, const Viewpoint& view, const Pinhole& pinhole,
                   double range) {
  const Eigen::Matrix3d to_world = view.camera().orientation.toRotationMatrix();
  Eigen::AlignedBox3d box(view.position);
  for (const double x : {-0.5, pinhole.width - 0.5})
    for (const double y : {-0.5, pinhole.height - 0.5})
      box.extend(view.position + range * (to_world * pixel_ray(pinhole, x, y)));
  // The far side is round: a point ahead may lie beyond the corners.
  box.extend(view.position + range * to_world.col(2));
  VoxelKey lower, upper;
  std::uint16_t* parts[2][3] = {{&lower.x, &lower.y, &lower.z}, {&upper.x, &upper.y, &upper.z}};
  const double voxel = grid.resolution();
  for (int i = 0; i < 3; ++i) {
    const double low = std::max(box.min()[i], view.position[i] - range) - voxel;
    const double high = std::min(box.max()[i], view.position[i] + range) + voxel;
    *parts[0][i] = static_cast<std::uint16_t>(std::clamp(grid.index(low), 0, kKeyCount - 1));
    *parts[1][i] = static_cast<std::uint16_t>(std::clamp(grid.index(high), 0, kKeyCount - 1));
  }
  return {lower, upper};
}

// -- what a map has observed ---------------------------------------------------------------------

ObservedSurface::ObservedSurface(const GroundTruth& truth, const ViewSensor& sensor, NewMap new_map)
    : truth_(&truth), sensor_(sensor), new_map_(std::move(new_map)), counts_(truth.size(), 0) {
  sensor_.noise.reset();
  sensor_.stereo.reset();
  const MapSettings settings = new_map_()->settings();
  if (!settings.observations)
    throw InputError("an exploration needs a map that counts observations");
  eta_ = settings.information;
}

void ObservedSurface::update(const Map& map, const Viewpoint& view) {
  const std::span<const VoxelKey> surface = truth_->surface();
  truth_->for_each_run(reach_box(truth_->grid(), view, sensor_.pinhole, sensor_.range),
                       [&](std::uint32_t first, std::uint32_t last) {
                         for (std::uint32_t k = first; k < last; ++k) {
                           const std::uint16_t now = map.read(surface[k]).observations;
                           if (now == counts_[k]) continue;
                           const std::size_t most = std::max(now, counts_[k]);
                           while (certainty_.size() <= most)
                             certainty_.push_back(1 - map.uncertainty(static_cast<std::uint16_t>(
                                                          certainty_.size())));
                           counts_[k] = now;
                         }
                       });
  // Summed up anew by how often each was observed, so that no rounding adds up.
  std::vector<std::size_t> seen(certainty_.size() + 1, 0);
  for (const std::uint16_t count : counts_) ++seen[count];
  observed_ = 0;
  for (std::size_t n = 0; n < certainty_.size(); ++n)
    observed_ += certainty_[n] * static_cast<double>(seen[n]);
}

ObservedSurface::Sight ObservedSurface::look(const Viewpoint& view) const {
  const std::unique_ptr<Map> map = new_map_();
  map->integrate(sensor_.look(truth_->scene(), view, 1));
  Sight sight;
  const std::span<const VoxelKey> surface = truth_->surface();
  truth_->for_each_run(reach_box(truth_->grid(), view, sensor_.pinhole, sensor_.range),
                       [&](std::uint32_t first, std::uint32_t last) {
                         for (std::uint32_t k = first; k < last; ++k)
                           if (map->read(surface[k]).known) sight.push_back(k);
                       });
  return sight;
}

std::shared_ptr<const ObservedSurface::Sight> ObservedSurface::sight_of(
    const Viewpoint& view) const {
  {
    const std::lock_guard lock(mutex_);
    const int known = index_.find(view);
    if (known >= 0) return sights_[static_cast<std::size_t>(known)];
  }
  auto sight = std::make_shared<const Sight>(look(view));
  const std::lock_guard lock(mutex_);
  const auto place = static_cast<std::size_t>(index_.add(view));
  if (place == sights_.size()) sights_.push_back(std::move(sight));
  return sights_[place];
}

double ObservedSurface::gain(const Viewpoint& view) const {
  const std::shared_ptr<const Sight> sight = sight_of(view);
  // By how often each was observed: n observations have 1 - exp(-eta n) of a voxel.
  std::vector<std::size_t> seen;
  for (const std::uint32_t k : *sight) {
    if (counts_[k] >= seen.size()) seen.resize(counts_[k] + 1u, 0);
    ++seen[counts_[k]];
  }
  double sum = 0;
  for (std::size_t n = 0; n < seen.size(); ++n)
    sum += (1 - std::exp(-eta_)) * std::exp(-eta_ * static_cast<double>(n)) *
           static_cast<double>(seen[n]);
  return sum;
}

void ObservedSurface::each_gain(
    const Viewpoint& view,
    const std::function<void(const Eigen::Vector3d& p_W, double gain)>& visit) const {
  const std::shared_ptr<const Sight> sight = sight_of(view);
  for (const std::uint32_t k : *sight)
    visit(truth_->grid().center(truth_->surface()[k]),
          (1 - std::exp(-eta_)) * std::exp(-eta_ * static_cast<double>(counts_[k])));
}

// -- starts --------------------------------------------------------------------------------------

bool GroundTruth::box_blocked(const Eigen::AlignedBox3d& box) const {
  return scene_->box_blocked(box.center(), box.center(), box.sizes() / 2);
}

Viewpoint random_start(const GroundTruth& truth, double clear, double reach, double pitch,
                       Random& random, const std::optional<Eigen::AlignedBox3d>& bounds) {
  constexpr int kDraws = 100'000;
  int outside = 0, blocked = 0, far = 0;
  const Eigen::AlignedBox3d box = bounds ? truth.region().intersection(*bounds) : truth.region();
  if (box.isEmpty()) throw InputError("found no start: the bounds do not overlap the region");
  const Eigen::Vector3d low = box.min(), high = box.max();
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = low[i] + random.uniform() * (high[i] - low[i]);
    const double yaw = random.uniform(-EIGEN_PI, EIGEN_PI);
    if (!truth.in_space(p)) {
      ++outside;
    } else if (truth.box_blocked(cleared_box(truth.grid(), p, clear))) {
      ++blocked;
    } else if (!truth.scene().nearest(p, reach)) {
      ++far;
    } else {
      return {p, yaw, pitch};
    }
  }
  const auto share = [&](int count) { return plain_number(100.0 * count / kDraws) + " %"; };
  const std::string why = "found no start: of 100,000 random places in the region " +
                          share(outside) + " lie in no free space, " + share(blocked) +
                          " have an obstacle within the box of " + plain_number(clear) +
                          " m that must be free, " + share(far) + " have no surface within " +
                          plain_number(reach) + " m";
  if (blocked > 0) throw StartError(why);
  throw InputError(why);
}

}  // namespace lapwing
