// SPDX-License-Identifier: Apache-2.0
// The motions that the verifier integrates, by name.
#include "framework/core/error.h"
#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

const std::vector<KnownMotion>& known_motions() {
  static const std::vector<KnownMotion> all = [] {
    std::vector<KnownMotion> list;
    for (const auto make : {&force_integrator, &rotors_integrator, &path_integrator,
                            &velocity_integrator, &coordinated_turn_integrator})
      list.push_back(make());
    return list;
  }();
  return all;
}

std::string in_words(const std::vector<MotionColumn>& columns) {
  std::string text;
  for (const MotionColumn& column : columns)
    text += (text.empty() ? "" : ", ") + column.name + " (" + std::to_string(column.size) + ", " +
            (column.input ? "input" : "state") + ", " + column.unit + ")";
  return text.empty() ? "none" : text;
}

}  // namespace

std::array<double, 4> MotionIntegrator::defects(const MotionPoint& reached,
                                                const MotionPoint& stated) const {
  return {(reached.position - stated.position).norm(), (reached.velocity - stated.velocity).norm(),
          std::abs(reached.yaw - stated.yaw), std::abs(reached.yaw_rate - stated.yaw_rate)};
}

void turn_gimbal(const Sample& a, const Sample& b, InputForm inputs,
                 std::vector<MotionPoint>& points) {
  const double h = b.time - a.time;
  const double yaw_change = inputs.held ? 0 : (b.gimbal_yaw_rate - a.gimbal_yaw_rate) / h;
  const double pitch_change = inputs.held ? 0 : (b.gimbal_pitch_rate - a.gimbal_pitch_rate) / h;
  for (MotionPoint& point : points) {
    const double t = point.time - a.time;
    point.gimbal_yaw_rate = a.gimbal_yaw_rate + t * yaw_change;
    point.gimbal_pitch_rate = a.gimbal_pitch_rate + t * pitch_change;
    point.gimbal_yaw = a.gimbal_yaw + t * (a.gimbal_yaw_rate + t * yaw_change / 2);
    point.gimbal_pitch = a.gimbal_pitch + t * (a.gimbal_pitch_rate + t * pitch_change / 2);
  }
}

const KnownMotion* known_motion(std::string_view name) {
  for (const KnownMotion& motion : known_motions())
    if (motion.name == name) return &motion;
  return nullptr;
}

std::string known_motion_names() {
  std::string text;
  for (const KnownMotion& motion : known_motions())
    text += (text.empty() ? "" : ", ") + std::string(motion.name);
  return text;
}

std::vector<std::string> motion_faults(const MotionRecord& motion) {
  std::vector<std::string> problems;
  for (const std::string& problem : problems_of(motion))
    problems.push_back("the motion '" + motion.name + "': " + problem);
  const KnownMotion* known = known_motion(motion.name);
  if (!known && !motion.table)
    problems.push_back("the motion '" + motion.name +
                       "' has no integrator in this version, which has " + known_motion_names() +
                       "; a plan of another motion states its derivatives");
  if (!known) return problems;
  if (motion.table)
    problems.push_back("the motion '" + motion.name +
                       "' states derivatives, and this version has an integrator of that name: "
                       "a motion with derivatives of its own needs another name");
  if (motion.columns != known->columns)
    problems.push_back("the motion '" + motion.name + "' has the columns " +
                       in_words(known->columns) + ", and the plan states " +
                       in_words(motion.columns));
  return problems;
}

std::vector<std::string> motion_problems(const MotionRecord& motion, const Vehicle& vehicle) {
  std::vector<std::string> problems = motion_faults(motion);
  const KnownMotion* known = known_motion(motion.name);
  if (!known) return problems;
  if (const std::string lack = known->lacks(vehicle); !lack.empty())
    problems.push_back("the motion '" + motion.name + "' needs " + lack + ", and vehicle '" +
                       vehicle.name + "' states none");
  return problems;
}

std::unique_ptr<MotionIntegrator> integrator_of(const Trajectory& trajectory,
                                                const Vehicle& vehicle) {
  if (const KnownMotion* known = known_motion(trajectory.motion.name))
    return known->make(trajectory, vehicle);
  if (trajectory.motion.table) return table_integrator(trajectory);
  throw Error("verify: the motion '" + trajectory.motion.name + "' has no integrator");
}

}  // namespace lapwing
