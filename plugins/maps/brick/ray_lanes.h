// Rays of one scan, four at a time, marking the voxels that they pass.
#pragma once

#include <cstdint>
#include <span>

#include "plugins/maps/brick/octomap_ray.h"

namespace lapwing::brick_map {

inline constexpr std::uint8_t kPassed = 0x80, kHit = 0xc0;

// The bytes of a box of voxels. `first` is the byte of the ray's first voxel, `last[i]` and
// `stride[i]` what a step along axis i adds; `parking` is a byte that nobody reads.
struct MarkTarget {
  std::uint8_t* marks;
  std::int64_t stride[3];
  std::int64_t first, parking;
};

// Marks what rays to each of `ends_W` pass, but for the voxel that each starts in. Several threads
// may mark in the same bytes.
void mark_rays(const RayOrigin& origin, std::span<const Eigen::Vector3f> ends_W,
               const MarkTarget& target);

}  // namespace lapwing::brick_map
