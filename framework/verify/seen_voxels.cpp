// SPDX-License-Identifier: Apache-2.0
// How: rays of this room's own through the map, for every pixel of every view. Cubes of free voxels
// are passed in one go.
#include "framework/verify/seen_voxels.h"

#include <algorithm>
#include <atomic>

#include "framework/core/parallel.h"

namespace lapwing {
namespace {

constexpr int kLevels = 6;  // of cubes that a ray passes in one go: 1, 2, 4, ... 32 voxels

// What is free in a map, to be looked through: for every voxel, the largest of the cubes around it,
// each lying at multiples of its edge, that is all free.
class SeeThrough {
 public:
  explicit SeeThrough(const BlockedVoxels& voxels) : voxels_(voxels) {
    std::size_t count = 1;
    for (int i = 0; i < 3; ++i) count *= static_cast<std::size_t>(voxels.count(i));
    levels_.assign(count, kBlocked);
    constexpr int top = kLevels - 1, edge = 1 << top;
    const int layers = (voxels.count(2) + edge - 1) / edge;
    parallel_for(static_cast<std::size_t>(layers), 0, [&](std::size_t layer) {
      const int z = static_cast<int>(layer) * edge;
      for (int y = 0; y < voxels.count(1); y += edge)
        for (int x = 0; x < voxels.count(0); x += edge)
          if (settle(x, y, z, top)) paint(x, y, z, top);
    });
  }

  // The first voxel on a ray that is not free, counted from the first one held; false where there
  // is none within `range` metres, or the ray leaves what is held.
  bool meet(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double range,
            int hit[3]) const {
    const VoxelGrid& grid = voxels_.grid();
    const double edge = grid.resolution();
    if (!grid.contains(from)) return false;
    int at[3];
    for (int i = 0; i < 3; ++i) {
      at[i] = grid.index(from(i)) - voxels_.first(i);
      if (at[i] < 0 || at[i] >= voxels_.count(i)) return false;
    }
    const Eigen::Vector3d per_metre = direction.cwiseInverse();
    double along = 0;
    while (along < range) {
      const std::uint8_t level = levels_[place(at[0], at[1], at[2])];
      if (level == kBlocked) {
        std::copy_n(at, 3, hit);
        return true;
      }
      // To the nearest face ahead of the cube.
      const int size = 1 << level;
      double nearest = std::numeric_limits<double>::infinity();
      int through = 0;
      for (int i = 0; i < 3; ++i) {
        if (direction(i) == 0) continue;
        const int low = at[i] & -size, next = direction(i) > 0 ? low + size : low;
        const double distance = (grid.face(voxels_.first(i) + next) - from(i)) * per_metre(i);
        if (distance < nearest) nearest = distance, through = i;
      }
      along = std::max(along, nearest);
      const int low = at[through] & -size;
      const int entered = direction(through) > 0 ? low + size : low - 1;
      // Across the cube the other two have moved on as well; rounding must not leave it.
      if (size > 1)
        for (int i = 0; i < 3; ++i) {
          if (i == through) continue;
          const int first = at[i] & -size;
          const double reached = from(i) + along * direction(i);
          at[i] = std::clamp(
              static_cast<int>(std::floor(reached / edge)) + kCenterKey - voxels_.first(i), first,
              first + size - 1);
        }
      at[through] = entered;
      if (entered < 0 || entered >= voxels_.count(through)) return false;
    }
    return false;
  }

 private:
  static constexpr std::uint8_t kBlocked = 255;

  std::size_t place(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(voxels_.count(1)) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(voxels_.count(0)) +
           static_cast<std::size_t>(x);
  }

  // Whether the cube is held and all free. Where it is not, those of its parts that are have been
  // painted.
  bool settle(int x, int y, int z, int level) {
    if (x >= voxels_.count(0) || y >= voxels_.count(1) || z >= voxels_.count(2)) return false;
    if (level == 0) return voxels_.free(x, y, z);
    const int half = 1 << (level - 1);
    bool open[8];
    bool all = true;
    for (int part = 0; part < 8; ++part) {
      open[part] = settle(x + (part & 1) * half, y + (part >> 1 & 1) * half, z + (part >> 2) * half,
                          level - 1);
      all = all && open[part];
    }
    if (all) return true;
    for (int part = 0; part < 8; ++part)
      if (open[part])
        paint(x + (part & 1) * half, y + (part >> 1 & 1) * half, z + (part >> 2) * half, level - 1);
    return false;
  }

  void paint(int x, int y, int z, int level) {
    const int size = 1 << level;
    for (int k = z; k < z + size; ++k)
      for (int j = y; j < y + size; ++j)
        std::fill_n(levels_.begin() + static_cast<std::ptrdiff_t>(place(x, j, k)), size,
                    static_cast<std::uint8_t>(level));
  }

