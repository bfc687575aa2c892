// SPDX-License-Identifier: Apache-2.0
// Straight lines at even speed from sample to sample, yaw and gimbal likewise.
#include <cmath>

#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

class PathIntegrator final : public MotionIntegrator {
 public:
  double steps(const Sample& a, const Sample& b) const override {
    return std::ceil(std::max(1.0, (b.time - a.time) / tolerances::kStepMaximum));
  }

  MotionPoint stated(const Sample& s) const override {
    return {.time = s.time,
            .position = s.position,
            .yaw = s.yaw,
            .gimbal_yaw = s.gimbal_yaw,
            .gimbal_pitch = s.gimbal_pitch};
  }

  void integrate(const Sample& a, const Sample& b, std::size_t count,
                 std::vector<MotionPoint>& points) const override {
    const double h = b.time - a.time;
    for (std::size_t k = 0; k <= count; ++k) {
      const double s = static_cast<double>(k) / static_cast<double>(count);
      points.push_back({.time = k == count ? b.time : a.time + s * h,
                        .position = a.position + s * (b.position - a.position),
                        .velocity = (b.position - a.position) / h,
                        .yaw = a.yaw + s * (b.yaw - a.yaw),
                        .yaw_rate = (b.yaw - a.yaw) / h,
                        .gimbal_yaw = a.gimbal_yaw + s * (b.gimbal_yaw - a.gimbal_yaw),
                        .gimbal_pitch = a.gimbal_pitch + s * (b.gimbal_pitch - a.gimbal_pitch),
                        .gimbal_yaw_rate = (b.gimbal_yaw - a.gimbal_yaw) / h,
                        .gimbal_pitch_rate = (b.gimbal_pitch - a.gimbal_pitch) / h});
    }
  }
};

}  // namespace

KnownMotion path_integrator() {
  return {"path",
          {},
          [](const Trajectory&, const Vehicle&) -> std::unique_ptr<MotionIntegrator> {
            return std::make_unique<PathIntegrator>();
          },
          [](const Vehicle&) -> std::string { return ""; }};
}

}  // namespace lapwing
