// SPDX-License-Identifier: Apache-2.0
#include "framework/export/time_charts.h"

namespace lapwing {

std::vector<LimitLine> both_ways(double limit) {
  return {{"maximum", limit}, {"minimum", -limit}};
}

Axis time_axis() {
  return {"time", "s"};
}

TimeCharts::TimeCharts(const Plan& plan) : plan_(plan) {
  for (const Sample& s : plan.trajectory.samples) times_.push_back(s.time);
  for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
    markers_.push_back({std::to_string(i + 1), plan.task.keyframes[i].time});
  }
  for (const TimeSpan& cut : plan.cuts) cuts_.push_back({"cut", cut.start, cut.finish});
}

Chart TimeCharts::chart(const std::string& title, const std::string& label, const std::string& unit,
                        std::vector<Series> series, std::vector<LimitLine> limits) const {
  return {title,    time_axis(), Axis{label, unit}, std::move(series), std::move(limits),
          markers_, cuts_};
}

}  // namespace lapwing
