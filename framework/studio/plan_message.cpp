// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/plan_message.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "framework/core/json.h"
#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {
namespace {

void add_number(std::string& text, double number, int digits) {
  if (!std::isfinite(number)) {
    text += "null";
    return;
  }
  char bytes[40];
  const auto end =
      std::to_chars(bytes, bytes + sizeof bytes, number, std::chars_format::general, digits);
  text.append(bytes, end.ptr);
}

// "name":[...],
template <class Items, class Number>
void add_column(std::string& text, const char* name, const Items& items, Number number_of,
                int digits = 7) {
  text += std::string("\"") + name + "\":[";
  for (const auto& item : items) {
    add_number(text, number_of(item), digits);
    text += ',';
  }
  if (text.back() == ',') text.pop_back();
  text += "],";
}

// World from camera; the camera looks along its z, y is down.
Eigen::Quaterniond camera_of(const Sample& s) {
  const CameraAxes<double> axes = camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch);
  Eigen::Matrix3d rotation;
  rotation << axes.right, axes.down, axes.forward;
  return Eigen::Quaterniond(rotation);
}

template <class Items, class Turn>
void add_turns(std::string& text, const Items& items, Turn turn_of) {
  std::vector<Eigen::Quaterniond> turns;
  for (const auto& item : items) {
    Eigen::Quaterniond q = turn_of(item);
    // Neighbours on the same side, so that a page may mix them.
    if (!turns.empty() && q.dot(turns.back()) < 0) q.coeffs() *= -1;
    turns.push_back(q);
  }
  add_column(text, "qw", turns, [](const auto& q) { return q.w(); });
  add_column(text, "qx", turns, [](const auto& q) { return q.x(); });
  add_column(text, "qy", turns, [](const auto& q) { return q.y(); });
  add_column(text, "qz", turns, [](const auto& q) { return q.z(); });
}

// What the rotors bear together, where the samples say so.
double thrust_of(const Sample& s) {
  if (s.columns.has("force")) return s.columns.vector3("force").norm();
  double sum = 0;
  for (const double thrust : s.columns.find("rotor_thrusts")) sum += thrust;
  return sum;
}

void add_columns(std::string& text, const Plan& plan, bool distances) {
  const std::vector<Sample>& samples = plan.trajectory.samples;
  text += "\"columns\":{";
  add_column(
      text, "time", samples, [](const Sample& s) { return s.time; }, 9);
  constexpr const char* kNames[3][3] = {{"x", "y", "z"}, {"vx", "vy", "vz"}, {"ax", "ay", "az"}};
  for (int i = 0; i < 3; ++i) {
    add_column(text, kNames[0][i], samples, [i](const Sample& s) { return s.position[i]; });
    add_column(text, kNames[1][i], samples, [i](const Sample& s) { return s.velocity[i]; });
    add_column(text, kNames[2][i], samples, [i](const Sample& s) { return s.acceleration[i]; });
  }
  add_turns(text, samples, camera_of);
  add_column(text, "body_yaw", samples, [](const Sample& s) { return s.yaw; });
  add_column(text, "yaw_rate", samples, [](const Sample& s) { return s.yaw_rate; });
  if (plan.trajectory.has_gimbal) {
    add_column(text, "gimbal_yaw", samples, [](const Sample& s) { return s.gimbal_yaw; });
    add_column(text, "gimbal_pitch", samples, [](const Sample& s) { return s.gimbal_pitch; });
    add_column(text, "gimbal_yaw_rate", samples, [](const Sample& s) { return s.gimbal_yaw_rate; });
    add_column(text, "gimbal_pitch_rate", samples,
               [](const Sample& s) { return s.gimbal_pitch_rate; });
  }
  if (!samples.empty() &&
      (samples.front().columns.has("force") || samples.front().columns.has("rotor_thrusts")))
    add_column(text, "thrust", samples, thrust_of);
  if (distances && !plan.environment.obstacles.empty())
    add_column(text, "distance", samples, [&](const Sample& s) {
      return nearest_obstacle(plan.environment, s.position, s.time).distance;
    });
  text.back() = '}';
  text += ',';
}

