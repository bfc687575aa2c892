// SPDX-License-Identifier: Apache-2.0
#include "framework/map/sky_columns.h"

#include <array>

#include "framework/core/error.h"
#include "framework/map/ray_walk.h"

namespace lapwing {
namespace {

constexpr std::int64_t kMostColumns = std::int64_t{1} << 28;
constexpr int kTopLevel = 10;  // of cubes that are tried first

// Of square blocks of columns: the lowest and the highest top, and whether all or any are known.
struct ColumnBlock {
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest = std::numeric_limits<std::int32_t>::min();
  bool all = true, any = false;

  void join(const ColumnBlock& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
    all = all && other.all;
    any = any || other.any;
  }
};

// Blocks of all sizes, aligned as cubes of a map are.
class BlockPyramid {
 public:
  explicit BlockPyramid(const SkyColumns& columns) {
    const int edge = 1 << kTopLevel;
    x_ = columns.x() / edge * edge;
    y_ = columns.y() / edge * edge;
    width_ = (columns.x() + columns.width() - x_ + edge - 1) / edge * edge;
    depth_ = (columns.y() + columns.depth() - y_ + edge - 1) / edge * edge;
    levels_[0].resize(size(0));
    for (int y = 0; y < depth_; ++y)
      for (int x = 0; x < width_; ++x) {
        const std::int32_t top = columns.top(x_ + x, y_ + y);
        ColumnBlock& block = levels_[0][place(0, x, y)];
        block.all = block.any = top != SkyColumns::kUnknown;
        if (block.any) block.lowest = block.highest = top;
      }
    for (int level = 1; level <= kTopLevel; ++level) {
      levels_[static_cast<std::size_t>(level)].resize(size(level));
      for (int y = 0; y < depth_ >> (level - 1); ++y)
        for (int x = 0; x < width_ >> (level - 1); ++x)
          levels_[static_cast<std::size_t>(level)][place(level, x >> 1, y >> 1)].join(
              levels_[static_cast<std::size_t>(level - 1)][place(level - 1, x, y)]);
    }
  }

  int x() const { return x_; }
  int y() const { return y_; }
  int width() const { return width_; }
  int depth() const { return depth_; }
  const ColumnBlock& block(int level, int x, int y) const {
    return levels_[static_cast<std::size_t>(level)]
                  [place(level, (x - x_) >> level, (y - y_) >> level)];
  }

 private:
  std::size_t size(int level) const {
    return static_cast<std::size_t>(width_ >> level) * static_cast<std::size_t>(depth_ >> level);
  }
  std::size_t place(int level, int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ >> level) +
           static_cast<std::size_t>(x);
  }

  int x_, y_, width_, depth_;
  std::array<std::vector<ColumnBlock>, kTopLevel + 1> levels_;
};

// Cuts the space between two heights into the largest cubes that lie wholly above the tops of their
// columns, or wholly not above them.
class CubeCutter {
 public:
  CubeCutter(const SkyColumns& columns, bool above, int low, int high)
      : blocks_(columns), above_(above), low_(low), high_(high) {}

  std::vector<VoxelLeaf> cut() {
    const int edge = 1 << kTopLevel;
    for (int y = blocks_.y(); y < blocks_.y() + blocks_.depth(); y += edge)
      for (int x = blocks_.x(); x < blocks_.x() + blocks_.width(); x += edge)
        for (int z = low_ / edge * edge; z <= high_; z += edge) cut(kTopLevel, x, y, z);
    return std::move(leaves_);
  }

 private:
  void cut(int level, int x, int y, int z) {
    const int last = z + (1 << level) - 1;
    if (last < low_ || z > high_) return;
    const ColumnBlock& block = blocks_.block(level, x, y);
    if (!block.any) return;
    if (above_ ? last <= block.lowest : z > block.highest) return;
    const bool between = z >= low_ && last <= high_;
    if (block.all && between && (above_ ? z > block.highest : last <= block.lowest)) {
      constexpr float kSure = std::numeric_limits<float>::infinity();
      leaves_.push_back({{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                          static_cast<std::uint16_t>(z)},
                         static_cast<std::uint8_t>(level),
                         0,
                         above_ ? -kSure : kSure});
      return;
    }
    if (level == 0) return;
    const int half = 1 << (level - 1);
    for (int child = 0; child < 8; ++child)
      cut(level - 1, x + (child & 1) * half, y + (child >> 1 & 1) * half, z + (child >> 2) * half);
  }

