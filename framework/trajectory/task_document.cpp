// SPDX-License-Identifier: Apache-2.0
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

Value to_value(const GateTask& gate) {
  Value value = Value::map();
  value.set("name", gate.name);
  value.set("position", list_of(gate.position));
  if (gate.ball()) {
    value.set("radius", gate.radius);
    return value;
  }
  value.set("direction", list_of(gate.direction));
  value.set("up", list_of(gate.up));
  Value corners = Value::list();
  for (const Eigen::Vector2d& c : gate.corners) corners.push_back(Value(Value::List{c.x(), c.y()}));
  value.set("corners", std::move(corners));
  value.set("tunnel_length", gate.tunnel_length);
  return value;
}

GateTask gate_from(Fields& fields) {
  GateTask gate;
  gate.name = fields.text("name");
  gate.position = fields.vector3("position");
  if (fields.has("radius")) {
    gate.radius = fields.number("radius");
    return gate;
  }
  gate.direction = fields.vector3("direction");
  gate.up = fields.vector3("up");
  for (const auto& c : fields.rows("corners", 2)) gate.corners.emplace_back(c[0], c[1]);
  gate.tunnel_length = fields.number("tunnel_length");
  return gate;
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

Value spans_to_value(const std::vector<TimeSpan>& cuts) {
  Value list = Value::list();
  for (const TimeSpan& cut : cuts) {
    Value entry = Value::map();
    set_span(entry, cut);
    list.push_back(std::move(entry));
  }
  return list;
}

std::vector<TimeSpan> spans_from(std::vector<Fields> entries) {
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
  if (!task.closed_loop_required) value.set("closed_loop_required", false);
  if (!task.gates.empty()) {
    Value gates = Value::list();
    for (const GateTask& gate : task.gates) gates.push_back(to_value(gate));
    value.set("gates", std::move(gates));
  }
  if (!task.strokes.empty()) {
    Value strokes = Value::list();
    for (const Points& stroke : task.strokes) {
      Value points = Value::list();
      for (const Eigen::Vector3d& p : stroke)
        points.push_back(Value(Value::List{p.x(), p.y(), p.z()}));
      Value entry = Value::map();
      entry.set("points", std::move(points));
      strokes.push_back(std::move(entry));
    }
    value.set("strokes", std::move(strokes));
    value.set("drawing_tolerance", task.drawing_tolerance);
    const Eigen::Vector3d& view = task.drawing_view;
    value.set("drawing_view", Value(Value::List{view.x(), view.y(), view.z()}));
  }
  if (task.scan) value.set("scan", scan_to_value(*task.scan));
  if (task.framing.empty()) return value;
  for (const FramingTask& asked : task.framing) {
    Value entry = Value::map();
    entry.set("subject", asked.subject);
    set_span(entry, asked.span);
    framing.push_back(std::move(entry));
  }
  value.set("framing", std::move(framing));
  value.set("framing_share", task.framing_share);
  if (!task.line_of_sight_required) value.set("line_of_sight_required", false);
  return value;
}

Task task_from(Fields fields) {
  Task task;
  for (Fields& entry : fields.tables("keyframes")) {
    task.keyframes.push_back(keyframe_from(entry));
    entry.finish();
  }
  if (fields.has("closed_loop_required"))
    task.closed_loop_required = fields.boolean("closed_loop_required");
  if (fields.has("gates"))
    for (Fields& entry : fields.tables("gates")) {
      task.gates.push_back(gate_from(entry));
      entry.finish();
    }
  if (fields.has("strokes") || fields.has("drawing_tolerance")) {
    for (Fields& entry : fields.tables("strokes")) {
      Points stroke;
      for (const auto& p : entry.rows("points", 3)) stroke.emplace_back(p[0], p[1], p[2]);
      task.strokes.push_back(std::move(stroke));
      entry.finish();
    }
    task.drawing_tolerance = fields.number("drawing_tolerance");
    task.drawing_view = fields.vector3("drawing_view");
  }
  if (fields.has("scan")) task.scan = scan_from(fields.table("scan"));
  if (fields.has("framing") || fields.has("framing_share")) {
    for (Fields& entry : fields.tables("framing")) {
      const std::string subject = entry.text("subject");
      task.framing.push_back({subject, span_from(entry)});
      entry.finish();
    }
    task.framing_share = fields.number("framing_share");
    if (fields.has("line_of_sight_required"))
      task.line_of_sight_required = fields.boolean("line_of_sight_required");
  }
  fields.finish();
  return task;
}

}  // namespace lapwing
