// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/interpolate.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kTimeSlack = 1e-6;  // s

template <class T>
T blend(const T& a, const T& b, double s) {
  return (1 - s) * a + s * b;
}

template <class T>
struct Cubic {
  T value, rate;
};

// The cubic with values a, b and rates da, db at the ends of an interval of length h, at share s.
template <class T>
Cubic<T> cubic(const T& a, const T& da, const T& b, const T& db, double h, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return {(2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * h * da + (3 * s2 - 2 * s3) * b +
              (s3 - s2) * h * db,
          (6 * s2 - 6 * s) / h * (a - b) + (3 * s2 - 4 * s + 1) * da + (3 * s2 - 2 * s) * db};
}

void move(const Sample& a, const Sample& b, double h, double s, Sample& out) {
  const auto position =
      cubic<Eigen::Vector3d>(a.position, a.velocity, b.position, b.velocity, h, s);
  out.position = position.value;
  out.velocity = position.rate;
  const auto yaw = cubic<double>(a.yaw, a.yaw_rate, b.yaw, b.yaw_rate, h, s);
  out.yaw = yaw.value;
  out.yaw_rate = yaw.rate;
}

void follow_line(const Sample& a, const Sample& b, double h, double s, Sample& out) {
  out.position = blend(a.position, b.position, s);
  out.velocity = (b.position - a.position) / h;
  out.yaw = blend(a.yaw, b.yaw, s);
  out.yaw_rate = (b.yaw - a.yaw) / h;
}

void blend_inputs(const Sample& a, const Sample& b, double s, Sample& out) {
  out.acceleration = blend(a.acceleration, b.acceleration, s);
  out.gimbal_yaw_rate = blend(a.gimbal_yaw_rate, b.gimbal_yaw_rate, s);
  out.gimbal_pitch_rate = blend(a.gimbal_pitch_rate, b.gimbal_pitch_rate, s);
}

// Linearly, an orientation along the shortest turn; nothing where only one of both has it.
void blend_column(const std::string& name, const Sample& a, const Sample& b, double s,
                  Sample& out) {
  const auto from = a.columns.find(name), to = b.columns.find(name);
  if (from.empty() || from.size() != to.size()) return;
  if (name == "orientation" && from.size() == 4) {
    out.columns.set(name, a.columns.quaternion(name).slerp(s, b.columns.quaternion(name)));
    return;
  }
  std::vector<double> mixed(from.size());
  for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = blend(from[i], to[i], s);
  out.columns.set(name, mixed);
}

// States; and inputs, unless they are held.
void blend_columns(const Trajectory& trajectory, const Sample& a, const Sample& b, double s,
                   Sample& out) {
  for (const MotionColumn& column : trajectory.motion.columns)
    if (!column.input || !trajectory.inputs_held) blend_column(column.name, a, b, s, out);
}

// When the step of a sample is half over. The last one's is as long as the one before it.
double middle_of_step(const std::vector<Sample>& samples, std::size_t i) {
  const std::size_t from = std::min(i, samples.size() - 2);
  return samples[i].time + 0.5 * (samples[from + 1].time - samples[from].time);
}

void turn_gimbal(const Sample& a, const Sample& b, double h, double s, bool held, Sample& out) {
  if (held) {
    out.gimbal_yaw = blend(a.gimbal_yaw, b.gimbal_yaw, s);
    out.gimbal_pitch = blend(a.gimbal_pitch, b.gimbal_pitch, s);
    return;
  }
  out.gimbal_yaw =
      cubic(a.gimbal_yaw, a.gimbal_yaw_rate, b.gimbal_yaw, b.gimbal_yaw_rate, h, s).value;
  out.gimbal_pitch =
      cubic(a.gimbal_pitch, a.gimbal_pitch_rate, b.gimbal_pitch, b.gimbal_pitch_rate, h, s).value;
}

}  // namespace

Sample sample_at(const Trajectory& trajectory, double time) {
  const auto& samples = trajectory.samples;
  if (samples.empty()) throw Error("sample_at: the trajectory has no sample");
  if (!(time >= samples.front().time - kTimeSlack && time <= samples.back().time + kTimeSlack)) {
    throw Error("sample_at: " + std::to_string(time) + " s lies outside the trajectory");
  }
  if (time <= samples.front().time) return samples.front();
  if (time >= samples.back().time) return samples.back();
  const auto after = std::upper_bound(samples.begin(), samples.end(), time,
                                      [](double t, const Sample& x) { return t < x.time; });
  const Sample& a = *(after - 1);
  const Sample& b = *after;
  const double h = b.time - a.time, s = (time - a.time) / h;
  Sample out = a;
  out.time = time;
  if (!trajectory.motion.moves) {
    follow_line(a, b, h, s, out);
  } else {
    move(a, b, h, s, out);
    if (!trajectory.inputs_held) blend_inputs(a, b, s, out);
    blend_columns(trajectory, a, b, s, out);
  }
  if (trajectory.has_gimbal) turn_gimbal(a, b, h, s, trajectory.inputs_held, out);
  if (trajectory.has_target) out.target = blend(a.target, b.target, s);
  return out;
}

void smooth_held_inputs(const Trajectory& trajectory, double time, Sample& sample) {
  const auto& samples = trajectory.samples;
  if (!trajectory.inputs_held || samples.size() < 2) return;
  // The last step whose middle is not after `time`, and the one behind it.
  const auto begun = std::upper_bound(samples.begin(), samples.end(), time,
                                      [](double t, const Sample& x) { return t < x.time; });
  auto last = static_cast<std::size_t>(std::max<std::ptrdiff_t>(begun - samples.begin() - 1, 0));
  if (last > 0 && middle_of_step(samples, last) > time) --last;
  last = std::min(last, samples.size() - 2);
  const Sample& a = samples[last];
  const Sample& b = samples[last + 1];
  const double from = middle_of_step(samples, last), to = middle_of_step(samples, last + 1);
  const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
  blend_inputs(a, b, s, sample);
  for (const MotionColumn& column : trajectory.motion.columns)
    if (column.input) blend_column(column.name, a, b, s, sample);
}

}  // namespace lapwing
