// SPDX-License-Identifier: Apache-2.0
// Whether the plan holds together at all: everything that the other checks take for granted.
#include <cstdio>

#include "framework/verify/checks.h"
#include "framework/verify/motions/motion_integrator.h"

namespace lapwing {
namespace {

constexpr std::size_t kListed = 5;  // problems named in the certificate

class Reader {
 public:
  Reader(const Plan& plan, const VerifyRequest& request, Watch& watch)
      : plan_(plan), request_(request), watch_(watch) {}

  Document read() {
    Document document;
    read_vehicle(document.vehicle);
    if (problems_.empty()) motion(document.vehicle);
    samples();
    list_problems(plan_.environment, problems_);
    task();
    list_constraint_problems(plan_, problems_);
    if (problems_.empty()) {
      list_problems(plan_, plan_.trajectory.samples.back().time, problems_);
    }
    if (problems_.empty()) steps(document.vehicle);
    if (problems_.empty()) read_obstacles(document.vehicle, document.shapes);
    const auto count = static_cast<double>(problems_.size());
    document.check = judged(make_check("document"), count, 0, 0, at_);
    document.check.detail = listed();
    return document;
  }

 private:
  void add(const std::string& problem) { problems_.push_back(problem); }

  std::string listed() const {
    std::string text;
    for (std::size_t i = 0; i < std::min(problems_.size(), kListed); ++i) {
      text += (i ? "; " : "") + problems_[i];
    }
    if (problems_.size() > kListed) {
      text += "; and " + std::to_string(problems_.size() - kListed) + " more";
    }
    return text;
  }

  void read_vehicle(Vehicle& vehicle) {
    try {
      vehicle = vehicle_from_value(plan_.vehicle);
    } catch (const std::exception& error) {
      add(error.what());
      return;
    }
    if (plan_.trajectory.has_gimbal && !vehicle.gimbal) {
      add("the plan moves a gimbal that the vehicle does not have");
    }
  }

  // Where the file of an obstacle is, if it has one.
  std::filesystem::path place_of(const Obstacle& obstacle) const {
    const Value* file = obstacle.parameters.find("file");
    if (!file || !file->is_text()) return {};
    const auto found = request_.elsewhere.find(file->as_text());
    return found == request_.elsewhere.end() ? request_.folder / file->as_text() : found->second;
  }

  // What a motion with an orientation needs of it.
  static bool unit_orientation(const Sample& s) {
    const bool right = s.columns.find("orientation").size() == 4;
    return right &&
           std::abs(s.columns.vector<4>("orientation").norm() - 1) < tolerances::kUnitLength;
  }

  void motion(const Vehicle& vehicle) {
    for (const std::string& problem : motion_problems(plan_.trajectory.motion, vehicle))
      add(problem);
  }

  // Where the flight comes, as far as clearance is told apart, and what it films; of the map in
  // which a scan's views see also the region, and the places of the views. The pilot's eye.
  Eigen::AlignedBox3d surroundings(const Vehicle& vehicle, const Obstacle& map) const {
    Motion motion(plan_.trajectory, vehicle);
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i <= motion.intervals(); ++i) box.extend(motion.stated(i).position);
    for (std::size_t i = 0; i < motion.intervals(); ++i)
      for (const MotionPoint& point : motion.integrate(i)) box.extend(point.position);
    for (const FramingTask& asked : plan_.task.framing)
      for (const Subject& subject : plan_.environment.subjects)
        if (subject.name == asked.subject)
          for (const Eigen::Vector3d& place : subject.positions) box.extend(place);
    if (plan_.home)
      for (const Eigen::Vector3d& place : plan_.home->rally_points) box.extend(place);
    const Eigen::Vector3d room = Eigen::Vector3d::Constant(
        std::max(plan_.environment.margin + tolerances::kMapReach, map_reach()));
    Eigen::AlignedBox3d around(box.min() - room, box.max() + room);
    for (const Eigen::Vector3d& move : map.moves) {  // the map's own places, wherever it is
      around.extend(box.min() - room - move);
      around.extend(box.max() + room - move);
    }
    box = around;
    if (plan_.environment.pilot) box.extend(plan_.environment.pilot->eye);
    const auto& scan = plan_.task.scan;
    if (!scan || scan->map != map.name) return box;
    for (const PlannedView& view : scan->views) box.extend(view.position);
    return box.merged(scan->region.bounds());
  }

  // How far constraints of the script tell distances to maps apart, m.
  double map_reach() const {
    double reach = 0;
    const auto& obstacles = plan_.environment.obstacles;
    for (const StatedConstraint& constraint : plan_.constraints)
      for (const ConstraintStep& step : constraint.operations)
        if (step.op == ConstraintOp::distance &&
            obstacles[static_cast<std::size_t>(step.component)].type == "map")
          reach = std::max(reach, step.number);
    return reach;
  }

