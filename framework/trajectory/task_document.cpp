// The task and the cuts in plan.json.
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

Value to_value(const KeyframeTask& keyframe) {
  const Eigen::Vector3d& p = keyframe.position;
  Value value = Value::map();
  value.set("time", keyframe.time);
  value.set("position", Value(Value::List{p.x(), p.y(), p.z()}));
  if (keyframe.yaw) value.set("yaw", *keyframe.yaw);
  value.set("tolerance", keyframe.tolerance);
  value.set("time_tolerance", keyframe.time_tolerance);
  value.set("yaw_tolerance", keyframe.yaw_tolerance);
  return value;
}

KeyframeTask keyframe_from(Fields& fields) {
  KeyframeTask keyframe;
  keyframe.time = fields.number("time");
  keyframe.position = fields.vector3("position");
  keyframe.yaw = fields.optional_number("yaw");
  keyframe.tolerance = fields.number("tolerance");
  keyframe.time_tolerance = fields.number("time_tolerance");
  keyframe.yaw_tolerance = fields.number("yaw_tolerance");
  return keyframe;
}

void set_span(Value& value, const TimeSpan& span) {
  value.set("start", span.start);
  value.set("finish", span.finish);
}

TimeSpan span_from(Fields& fields) {
  TimeSpan span;
  span.start = fields.number("start");
  span.finish = fields.number("finish");
  return span;
}

}  // namespace

Value cuts_to_value(const std::vector<TimeSpan>& cuts) {
  Value list = Value::list();
  for (const TimeSpan& cut : cuts) {
    Value entry = Value::map();
    set_span(entry, cut);
    list.push_back(std::move(entry));
  }
  return list;
}

std::vector<TimeSpan> cuts_from(std::vector<Fields> entries) {
  std::vector<TimeSpan> cuts;
  for (Fields& entry : entries) {
    cuts.push_back(span_from(entry));
    entry.finish();
  }
  return cuts;
}

Value task_to_value(const Task& task) {
  Value keyframes = Value::list(), framing = Value::list(), value = Value::map();
  for (const KeyframeTask& keyframe : task.keyframes) keyframes.push_back(to_value(keyframe));
  value.set("keyframes", std::move(keyframes));
  if (task.framing.empty()) return value;
  for (const FramingTask& asked : task.framing) {
    Value entry = Value::map();
    entry.set("subject", asked.subject);
    set_span(entry, asked.span);
    framing.push_back(std::move(entry));
  }
  value.set("framing", std::move(framing));
  value.set("framing_share", task.framing_share);
  return value;
}

Task task_from(Fields fields) {
  Task task;
  for (Fields& entry : fields.tables("keyframes")) {
    task.keyframes.push_back(keyframe_from(entry));
    entry.finish();
  }
  if (fields.has("framing") || fields.has("framing_share")) {
    for (Fields& entry : fields.tables("framing")) {
      const std::string subject = entry.text("subject");
      task.framing.push_back({subject, span_from(entry)});
      entry.finish();
    }
    task.framing_share = fields.number("framing_share");
  }
  fields.finish();
  return task;
}

}  // namespace lapwing
