// SPDX-License-Identifier: Apache-2.0
#include "framework/core/units.h"
#include "framework/studio/worker_errands.h"

namespace lapwing {
namespace {

bool is_empty_list(const Value& options, const char* key) {
  const Value* list = options.find(key);
  return list && (*list == Value::list() || *list == Value::map());
}

Value position_of(const Eigen::Vector3d& p) {
  return Value(Value::List{p.x(), p.y(), p.z()});
}

Value keyframes_of(const Plan& plan) {
  Value list = Value::list();
  for (const KeyframeTask& keyframe : plan.task.keyframes) {
    Value entry = Value::map();
    entry.set("time", keyframe.time);
    entry.set("position", position_of(keyframe.position));
    if (keyframe.yaw) entry.set("yaw_deg", degrees(*keyframe.yaw));
    list.push_back(std::move(entry));
  }
  return list;
}

Value subjects_of(const Plan& plan) {
  Value list = Value::list();
  for (const Subject& subject : plan.environment.subjects) {
    if (!subject.filmed) continue;
    Value entry = Value::map();
    entry.set("name", subject.name);
    Value track = Value::list();
    for (std::size_t i = 0; subject.times.size() > 1 && i < subject.times.size(); ++i) {
      Value point = Value::map();
      point.set("time", subject.times[i]);
      point.set("position", position_of(subject.positions[i]));
      track.push_back(std::move(point));
    }
    if (subject.times.size() == 1) entry.set("position", position_of(subject.positions.front()));
    entry.set("track", std::move(track));
    entry.set("height", subject.height);
    entry.set("width", subject.width);
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace

Value options_with_file(Mission& mission) {
  Value options = mission.configuration();
  const Value* input = options.find("input");
  const Value* stretch = options.find("stretch");
  const bool keyframes = is_empty_list(options, "keyframes"),
             subjects = is_empty_list(options, "subjects");
  const bool of_file =
      mission.kind() == "film" && input && input->is_text() && (keyframes || subjects);
  if (!of_file || !stretch || !stretch->is_number() || stretch->as_number() != 1) return options;
  try {
    const MissionStatement statement = mission.state();
    if (keyframes) options.set("keyframes", keyframes_of(statement.plan));
    if (subjects) options.set("subjects", subjects_of(statement.plan));
  } catch (const InputError&) {  // a file that is not there; times that are sought
  }
  return options;
}

}  // namespace lapwing