  // The files are to hold what they held when the plan was made.
  void read_obstacles(const Vehicle& vehicle, JudgedShapes& shapes) {
    const auto& obstacles = plan_.environment.obstacles;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      try {
        shapes.push_back(judged_shape(obstacles[i], place_of(obstacles[i]),
                                      obstacles[i].type == "map"
                                          ? surroundings(vehicle, obstacles[i])
                                          : Eigen::AlignedBox3d()));
      } catch (const std::exception& error) {
        add(obstacles[i].label(i + 1) + ": " + error.what());
      }
      watch_.done(static_cast<double>(i + 1) / static_cast<double>(obstacles.size()));
    }
  }

  // "" where all columns of the motion are there and hold numbers.
  std::string column_problem(const Sample& s) const {
    for (const MotionColumn& column : plan_.trajectory.motion.columns) {
      const auto values = s.columns.find(column.name);
      if (values.size() != static_cast<std::size_t>(column.size))
        return "lacks the column '" + column.name + "' of its motion";
      for (const double value : values)
        if (!sound(value)) return "holds a number that is not finite or beyond 1e7";
    }
    return "";
  }

  static bool all_sound(const Sample& s) {
    return sound(s.time) && sound(s.position) && sound(s.velocity) && sound(s.acceleration) &&
           sound(s.yaw) && sound(s.yaw_rate) && sound(s.gimbal_yaw) && sound(s.gimbal_pitch) &&
           sound(s.gimbal_yaw_rate) && sound(s.gimbal_pitch_rate) && sound(s.target);
  }

  void samples() {
    const auto& samples = plan_.trajectory.samples;
    if (samples.empty()) return add("the plan has no sample");
    if (!(std::abs(samples[0].time) <= tolerances::kStartTime)) {
      add("the first sample is not at time 0");
    }
    const bool oriented = plan_.trajectory.motion.column("orientation");
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::string name = "sample " + std::to_string(i + 1);
      if (!all_sound(samples[i])) {
        add(name + " holds a number that is not finite or beyond 1e7");
      } else if (const std::string fault = column_problem(samples[i]); !fault.empty()) {
        add(name + " " + fault);
      } else if (oriented && !unit_orientation(samples[i])) {
        add(name + " has an orientation that is not a unit quaternion");
      } else if (i > 0 && !(samples[i].time > samples[i - 1].time)) {
        at_ = samples[i].time;
        add(name + " is not later than the one before it");
      }
    }
  }

  void task() {
    if (plan_.budget && !(*plan_.budget > 0 && sound(*plan_.budget))) {
      add("the budget must be above 0");
    }
    list_home_problems(plan_, problems_);
    list_gate_problems(plan_.task, problems_);
    if (plan_.task.scan) list_scan_problems(plan_, problems_);
    for (std::size_t i = 0; i < plan_.task.keyframes.size(); ++i) {
      const KeyframeTask& k = plan_.task.keyframes[i];
      const std::string name = "keyframe " + std::to_string(i + 1);
      if (!sound(k.time) || !sound(k.position) || !sound(k.yaw.value_or(0))) {
        add(name + " holds a number that is not finite or beyond 1e7");
      }
      if (!(k.tolerance > 0 && k.time_tolerance >= 0 && k.yaw_tolerance > 0) ||
          !sound(k.tolerance) || !sound(k.time_tolerance) || !sound(k.yaw_tolerance)) {
        add(name + " needs tolerances above 0 (of time: at least 0)");
      }
    }
  }

  void steps(const Vehicle& vehicle) {
    const double total = Motion(plan_.trajectory, vehicle).total_steps();
    char text[160];
    double work = 0;
    for (const StatedConstraint& constraint : plan_.constraints)
      work += total * static_cast<double>(constraint.operations.size());
    if (work > tolerances::kMostConstraintWork) {
      std::snprintf(text, sizeof text,
                    "evaluating the constraints of the script takes %.3g operations, more "
                    "than %.0g",
                    work, tolerances::kMostConstraintWork);
      add(text);
    }
    if (total <= tolerances::kLargestSteps) return;
    std::snprintf(text, sizeof text,
                  "integrating the motion takes %.3g steps, more than %.0g: the samples are too "
                  "coarse for their inputs",
                  total, tolerances::kLargestSteps);
    add(text);
  }

  const Plan& plan_;
  const VerifyRequest& request_;
  Watch& watch_;
  std::vector<std::string> problems_;
  double at_ = 0;
};

}  // namespace

Document check_document(const Plan& plan, const VerifyRequest& request, Watch& watch) {
  return Reader(plan, request, watch).read();
}

}  // namespace lapwing
