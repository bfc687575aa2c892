// SPDX-License-Identifier: Apache-2.0
// How one scan becomes 64-bit words of measured and hit voxels:
//   1. find_box: the box of voxels that the rays can touch, aligned to bricks of 16 voxels. It gets
//      one byte per voxel. If it is too large for memory, a hash table of bricks is used instead
//      (sparse_marks.h).
//   2. discretise (mode `discretised`): keep one end per voxel, its centre. The byte kSeen notes
//      voxels that have one.
//   3. mark_rays writes kPassed into every voxel that a ray passes, on several threads. All write
//      the same value, so their order has no effect. The voxel of the origin is common to all rays
//      and is written once, at the end.
//   4. mark_hits writes kHit over it: a hit outweighs passes, and each voxel counts once.
//   5. find_bricks lists the bricks with a mark. A large box has one more byte per 4096 voxels
//      (`pages`), so that empty parts are skipped and their memory is never touched.
//   6. take packs the bytes of a brick into words: bit 7 of a byte is "measured", bit 6 is "hit".
// Four rays are walked side by side. A lane without a ray writes to `parking`, a byte that nobody
// reads, because that is cheaper than a branch.
#include "plugins/maps/brick/scan_marks.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "framework/core/parallel.h"
#include "plugins/maps/brick/ray_lanes.h"

