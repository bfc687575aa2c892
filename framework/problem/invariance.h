// SPDX-License-Identifier: Apache-2.0
// What a cost term or a constraint may declare of itself, and is then held to by the checks of
// plugins: that its answers stay the same when all its inputs are moved together. Obstacles,
// subjects and what its parameters name stay where they are.
//
//   static std::span<const Extension> extensions() {
//     static const Extension all[] = {{kInvariantToTranslation, nullptr},
//                                     {kInvariantToTime, nullptr}};
//     return all;
//   }
//
// "The same" means for a cost the length of its residuals, whose parts may turn with the world; for
// a constraint how far its results are from what its bounds allow.
#pragma once

namespace lapwing {

// Everything is moved aside and up: blocks `position` and `target`.
inline constexpr const char* kInvariantToTranslation = "invariant_to_translation";
// Everything is turned about the world's vertical: places, `velocity`, `force`, `yaw`,
// `orientation`.
inline constexpr const char* kInvariantToRotationAboutZ = "invariant_to_rotation_about_z";
// Everything happens later: block `time`, and any instance in place of any other.
inline constexpr const char* kInvariantToTime = "invariant_to_time";

}  // namespace lapwing
