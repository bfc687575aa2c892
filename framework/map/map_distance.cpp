// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map_distance.h"

#include <cmath>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr float kFar = 1e12f;  // voxels squared; more than any map has

// Along a line of voxels: from the middle of one to the cube of another, squared.
float gap(int apart) {
  const float beyond = static_cast<float>(std::abs(apart)) - 0.5f;
  return beyond <= 0 ? 0 : beyond * beyond;
}

// result[x] = min over q of gap(x - q) + value[q]. The gap is convex, so that of two places the
// later one, once it is nearer, stays so: one pass finds which place each stretch is nearest to.
class Line {
 public:
  explicit Line(int size)
      : values_(static_cast<std::size_t>(size)),
        places_(values_.size()),
        from_(values_.size()),
        size_(size) {}

  void run(float* line, std::ptrdiff_t stride) {
    int count = 0;
    for (int q = 0; q < size_; ++q) {
      values_[q] = line[q * stride];
      if (values_[q] >= kFar) continue;
      while (count > 0 && first_nearer(places_[count - 1], q) <= from_[count - 1]) --count;
      const int from = count == 0 ? 0 : first_nearer(places_[count - 1], q);
      if (from >= size_) continue;
      places_[count] = q;
      from_[count++] = from;
    }
    if (count == 0) return;
    for (int x = size_ - 1, k = count - 1; x >= 0; --x) {
      while (from_[k] > x) --k;
      line[x * stride] = gap(x - places_[k]) + values_[places_[k]];
    }
  }

 private:
  // The first x at which place q is nearer than the earlier place p; size_ where it never is.
  int first_nearer(int p, int q) const {
    const auto nearer = [&](int x) { return gap(x - q) + values_[q] < gap(x - p) + values_[p]; };
    int low = 0, high = size_;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (nearer(middle))
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  }

  std::vector<float> values_;
  std::vector<int> places_, from_;
  int size_;
};

}  // namespace

// In place: 0 where the things are to which the distance is wanted, kFar elsewhere.
void MapDistance::transform(const Region& region, std::vector<float>& squared) {
  const std::ptrdiff_t stride[3] = {1, region.size[0],
                                    static_cast<std::ptrdiff_t>(region.size[0]) * region.size[1]};
  for (int axis = 0; axis < 3; ++axis) {
    Line line(region.size[axis]);
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int i = 0; i < region.size[a]; ++i)
      for (int j = 0; j < region.size[b]; ++j)
        line.run(squared.data() + i * stride[a] + j * stride[b], stride[axis]);
  }
}

MapDistance::MapDistance(const Map& map, const Eigen::Vector3d& lower_W,
                         const Eigen::Vector3d& upper_W, double reach)
    : grid_(map.grid()), reach_(reach) {
  if (!grid_.contains(lower_W) || !grid_.contains(upper_W) ||
      (lower_W.array() >= upper_W.array()).any())
    throw InputError(
        "a distance field needs a box inside the largest map, its lower corner below "
        "its upper one");
  if (!(reach > 0) || !std::isfinite(reach))
    throw InputError("the reach of a distance field must be positive and finite, not " +
                     std::to_string(reach) + " m");
  const int margin = static_cast<int>(std::ceil(std::min(reach * grid_.per_metre(), 1e5))) + 1;
  Region region;
  for (int i = 0; i < 3; ++i) {
    box_.low[i] = grid_.index(lower_W[i]) - 1;
    box_.size[i] = grid_.index(upper_W[i]) + 2 - box_.low[i];
    region.low[i] = box_.low[i] - margin;
    region.size[i] = box_.size[i] + 2 * margin;
  }
  if (region.count() > 500'000'000)
    throw InputError("a distance field over " + std::to_string(region.count()) +
                     " voxels, its reach around it included: at most 500 million");
  std::vector<float> to_blocked(region.count(), kFar), to_free(region.count(), kFar);
  std::vector<VoxelKey> keys(static_cast<std::size_t>(region.size[0]));
  std::vector<VoxelState> states(keys.size());
  const auto key = [](int v) {
    return static_cast<std::uint16_t>(std::clamp(v, 0, kKeyCount - 1));
  };
  std::size_t place = 0;
  for (int z = 0; z < region.size[2]; ++z)
    for (int y = 0; y < region.size[1]; ++y) {
      for (int x = 0; x < region.size[0]; ++x)
        keys[x] = {key(region.low[0] + x), key(region.low[1] + y), key(region.low[2] + z)};
      map.read_states(keys, states);
      for (const VoxelState state : states)
        (state == VoxelState::free ? to_free : to_blocked)[place++] = 0;
    }
  transform(region, to_blocked);
  transform(region, to_free);
  distances_.reserve(box_.count());
  for (int z = 0; z < box_.size[2]; ++z)
    for (int y = 0; y < box_.size[1]; ++y)
      for (int x = 0; x < box_.size[0]; ++x) {
        const std::size_t at =
            static_cast<std::size_t>(x + margin) +
            static_cast<std::size_t>(region.size[0]) *
                (static_cast<std::size_t>(y + margin) +
                 static_cast<std::size_t>(region.size[1]) * static_cast<std::size_t>(z + margin));
        const double outside = std::sqrt(to_blocked[at]), inside = std::sqrt(to_free[at]);
        const double voxels = to_blocked[at] > 0 ? outside : -inside;
        distances_.push_back(
            static_cast<float>(std::clamp(voxels * grid_.resolution(), -reach_, reach_)));
      }
}

double MapDistance::distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const {
  Eigen::Vector3d inside = p_W;
  double weight[3][2];
  int cell[3];
  for (int i = 0; i < 3; ++i) {
    const double low = grid_.face(box_.low[i] + 1);
    const double high = grid_.face(box_.low[i] + box_.size[i] - 1);
    inside[i] = std::clamp(p_W[i], low, high);
    const double voxels = (inside[i] - grid_.center(box_.low[i])) * grid_.per_metre();
    cell[i] = std::clamp(static_cast<int>(voxels), 0, box_.size[i] - 2);
    weight[i][1] = voxels - cell[i];
    weight[i][0] = 1 - weight[i][1];
  }
  double value = 0;
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (int k = 0; k < 8; ++k) {
    const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
    const double d = at(cell[0] + x, cell[1] + y, cell[2] + z);
    value += weight[0][x] * weight[1][y] * weight[2][z] * d;
    slope.x() += (x ? 1 : -1) * weight[1][y] * weight[2][z] * d;
    slope.y() += (y ? 1 : -1) * weight[0][x] * weight[2][z] * d;
    slope.z() += (z ? 1 : -1) * weight[0][x] * weight[1][y] * d;
  }
  slope *= grid_.per_metre();
  const Eigen::Vector3d way = p_W - inside;
  const double away = way.norm();
  if (gradient) {
    *gradient = slope;
    for (int i = 0; i < 3; ++i)
      if (away > 0 && way[i] != 0) (*gradient)[i] = -way[i] / away;
  }
  return value - away;
}

}  // namespace lapwing