namespace lapwing::brick_map {
namespace {

constexpr std::uint8_t kSeen = 1;  // an end voxel that has its ray
constexpr std::size_t kKept = 4u << 20, kSpare = 64;
constexpr std::size_t kMostBytes = std::size_t{1} << 29;
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

std::span<const ScanMarks::Corner> ScanMarks::mark(std::span<const Eigen::Vector3f> points_W,
                                                   const Eigen::Vector3f& origin_W, int threads) {
  find_box(points_W, origin_W);
  make_room();
  std::span<const Eigen::Vector3f> ends = points_W;
  if (settings_.mode == IntegrationMode::discretised) {
    discretise(points_W);
    ends = ends_;
  }
  if (is_sparse_) {
    mark_sparse(ends, origin_W);
    return found_;
  }
  const RayOrigin origin(grid_, origin_W);
  const MarkTarget target{marks_.get(),
                          pages_.get(),
                          {stride_[0], stride_[1], stride_[2]},
                          offset(origin.cell()),
                          stride_[2] * size_[2]};
  std::atomic<bool> passed = false;  // rays within one voxel pass nothing, not even that
  parallel_for((ends.size() + kRaysAPart - 1) / kRaysAPart, threads, [&](std::size_t part) {
    std::array<Eigen::Vector3f, kRaysAPart> rays;
    const std::size_t first = part * kRaysAPart, count = std::min(kRaysAPart, ends.size() - first);
    std::copy_n(ends.begin() + static_cast<std::ptrdiff_t>(first), count, rays.begin());
    bool any = false;
    for (std::size_t k = 0; k < count; ++k) {
      clip(rays[k], origin_W);
      any = any || !origin.holds(rays[k]);
    }
    if (any) passed.store(true, std::memory_order_relaxed);
    mark_rays(origin, {rays.data(), count}, target);
  });
  if (passed) {
    marks_[target.first] = kPassed;
    note_page(target.first);
  }
  marks_[target.parking] = 0;
  mark_hits(ends, origin_W);
  find_bricks();
  return found_;
}

void ScanMarks::mark_sparse(std::span<const Eigen::Vector3f> ends_W,
                            const Eigen::Vector3f& origin_W) {
  const RayOrigin origin(grid_, origin_W);
  sparse_.clear();
  for (Eigen::Vector3f end : ends_W) {
    const bool hits = clip(end, origin_W);
    sparse_.mark_ray(origin, end);
    const int cell[3] = {grid_.index(end.x()), grid_.index(end.y()), grid_.index(end.z())};
    if (hits) sparse_.mark_hit(cell);
  }
  found_.clear();
  for (const auto& [key, marks] : sparse_.bricks())
    found_.push_back({{marks.cell[0], marks.cell[1], marks.cell[2]}});
  // The order of a hash table is nobody's.
  std::sort(found_.begin(), found_.end(), [](const Corner& a, const Corner& b) {
    return std::lexicographical_compare(a.cell, a.cell + 3, b.cell, b.cell + 3);
  });
}

void ScanMarks::mark_hits(std::span<const Eigen::Vector3f> ends_W,
                          const Eigen::Vector3f& origin_W) {
  for (Eigen::Vector3f end : ends_W) {
    if (!clip(end, origin_W)) continue;
    const int cell[3] = {grid_.index(end.x()), grid_.index(end.y()), grid_.index(end.z())};
    const std::int64_t at = offset(cell);
    marks_[at] = kHit;
    note_page(at);
  }
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
  is_sparse_ = needed > std::min(kMostBytes, settings_.memory_limit);
  if (needed <= room_ || is_sparse_) return;
  room_ = 0;
  marks_.reset();
  // Zero, and where it is large only there once it is touched.
  marks_.reset(static_cast<std::uint8_t*>(std::calloc(needed, 1)));
  pages_.reset(needed > kKept
                   ? static_cast<std::uint8_t*>(std::calloc((needed >> kPageShift) + 1, 1))
                   : nullptr);
  if (!marks_ || (needed > kKept && !pages_)) throw std::bad_alloc();
  room_ = needed;
}

void ScanMarks::discretise(std::span<const Eigen::Vector3f> points_W) {
  ends_.clear();
  for (const Eigen::Vector3f& p : points_W) {
    const int cell[3] = {grid_.index(p.x()), grid_.index(p.y()), grid_.index(p.z())};
    const bool in_box = cell[0] >= base_[0] && cell[0] < base_[0] + size_[0] &&
                        cell[1] >= base_[1] && cell[1] < base_[1] + size_[1] &&
                        cell[2] >= base_[2] && cell[2] < base_[2] + size_[2];
    if (in_box && !is_sparse_) {
      const std::int64_t at = offset(cell);
      if (marks_[at] == kSeen) continue;
      marks_[at] = kSeen;
      note_page(at);
    }
    ends_.push_back({static_cast<float>(grid_.center(cell[0])),
                     static_cast<float>(grid_.center(cell[1])),
                     static_cast<float>(grid_.center(cell[2]))});
  }
}

// Beyond the maximum range a ray clears up to it and hits nothing.
bool ScanMarks::clip(Eigen::Vector3f& end_W, const Eigen::Vector3f& origin_W) const {
  if (!std::isfinite(settings_.maximum_range)) return true;
  const float x = end_W.x() - origin_W.x(), y = end_W.y() - origin_W.y(),
              z = end_W.z() - origin_W.z();
  const float squared = x * x + y * y + z * z;
  const double distance = std::sqrt(static_cast<double>(squared));
  if (distance <= settings_.maximum_range) return true;
  const float length = static_cast<float>(distance);
  const float range = static_cast<float>(settings_.maximum_range);
  end_W = {origin_W.x() + x / length * range, origin_W.y() + y / length * range,
           origin_W.z() + z / length * range};
  return false;
}

void ScanMarks::find_bricks() {
  found_.clear();
  const int across = size_[0] / 16;
  std::vector<std::uint8_t> touched(static_cast<std::size_t>(across));
  for (int bz = 0; bz < size_[2]; bz += 16)
    for (int by = 0; by < size_[1]; by += 16) {
      bool any = false;
      for (int z = bz; z < bz + 16; ++z)
        for (int y = by; y < by + 16; ++y) any |= touch(y, z, touched);
      if (!any) continue;
      for (int bx = 0; bx < across; ++bx) {
        if (touched[bx]) found_.push_back({{base_[0] + 16 * bx, base_[1] + by, base_[2] + bz}});
        touched[bx] = 0;
      }
    }
}

// Notes which sixteens of a row have a mark; false for none.
bool ScanMarks::touch(int y, int z, std::vector<std::uint8_t>& touched) const {
  const std::int64_t row = stride_[1] * y + stride_[2] * z, last = row + stride_[1] - 1;
  bool any = !pages_;
  for (std::int64_t page = row >> kPageShift; !any && page <= last >> kPageShift; ++page)
    any = pages_[page];
  if (!any) return false;
  const std::uint8_t* at = marks_.get() + row;
  for (std::uint8_t& mark : touched) {
    std::uint64_t bytes[2];
    std::memcpy(bytes, at, 16);
    mark |= (bytes[0] | bytes[1]) != 0;
    at += 16;
  }
  return true;
}

BrickMarks ScanMarks::take(const Corner& corner, bool clear) {
  if (is_sparse_) return sparse_.at(corner.cell);
  BrickMarks marks;
  std::copy_n(corner.cell, 3, marks.cell);
  std::uint8_t* const first = marks_.get() + offset(corner.cell);
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y) {
      std::uint8_t* row = first + stride_[1] * y + stride_[2] * z;
      add_row(row, y, z, marks);
      if (clear) std::memset(row, 0, 16);
    }
  for (int chunk = 0; chunk < 64; ++chunk)
    if (marks.measured[chunk]) marks.chunks |= std::uint64_t{1} << chunk;
  return marks;
}

void ScanMarks::finish() {
  sparse_.clear();
  if (room_ <= kKept) return;
  marks_.reset();
  pages_.reset();
  room_ = 0;
}

std::size_t ScanMarks::bytes() const {
  return room_ + ends_.capacity() * sizeof(Eigen::Vector3f) + found_.capacity() * sizeof(Corner);
}

}  // namespace lapwing::brick_map
