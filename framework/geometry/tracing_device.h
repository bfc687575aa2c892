// SPDX-License-Identifier: Apache-2.0
// Embree's device, one for the process. Internal to this room.
#pragma once

struct RTCDeviceTy;
struct RTCSceneTy;

namespace lapwing {

// Throws Error when Embree cannot be used on this machine. It is not told how many threads to use:
// it would cap those of the whole process.
RTCDeviceTy* tracing_device();

// Builds the scene on the calling thread alone, which keeps runs repeatable. Throws Error when
// anything since its creation failed, and has then released it; `what` was to be built.
void commit(RTCSceneTy* scene, const char* what);

}  // namespace lapwing