  const BlockedVoxels& voxels_;
  std::vector<std::uint8_t> levels_;
};

// How far a ray can see voxels of the region; below 0 where it passes beside it.
double reach_of(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                const Eigen::AlignedBox3d& region, double margin) {
  double enters = 0, leaves = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double low = region.min()(i) - margin - from(i);
    const double high = region.max()(i) + margin - from(i);
    if (direction(i) == 0) {
      if (low > 0 || high < 0) return -1;
      continue;
    }
    const double one = low / direction(i), other = high / direction(i);
    enters = std::max(enters, std::min(one, other));
    leaves = std::min(leaves, std::max(one, other));
  }
  return enters <= leaves ? leaves : -1;
}

// Voxels with their middle in the box around the region, one by one, as seen or not.
class SeenVoxels {
 public:
  SeenVoxels(const BlockedVoxels& voxels, const InterestRegion& whole)
      : voxels_(voxels), region_(whole) {
    const Eigen::AlignedBox3d& region = whole.bounds();
    std::size_t count = 1;
    for (int i = 0; i < 3; ++i) {
      const VoxelGrid& grid = voxels.grid();
      const double lowest = std::clamp(region.min()(i), -grid.reach(), grid.reach());
      const double highest = std::clamp(region.max()(i), -grid.reach(), grid.reach());
      low_[i] = grid.index(lowest);
      if (grid.center(low_[i]) < lowest) ++low_[i];
      int high = grid.index(highest);
      if (grid.center(high) > highest) --high;
      size_[i] = std::max(0, high - low_[i] + 1);
      low_[i] -= voxels.first(i);
      count *= static_cast<std::size_t>(size_[i]);
    }
    seen_.assign(count, 0);
  }

  // Several threads may see the same voxel: all of them write the same.
  void see(const int at[3]) {
    std::size_t place = 0;
    for (int i = 2; i >= 0; --i) {
      const int k = at[i] - low_[i];
      if (k < 0 || k >= size_[i]) return;
      place = place * static_cast<std::size_t>(size_[i]) + static_cast<std::size_t>(k);
    }
    std::atomic_ref(seen_[place]).store(1, std::memory_order_relaxed);
  }
  // Of a region that is no box, those in one of its prisms.
  std::int64_t count() const {
    if (region_.is_box()) return std::count(seen_.begin(), seen_.end(), 1);
    const VoxelGrid& grid = voxels_.grid();
    std::int64_t count = 0;
    std::size_t place = 0;
    for (int z = 0; z < size_[2]; ++z)
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x)
          if (seen_[place++])
            count += region_.contains({grid.center(voxels_.first(0) + low_[0] + x),
                                       grid.center(voxels_.first(1) + low_[1] + y),
                                       grid.center(voxels_.first(2) + low_[2] + z)});
    return count;
  }

 private:
  const BlockedVoxels& voxels_;
  const InterestRegion& region_;
  int low_[3], size_[3];
  std::vector<char> seen_;
};

// `edge`: of a voxel. Those with their middle in the region lie within half of it.
void look(const PlannedView& view, const ScanTask& scan, const SeeThrough& space, double edge,
          SeenVoxels& seen) {
  const Eigen::Vector3d ahead = ahead_of(view.yaw, view.pitch);
  const Eigen::Vector3d right(std::sin(view.yaw), -std::cos(view.yaw), 0);
  const Eigen::Vector3d down = ahead.cross(right);
  const Pinhole& camera = scan.camera;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d way = ahead + (x - camera.principal_x) / camera.focal_x * right +
                                  (y - camera.principal_y) / camera.focal_y * down;
      const Eigen::Vector3d direction = way.normalized();
      const double reach = reach_of(view.position, direction, scan.region.bounds(), edge);
      int hit[3];
      if (space.meet(view.position, direction, std::min(scan.range, reach), hit)) seen.see(hit);
    }
}

}  // namespace

std::int64_t count_seen(const BlockedVoxels& voxels, const ScanTask& scan,
                        std::span<const PlannedView> views,
                        const std::function<void(double)>& done) {
  const SeeThrough space(voxels);
  SeenVoxels seen(voxels, scan.region);
  std::atomic<std::size_t> looked = 0;
  parallel_for(views.size(), 0, [&](std::size_t i) {
    look(views[i], scan, space, voxels.grid().resolution(), seen);
    if (done) done(static_cast<double>(++looked) / static_cast<double>(views.size()));
  });
  return seen.count();
}

}  // namespace lapwing
