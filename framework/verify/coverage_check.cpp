// SPDX-License-Identifier: Apache-2.0
// The images of a scan: whether the flight is where they are taken, and what of the region they
// see, by rays of this room's own through the map that the plan names.
#include <algorithm>
#include <atomic>

#include "framework/core/parallel.h"
#include "framework/verify/checks.h"

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

Eigen::Vector3d ahead_of(double yaw, double pitch) {
  return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
}

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

const BlockedVoxels& map_of_scan(const Flight& flight) {
  const auto& obstacles = flight.plan.environment.obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    if (obstacles[i].type == "map" && obstacles[i].name == flight.plan.task.scan->map)
      return *flight.shapes[i]->voxels();
  throw Error("a scan without its map passed the checks of the document");
}

// The motion at a time within the flight, straight between integrated points.
MotionPoint motion_at(Motion& motion, double time) {
  std::size_t low = 0, high = motion.intervals();
  while (low + 1 < high) {
    const std::size_t middle = (low + high) / 2;
    (motion.stated(middle).time <= time ? low : high) = middle;
  }
  if (motion.intervals() == 0) return motion.stated(0);
  const auto points = motion.integrate(low);
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (points[k].time < time && k + 1 < points.size()) continue;
    MotionPoint p = points[k - 1];
    const double h = points[k].time - p.time;
    const double share = h > 0 ? std::clamp((time - p.time) / h, 0.0, 1.0) : 0;
    p.position += share * (points[k].position - p.position);
    p.yaw += share * (points[k].yaw - p.yaw);
    p.gimbal_yaw += share * (points[k].gimbal_yaw - p.gimbal_yaw);
    p.gimbal_pitch += share * (points[k].gimbal_pitch - p.gimbal_pitch);
    return p;
  }
  return points.back();
}

}  // namespace

void list_scan_problems(const Plan& plan, std::vector<std::string>& problems) {
  const ScanTask& scan = *plan.task.scan;
  const auto add = [&](const std::string& text) { problems.push_back("the scan " + text); };
  const Eigen::AlignedBox3d& region = scan.region.bounds();
  if (!sound(region.min()) || !sound(region.max()) ||
      !(region.min().array() < region.max().array()).all())
    add("must have a region with its lower corner below its upper one");
  const Pinhole& camera = scan.camera;
  if (camera.width < 1 || camera.height < 1 || !(camera.focal_x > 0) || !(camera.focal_y > 0) ||
      !sound(camera.focal_x) || !sound(camera.focal_y) || !sound(camera.principal_x) ||
      !sound(camera.principal_y))
    add("must have a camera with pixels and focal lengths");
  if (!(scan.range > 0 && scan.range <= tolerances::kLongestRay))
    add("must have rays longer than 0 m and at most 1000 m");
  if (!(scan.tolerance > 0 && sound(scan.tolerance)) ||
      !(scan.angle_tolerance > 0 && sound(scan.angle_tolerance)))
    add("needs tolerances above 0");
  if (!(scan.seen_share > 0 && scan.seen_share <= 1) || scan.seen < 1)
    add("must state the number of seen voxels, and the share that must be seen again");
  if (scan.views.empty()) add("must have a view");
  if (static_cast<double>(camera.width) * camera.height * static_cast<double>(scan.views.size()) >
      tolerances::kMostRays)
    add("has more than 10^9 pixels in all");
  if (!find_obstacle(plan.environment, "map", scan.map))
    add("sees in a map '" + scan.map + "' that the environment does not name");
  const double finish = plan.trajectory.samples.empty() ? 0 : plan.trajectory.samples.back().time;
  for (std::size_t i = 0; i < scan.views.size(); ++i) {
    const PlannedView& view = scan.views[i];
    const std::string name = "'s view " + std::to_string(i + 1);
    if (!sound(view.time) || !sound(view.position) || !sound(view.yaw) || !sound(view.pitch))
      return add(name + " holds a number that is not finite or beyond 1e7");
    if (view.time < 0 || view.time > finish + tolerances::kSpanTime)
      return add(name + " is not within the flight");
    if (i > 0 && !(view.time > scan.views[i - 1].time))
      return add(name + " is not later than the one before it");
  }
}

void check_views(const Flight& flight, Certificate& certificate) {
  const auto& scan = flight.plan.task.scan;
  if (!scan) {
    for (const char* name : {"view_miss", "view_direction"})
      certificate.checks.push_back(skipped_check(name, "the task has no views"));
    return;
  }
  Worst miss("view_miss", scan->tolerance), direction("view_direction", scan->angle_tolerance);
  for (const PlannedView& view : scan->views) {
    const MotionPoint at = motion_at(flight.motion, view.time);
    miss.see((at.position - view.position).norm(), view.time);
    const Eigen::Vector3d flown = ahead_of(at.yaw + at.gimbal_yaw, at.gimbal_pitch);
    const Eigen::Vector3d wanted = ahead_of(view.yaw, view.pitch);
    direction.see(std::atan2(flown.cross(wanted).norm(), flown.dot(wanted)), view.time);
  }
  certificate.checks.push_back(miss.check());
  certificate.checks.push_back(direction.check());
}

void check_coverage(const Flight& flight, Certificate& certificate) {
  const auto& scan = flight.plan.task.scan;
  if (!scan) {
    certificate.checks.push_back(skipped_check("coverage", "the task has no region to cover"));
    return;
  }
  const BlockedVoxels& voxels = map_of_scan(flight);
  const SeeThrough space(voxels);
  const double edge = voxels.grid().resolution();
  SeenVoxels seen(voxels, scan->region);
  std::atomic<std::size_t> looked = 0;
  parallel_for(scan->views.size(), 0, [&](std::size_t i) {
    look(scan->views[i], *scan, space, edge, seen);
    flight.watch.done(static_cast<double>(++looked) / static_cast<double>(scan->views.size()));
  });
  const std::int64_t count = seen.count();
  Check check =
      judged(make_check("coverage"), static_cast<double>(count) / static_cast<double>(scan->seen),
             scan->seen_share, 0, scan->views.back().time, true);
  const std::string said =
      std::to_string(count) + " of the " + std::to_string(scan->seen) +
      " voxels that the plan states as seen by its views (not a share of the region)";
  check.detail = check.detail.empty() ? said : check.detail + "; " + said;
  certificate.checks.push_back(check);
}

}  // namespace lapwing
