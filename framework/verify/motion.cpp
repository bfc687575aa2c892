// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/motion.h"

#include "framework/verify/motions/motion_integrator.h"

namespace lapwing {

Motion::Motion(const Trajectory& trajectory, const Vehicle& vehicle)
    : trajectory_(trajectory), integrator_(integrator_of(trajectory, vehicle)) {}

Motion::~Motion() = default;

double Motion::steps(std::size_t interval) const {
  return integrator_->steps(trajectory_.samples[interval], trajectory_.samples[interval + 1]);
}

double Motion::total_steps() const {
  double total = 0;
  for (std::size_t i = 0; i < intervals(); ++i) total += steps(i);
  return total;
}

MotionPoint Motion::stated(std::size_t index) const {
  return integrator_->stated(trajectory_.samples[index]);
}

std::span<const MotionPoint> Motion::integrate(std::size_t interval) {
  if (watcher_) watcher_(interval);
  points_.clear();
  integrator_->integrate(trajectory_.samples[interval], trajectory_.samples[interval + 1],
                         static_cast<std::size_t>(steps(interval)), points_);
  return points_;
}

}  // namespace lapwing
