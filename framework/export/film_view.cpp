// SPDX-License-Identifier: Apache-2.0
#include "framework/export/film_view.h"

#include <algorithm>

namespace lapwing {
namespace {

bool covers(const TimeSpan& span, double time) {
  return span.start <= time && time <= span.finish;
}

}  // namespace

CameraView view_of(const Sample& sample, const Pinhole& pinhole) {
  return {pinhole, sample.position,
          camera_axes(sample.yaw + sample.gimbal_yaw, sample.gimbal_pitch)};
}

bool in_cut(const Plan& plan, double time) {
  return std::any_of(plan.cuts.begin(), plan.cuts.end(),
                     [time](const TimeSpan& cut) { return covers(cut, time); });
}

std::vector<std::size_t> subjects_at(const Plan& plan, double time) {
  const auto& framing = plan.task.framing;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < plan.environment.subjects.size(); ++i) {
    const auto asks = [&](const FramingTask& task) {
      return task.subject == plan.environment.subjects[i].name && covers(task.span, time);
    };
    if (framing.empty() || std::any_of(framing.begin(), framing.end(), asks)) found.push_back(i);
  }
  return found;
}

}  // namespace lapwing
