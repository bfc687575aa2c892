#include "plugins/maps/brick/scan_marks.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

#include "framework/core/parallel.h"
#include "plugins/maps/brick/ray_lanes.h"

namespace lapwing::brick_map {
namespace {

constexpr std::uint8_t kSeen = 1;  // an end voxel that has its ray
constexpr std::size_t kKept = 16u << 20, kSpare = 64;
constexpr std::int64_t kMostBytes = std::int64_t{1} << 30;
constexpr std::size_t kRaysAPart = 512;

// Bit k of the result is bit `which` of byte k.
std::uint64_t gather(std::uint64_t bytes, int which) {
  return ((bytes >> which & 0x0101010101010101ull) * 0x0102040810204080ull) >> 56;
}

// Sixteen voxels along x, four of each of four chunks, into the chunks' words.
void add_row(const std::uint8_t* row, int y, int z, BrickMarks& marks) {
  std::uint64_t bytes[2];
  std::memcpy(bytes, row, 16);
  if ((bytes[0] | bytes[1]) == 0) return;
  const std::uint64_t measured = gather(bytes[0], 7) | gather(bytes[1], 7) << 8;
  const std::uint64_t hit = gather(bytes[0], 6) | gather(bytes[1], 6) << 8;
  const int chunk = (y >> 2) << 2 | (z >> 2) << 4, shift = (y & 3) << 2 | (z & 3) << 4;
  for (int x = 0; x < 4; ++x) {
    marks.measured[chunk + x] |= (measured >> 4 * x & 15) << shift;
    marks.hit[chunk + x] |= (hit >> 4 * x & 15) << shift;
  }
}

}  // namespace

std::span<const BrickMarks> ScanMarks::mark(std::span<const Eigen::Vector3f> points_W,
                                            const Eigen::Vector3f& origin_W, int threads) {
  find_box(points_W, origin_W);
  make_room();
  if (settings_.mode == IntegrationMode::discretised) {
    discretise(points_W);
    clip(ends_, origin_W);
  } else {
    clip(points_W, origin_W);
  }
  const RayOrigin origin(grid_, origin_W);
  MarkTarget target{marks_.get(),
                    {stride_[0], stride_[1], stride_[2]},
                    offset(origin.cell()),
                    stride_[2] * size_[2]};
  RayStart ray;
  if (std::any_of(rays_.begin(), rays_.end(),
                  [&](const Eigen::Vector3f& end) { return origin.start(end, ray); }))
    marks_[target.first] = kPassed;
  const std::size_t parts = (rays_.size() + kRaysAPart - 1) / kRaysAPart;
  parallel_for(threads > 1 ? parts : 1, threads, [&](std::size_t part) {
    const std::span<const Eigen::Vector3f> all(rays_);
    if (threads <= 1) return mark_rays(origin, all, target);
    const std::size_t first = part * kRaysAPart;
    mark_rays(origin, all.subspan(first, std::min(kRaysAPart, all.size() - first)), target);
  });
  marks_[target.parking] = 0;
  for (const std::int64_t hit : hits_) marks_[hit] = kHit;
  collect(threads);
  if (room_ > kKept) {
    marks_.reset();
    room_ = 0;
  }
  return found_;
}

// Rays lie between their ends; rounding takes them one voxel further at most.
void ScanMarks::find_box(std::span<const Eigen::Vector3f> points_W,
                         const Eigen::Vector3f& origin_W) {
  Eigen::Vector3f low = origin_W, high = origin_W;
  for (const Eigen::Vector3f& p : points_W) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double range = settings_.maximum_range + 2 * settings_.resolution;
  for (int i = 0; i < 3; ++i) {
    const int first = grid_.index(std::max<double>(low[i], origin_W[i] - range)) - 4;
    const int last = grid_.index(std::min<double>(high[i], origin_W[i] + range)) + 4;
    base_[i] = first & ~15;
    size_[i] = (last | 15) + 1 - base_[i];
  }
  stride_[0] = 1;
  stride_[1] = size_[0];
  stride_[2] = stride_[1] * size_[1];
}

void ScanMarks::make_room() {
  const std::size_t needed = static_cast<std::size_t>(stride_[2]) * size_[2] + kSpare;
  if (needed <= room_) return;
  marks_.reset();
  marks_.reset(static_cast<std::uint8_t*>(std::calloc(needed, 1)));
  room_ = marks_ ? needed : 0;
  if (!marks_) throw std::bad_alloc();
}

void ScanMarks::discretise(std::span<const Eigen::Vector3f> points_W) {
  ends_.clear();
  for (const Eigen::Vector3f& p : points_W) {
    const int cell[3] = {grid_.index(p.x()), grid_.index(p.y()), grid_.index(p.z())};
    const bool in_box = cell[0] >= base_[0] && cell[0] < base_[0] + size_[0] &&
                        cell[1] >= base_[1] && cell[1] < base_[1] + size_[1] &&
                        cell[2] >= base_[2] && cell[2] < base_[2] + size_[2];
    if (in_box) {
      std::uint8_t& mark = marks_[offset(cell)];
      if (mark == kSeen) continue;
      mark = kSeen;
    }
    ends_.push_back({static_cast<float>(grid_.center(cell[0])),
                     static_cast<float>(grid_.center(cell[1])),
                     static_cast<float>(grid_.center(cell[2]))});
  }
}

// Beyond the maximum range a ray clears up to it and hits nothing.
void ScanMarks::clip(std::span<const Eigen::Vector3f> ends_W, const Eigen::Vector3f& origin_W) {
  rays_.clear();
  hits_.clear();
  for (const Eigen::Vector3f& end : ends_W) {
    if (std::isfinite(settings_.maximum_range)) {
      const float x = end.x() - origin_W.x(), y = end.y() - origin_W.y(),
                  z = end.z() - origin_W.z();
      const float squared = x * x + y * y + z * z;
      const double distance = std::sqrt(static_cast<double>(squared));
      if (!(distance <= settings_.maximum_range)) {
        const float length = static_cast<float>(distance);
        const float range = static_cast<float>(settings_.maximum_range);
        rays_.push_back({origin_W.x() + x / length * range, origin_W.y() + y / length * range,
                         origin_W.z() + z / length * range});
        continue;
      }
    }
    const int cell[3] = {grid_.index(end.x()), grid_.index(end.y()), grid_.index(end.z())};
    rays_.push_back(end);
    hits_.push_back(offset(cell));
  }
}

// Takes the marks out of the bytes, which are zero again afterwards.
void ScanMarks::collect(int) {
  found_.clear();
  for (int bz = 0; bz < size_[2]; bz += 16)
    for (int by = 0; by < size_[1]; by += 16)
      for (int bx = 0; bx < size_[0]; bx += 16) {
        BrickMarks* marks = nullptr;
        for (int z = 0; z < 16; ++z)
          for (int y = 0; y < 16; ++y) {
            std::uint8_t* row = marks_.get() + bx + stride_[1] * (by + y) + stride_[2] * (bz + z);
            std::uint64_t bytes[2];
            std::memcpy(bytes, row, 16);
            if ((bytes[0] | bytes[1]) == 0) continue;
            if (!marks) {
              found_.emplace_back();
              marks = &found_.back();
              marks->cell[0] = base_[0] + bx;
              marks->cell[1] = base_[1] + by;
              marks->cell[2] = base_[2] + bz;
              std::fill_n(marks->measured, 64, 0);
              std::fill_n(marks->hit, 64, 0);
            }
            add_row(row, y, z, *marks);
            std::memset(row, 0, 16);
          }
        if (!marks) continue;
        for (int chunk = 0; chunk < 64; ++chunk)
          if (marks->measured[chunk]) marks->chunks |= std::uint64_t{1} << chunk;
        if (marks->chunks == 0) found_.pop_back();
      }
}

std::size_t ScanMarks::bytes() const {
  return room_ + (ends_.capacity() + rays_.capacity()) * sizeof(Eigen::Vector3f) +
         hits_.capacity() * sizeof(std::int64_t) + found_.capacity() * sizeof(BrickMarks);
}

}  // namespace lapwing::brick_map
