// SPDX-License-Identifier: Apache-2.0
#include "framework/export/shot_list.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/core/error.h"
#include "framework/export/camera_track.h"
#include "framework/export/film_view.h"
#include "framework/trajectory/gate_passage.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr double kRate = 20;      // 1/s
constexpr double kPassing = 100;  // 1/s, for gates
constexpr double kMissed = 0.1;   // m outside of a gate

bool within(const std::vector<TimeSpan>& spans, double time) {
  return std::any_of(spans.begin(), spans.end(), [time](const TimeSpan& span) {
    return span.start <= time && time < span.finish;
  });
}

std::vector<std::string> subjects_seen(const Plan& plan, const Pinhole& camera, double time) {
  std::vector<std::string> names;
  const CameraView view = view_of(sample_at(plan.trajectory, time), camera);
  for (std::size_t i = 0; i < plan.environment.subjects.size(); ++i) {
    const Subject& subject = plan.environment.subjects[i];
    if (!subject.filmed) continue;
    const auto pixel = view.project(subject.position(time));
    if (pixel && pixel->x() >= -0.5 && pixel->x() <= camera.width - 0.5 && pixel->y() >= -0.5 &&
        pixel->y() <= camera.height - 0.5)
      names.push_back(subject.name.empty() ? "subject " + std::to_string(i + 1) : subject.name);
  }
  return names;
}

}  // namespace

std::vector<Shot> shot_list(const Plan& plan, const std::string& format) {
  const auto& samples = plan.trajectory.samples;
  if (samples.size() < 2)
    throw InputError(format + ": the flight of '" + plan.mission + "' has no length");
  const double start = samples.front().time, finish = samples.back().time;
  if (!std::isfinite(start) || !(finish - start > 0 && finish - start < 1e5))
    throw InputError(format + ": expected a flight of at most 100000 s with increasing times");
  std::set<double> ends{start, finish};
  for (int i = 1; i < (finish - start) * kRate; ++i) ends.insert(start + i / kRate);
  for (const auto* spans : {&plan.cuts, &plan.lights})
    for (const TimeSpan& span : *spans)
      for (const double end : {span.start, span.finish})
        if (end > start && end < finish) ends.insert(end);
  std::vector<Shot> shots;
  const bool films = plan.trajectory.has_gimbal && !plan.environment.subjects.empty();
  const Pinhole camera = films ? filming_camera(plan, format) : Pinhole{};
  for (auto at = ends.begin(); std::next(at) != ends.end(); ++at) {
    Shot shot;
    shot.span = {*at, *std::next(at)};
    const double middle = (shot.span.start + shot.span.finish) / 2;
    shot.cut = within(plan.cuts, middle);
    shot.lit = within(plan.lights, middle);
    if (films) shot.subjects = subjects_seen(plan, camera, middle);
    if (!shots.empty() && shots.back().cut == shot.cut && shots.back().lit == shot.lit &&
        shots.back().subjects == shot.subjects)
      shots.back().span.finish = shot.span.finish;
    else
      shots.push_back(shot);
  }
  return shots;
}

std::vector<Moment> moments_of(const Plan& plan) {
  std::vector<Moment> moments;
  if (plan.task.scan)
    for (std::size_t i = 0; i < plan.task.scan->views.size(); ++i)
      moments.push_back({plan.task.scan->views[i].time, "image " + std::to_string(i + 1)});
  if (plan.task.gates.empty()) return moments;
  std::vector<PathPoint> path;
  const auto& samples = plan.trajectory.samples;
  const double start = samples.front().time;
  for (int i = 0; start + i / kPassing < samples.back().time; ++i)
    path.push_back(
        {start + i / kPassing, sample_at(plan.trajectory, start + i / kPassing).position});
  path.push_back({samples.back().time, samples.back().position});
  std::size_t from = 0;
  double share = 0;
  for (std::size_t i = 0; i < plan.task.gates.size(); ++i) {
    const GateTask& gate = plan.task.gates[i];
    const GatePassage passage = gate_passage(gate, path, from, kMissed, share);
    if (!(passage.outside <= kMissed)) continue;
    moments.push_back({passage.time, "gate " + std::to_string(i + 1) +
                                         (gate.name.empty() ? "" : ": " + gate.name)});
    from = passage.after;
    share = passage.share;
  }
  return moments;
}

}  // namespace lapwing