Value vector_of(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

// A plan may hold what no vehicle is: what is said of it then is left out.
std::optional<Vehicle> vehicle_of(const Plan& plan) {
  try {
    return vehicle_from_value(plan.vehicle);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Value camera_value(const Camera& camera) {
  Value value = Value::map();
  value.set("name", camera.name);
  value.set("width", camera.width);
  value.set("height", camera.height);
  value.set("fx", camera.focal_x);
  value.set("fy", camera.focal_y);
  value.set("cx", camera.principal_x);
  value.set("cy", camera.principal_y);
  return value;
}

// What a file leaves out is filled in.
Value limits_value(const Vehicle& v) {
  Value value = limits_to_value(v);
  value.set("acceleration_up", v.largest_acceleration_up());
  value.set("acceleration_down", v.largest_acceleration_down());
  if (v.has_rotors) {
    value.set("thrust_max", v.thrust_max());
    value.set("thrust_min", v.thrust_min());
  }
  if (v.gimbal) {
    value.set("gimbal_yaw", Value(Value::List{v.gimbal->yaw_min, v.gimbal->yaw_max}));
    value.set("gimbal_pitch", Value(Value::List{v.gimbal->pitch_min, v.gimbal->pitch_max}));
    value.set("gimbal_yaw_rate", v.gimbal->yaw_rate_max);
    value.set("gimbal_pitch_rate", v.gimbal->pitch_rate_max);
  }
  value.set("flight_time", v.flight_time);
  return value;
}

Value span_value(const TimeSpan& span) {
  Value value = Value::map();
  value.set("start", span.start);
  value.set("finish", span.finish);
  return value;
}

Value keyframes_value(const Plan& plan) {
  Value list = Value::list();
  for (const KeyframeTask& keyframe : plan.task.keyframes) {
    Value value = Value::map();
    value.set("time", keyframe.time);
    value.set("position", vector_of(keyframe.position));
    if (keyframe.yaw) value.set("yaw", *keyframe.yaw);
    value.set("tolerance", keyframe.tolerance);
    value.set("time_tolerance", keyframe.time_tolerance);
    list.push_back(std::move(value));
  }
  return list;
}

Value looks_value(const Plan& plan) {
  Value list = Value::list();
  for (const FramingTask& look : plan.task.framing) {
    Value value = span_value(look.span);
    value.set("subject", look.subject);
    list.push_back(std::move(value));
  }
  return list;
}

Value subjects_value(const Plan& plan) {
  Value list = Value::list();
  for (const Subject& subject : plan.environment.subjects) {
    Value value = Value::map();
    value.set("name", subject.name);
    value.set("filmed", subject.filmed);
    value.set("times", Value(Value::List(subject.times.begin(), subject.times.end())));
    Value& positions = value.set("positions", Value::list());
    for (const Eigen::Vector3d& p : subject.positions) positions.push_back(vector_of(p));
    value.set("height", subject.height);
    value.set("width", subject.width);
    value.set("keep", subject.distance);
    list.push_back(std::move(value));
  }
  return list;
}

Value gates_value(const Plan& plan) {
  Value list = Value::list();
  for (const GateTask& gate : plan.task.gates) {
    Value value = Value::map();
    value.set("name", gate.name);
    value.set("position", vector_of(gate.position));
    value.set("direction", vector_of(gate.direction));
    value.set("up", vector_of(gate.up));
    value.set("radius", gate.radius);
    Value& corners = value.set("corners", Value::list());
    for (const Eigen::Vector2d& corner : gate.corners)
      corners.push_back(Value(Value::List{corner.x(), corner.y()}));
    list.push_back(std::move(value));
  }
  return list;
}

// Everything of a plan but its columns.
Value around_columns(const Plan& plan, const SolveReport& report) {
  Value value = Value::map();
  value.set("duration", plan.trajectory.duration());
  value.set("keyframes", keyframes_value(plan));
  value.set("looks", looks_value(plan));
  value.set("subjects", subjects_value(plan));
  value.set("gates", gates_value(plan));
  Value& cuts = value.set("cuts", Value::list());
  for (const TimeSpan& cut : plan.cuts) cuts.push_back(span_value(cut));
  Value& lights = value.set("lights", Value::list());
  for (const TimeSpan& light : plan.lights) lights.push_back(span_value(light));
  Value& strokes = value.set("strokes", Value::list());
  for (const Points& stroke : plan.task.strokes) {
    Value points = Value::list();
    for (const Eigen::Vector3d& p : stroke) points.push_back(vector_of(p));
    strokes.push_back(std::move(points));
  }
  value.set("margin", plan.environment.margin);
  if (const std::optional<Vehicle> vehicle = vehicle_of(plan)) {
    value.set("camera", camera_value(vehicle->camera));
    value.set("limits", limits_value(*vehicle));
  }
  Value& objective = value.set("objective", Value::list());
  for (const TermCost& term : report.terms) {
    if (!std::isfinite(term.cost)) continue;
    Value one = Value::map();
    one.set("term", term.name);
    one.set("cost", term.cost);
    objective.push_back(std::move(one));
  }
  return value;
}

}  // namespace

std::string plan_message(const Plan& plan, const SolveReport& report, bool distances) {
  std::string text = "{";
  add_columns(text, plan, distances);
  return text + to_json(around_columns(plan, report), -1).substr(1);
}

std::string certificate_message(const Certificate& certificate) {
  Value value = Value::map();
  value.set("passed", certificate.feasible());
  Value& checks = value.set("checks", Value::list());
  for (const Check& check : certificate.checks) {
    Value one = Value::map();
    one.set("name", check.name);
    one.set("group", check.group == CheckGroup::safety ? "safety" : "task");
    one.set("required", check.required);
    one.set("passed", check.pass);
    if (!check.skipped.empty()) one.set("skipped", check.skipped);
    if (check.skipped.empty()) {
      if (check.worst && std::isfinite(*check.worst)) one.set("worst", *check.worst);
      if (std::isfinite(check.limit)) one.set("limit", check.limit);
      one.set("tolerance", check.tolerance);
      one.set("sense", check.at_least ? "at_least" : "at_most");
      one.set("unit", check.unit);
      one.set("time", check.at);
      one.set("detail", as_utf8(check.detail));
    }
    one.set("text", as_utf8(result_of(check)));
    checks.push_back(std::move(one));
  }
  return to_json(value, -1);
}

std::string flown_message(const FlownPath& flown, const Trajectory& planned) {
  std::vector<FlownSample> samples;
  for (const FlownSample& sample : flown.samples) {
    if (!sample.state.position.allFinite()) break;
    samples.push_back(sample);
  }
  std::string text = "{";
  add_column(
      text, "time", samples, [](const FlownSample& s) { return s.time; }, 9);
  constexpr const char* kNames[3] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    add_column(text, kNames[i], samples, [i](const FlownSample& s) { return s.state.position[i]; });
  const double end = planned.samples.back().time;
  add_turns(text, samples, [&](const FlownSample& s) {
    Sample at = sample_at(planned, std::min(s.time, end));
    at.yaw += s.yaw_error;
    return camera_of(at);
  });
  add_column(text, "position_error", samples,
             [](const FlownSample& s) { return s.position_error; });
  text.back() = '}';
  return text;
}

}  // namespace lapwing
