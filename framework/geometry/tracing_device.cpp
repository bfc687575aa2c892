// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/tracing_device.h"

#include <embree3/rtcore.h>

#include <new>
#include <string>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/core/portable.h"

namespace lapwing {

RTCDeviceTy* tracing_device() {
  static const RTCDevice shared =
      rtcNewDevice(is_portable() ? "set_affinity=0,isa=sse2" : "set_affinity=0");
  // The library forgets the reason once it was asked for.
  static const RTCError reason = shared ? RTC_ERROR_NONE : rtcGetDeviceError(nullptr);
  if (reason == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!shared) {
    throw Error("Embree cannot be used on this machine (error " +
                std::to_string(static_cast<int>(reason)) + ")");
  }
  return shared;
}

void commit(RTCSceneTy* scene, const char* what) {
  on_this_thread([scene] { rtcCommitScene(scene); });
  const RTCError error = rtcGetDeviceError(tracing_device());
  if (error == RTC_ERROR_NONE) return;
  rtcReleaseScene(scene);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error(std::string("Embree could not build ") + what + " (error " +
              std::to_string(static_cast<int>(error)) + ")");
}

}  // namespace lapwing
