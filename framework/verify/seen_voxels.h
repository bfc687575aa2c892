// SPDX-License-Identifier: Apache-2.0
// What of a region views see in a map, by rays of this room's own.
//
// Internal to this room. World frame, metres.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>

#include "framework/trajectory/scan_task.h"
#include "framework/verify/blocked_voxels.h"

namespace lapwing {

// The direction of a view, level; rad.
inline Eigen::Vector3d ahead_of(double yaw, double pitch) {
  return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
}

// Voxels with their middle in the region of `scan` that any of the views sees, through every pixel
// of its camera. `done` is told the share of the views, from several threads; it may be empty, and
// what it throws ends the call.
std::int64_t count_seen(const BlockedVoxels& voxels, const ScanTask& scan,
                        std::span<const PlannedView> views,
                        const std::function<void(double)>& done = {});

}  // namespace lapwing