  BlockPyramid blocks_;
  bool above_;
  int low_, high_;
  std::vector<VoxelLeaf> leaves_;
};

// One bit for every voxel of a box.
class VoxelBits {
 public:
  VoxelBits(const std::array<int, 3>& low, const std::array<int, 3>& high) : low_(low) {
    double count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      size_[i] = static_cast<std::size_t>(high[i] - low[i] + 1);
      count *= static_cast<double>(size_[i]);
    }
    if (count > 0x1p34)
      throw InputError(
          "the box around the cloud and its scanners has more than 2^34 voxels: "
          "choose a larger resolution or a smaller region");
    bits_.resize((size_[0] * size_[1] * size_[2] + 63) / 64);
  }
  bool inside(const int (&cell)[3]) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (cell[i] < low_[i] || static_cast<std::size_t>(cell[i] - low_[i]) >= size_[i])
        return false;
    return true;
  }
  bool at(const int (&cell)[3]) const { return bits_[place(cell) / 64] >> place(cell) % 64 & 1; }
  void set(const int (&cell)[3]) {
    bits_[place(cell) / 64] |= std::uint64_t{1} << place(cell) % 64;
  }

  // In the order of keys: x slowest.
  std::vector<VoxelKey> keys() const {
    std::vector<VoxelKey> keys;
    for (std::size_t word = 0; word < bits_.size(); ++word)
      for (std::uint64_t bits = bits_[word]; bits != 0; bits &= bits - 1) {
        const std::size_t k = 64 * word + static_cast<std::size_t>(__builtin_ctzll(bits));
        const std::size_t z = k % size_[2], y = k / size_[2] % size_[1],
                          x = k / size_[2] / size_[1];
        keys.push_back({static_cast<std::uint16_t>(low_[0] + static_cast<int>(x)),
                        static_cast<std::uint16_t>(low_[1] + static_cast<int>(y)),
                        static_cast<std::uint16_t>(low_[2] + static_cast<int>(z))});
      }
    return keys;
  }

 private:
  std::size_t place(const int (&cell)[3]) const {
    return (static_cast<std::size_t>(cell[0] - low_[0]) * size_[1] +
            static_cast<std::size_t>(cell[1] - low_[1])) *
               size_[2] +
           static_cast<std::size_t>(cell[2] - low_[2]);
  }

  std::array<int, 3> low_;
  std::array<std::size_t, 3> size_{};
  std::vector<std::uint64_t> bits_;
};

}  // namespace

SkyColumns::SkyColumns(int x, int y, int width, int depth)
    : x_(x), y_(y), width_(width), depth_(depth) {
  const std::int64_t count = static_cast<std::int64_t>(width) * depth;
  if (width < 0 || depth < 0 || count > kMostColumns)
    throw InputError(
        "the surface has more than 2^28 columns of voxels: choose a larger "
        "resolution or a smaller region");
  tops_.assign(static_cast<std::size_t>(count), kUnknown);
}

SkyColumns SkyColumns::over(std::span<const VoxelKey> occupied) {
  if (occupied.empty()) return {0, 0, 0, 0};
  int low_x = kKeyCount, low_y = kKeyCount, high_x = 0, high_y = 0;
  for (const VoxelKey& key : occupied) {
    low_x = std::min<int>(low_x, key.x);
    low_y = std::min<int>(low_y, key.y);
    high_x = std::max<int>(high_x, key.x);
    high_y = std::max<int>(high_y, key.y);
  }
  SkyColumns columns(low_x, low_y, high_x - low_x + 1, high_y - low_y + 1);
  for (const VoxelKey& key : occupied) {
    std::int32_t& top = columns.tops_[columns.place(key.x, key.y)];
    top = std::max<std::int32_t>(top, key.z);
  }
  return columns;
}

std::int32_t SkyColumns::top(int x, int y) const {
  if (x < x_ || y < y_ || x >= x_ + width_ || y >= y_ + depth_) return kUnknown;
  return tops_[place(x, y)];
}

void SkyColumns::set_top(int x, int y, std::int32_t top) {
  if (x < x_ || y < y_ || x >= x_ + width_ || y >= y_ + depth_)
    throw Error("a column outside of those that there are");
  tops_[place(x, y)] = top;
}

std::vector<VoxelLeaf> SkyColumns::free_above(int ceiling) const {
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t top : tops_)
    if (top != kUnknown) lowest = std::min(lowest, top);
  if (lowest >= ceiling) return {};
  return CubeCutter(*this, true, std::max(lowest, 0), std::min(ceiling, kKeyCount - 1)).cut();
}

std::vector<VoxelLeaf> SkyColumns::solid_below(int floor) const {
  std::int32_t highest = kUnknown;
  for (const std::int32_t top : tops_) highest = std::max(highest, top);
  if (highest == kUnknown || highest < floor) return {};
  return CubeCutter(*this, false, std::max(floor, 0), std::min(highest, kKeyCount - 1)).cut();
}

std::vector<VoxelKey> free_from_scanners(std::span<const VoxelKey> measured,
                                         std::span<const VoxelKey> occupied,
                                         std::span<const Eigen::Vector3d> scanners,
                                         const VoxelGrid& grid, double range) {
  if (measured.empty() || scanners.empty()) return {};
  std::array<int, 3> low{kKeyCount, kKeyCount, kKeyCount}, high{0, 0, 0};
  const auto extend = [&](const VoxelKey& key) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      low[i] = std::min<int>(low[i], key[axis]);
      high[i] = std::max<int>(high[i], key[axis]);
    }
  };
  for (const VoxelKey& key : measured) extend(key);
  for (const VoxelKey& key : occupied) extend(key);
  for (const Eigen::Vector3d& p : scanners) {
    if (!grid.contains(p)) throw InputError("a scanner lies outside of the largest map");
    extend(grid.key(p));
  }
  VoxelBits solid(low, high), free(low, high);
  for (const VoxelKey& key : occupied) solid.set({key.x, key.y, key.z});
  for (const VoxelKey& key : measured) {
    const Eigen::Vector3d middle = grid.center(key);
    const Eigen::Vector3d* nearest = &scanners[0];
    for (const Eigen::Vector3d& p : scanners)
      if ((p - middle).squaredNorm() < (*nearest - middle).squaredNorm()) nearest = &p;
    const Eigen::Vector3d way = middle - *nearest;
    const double length = way.norm();
    if (length > range || length == 0) continue;
    RayWalk walk(grid, *nearest, way / length);
    while (walk.entered < length && solid.inside(walk.cell) && !solid.at(walk.cell)) {
      free.set(walk.cell);
      walk.advance();
    }
  }
  return free.keys();
}

}  // namespace lapwing
