// SPDX-License-Identifier: Apache-2.0
// Rays of one scan, four at a time, marking the voxels that they pass.
#pragma once

#include <cstdint>
#include <span>

#include "plugins/maps/brick/octomap_ray.h"

namespace lapwing::brick_map {

inline constexpr std::uint8_t kPassed = 0x80, kHit = 0xc0;

// A byte for every voxel of a box, and one for every 4096 of those that is set when one of them is;
// `pages` may be null.
inline constexpr int kPageShift = 12;
struct MarkTarget {
  std::uint8_t *marks, *pages;
  std::int64_t stride[3];  // what a step along an axis adds
  std::int64_t first;      // the byte of the voxel that all rays start in
  std::int64_t parking;    // one that nobody reads
};

// Marks what rays to each of `ends_W` pass, but for the voxel that they start in. Several threads
// may mark in the same bytes.
void mark_rays(const RayOrigin& origin, std::span<const Eigen::Vector3f> ends_W,
               const MarkTarget& target);

}  // namespace lapwing::brick_map
