// SPDX-License-Identifier: Apache-2.0
#include "framework/export/flight_charts.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "framework/core/units.h"
#include "framework/export/surroundings.h"

namespace lapwing {
namespace {

double across(const Eigen::Vector3d& v) {
  return v.head<2>().norm();
}

// How far the flight keeps from a bystander: a circle on the level, and one upright in each view.
void add_distance(const Subject& subject, double time, Drawing& drawing) {
  constexpr int kCorners = 48;
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d middle = subject.position(time), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  Polyline rings{subject.name + ", distance kept", {}, {}, {}};
  for (const auto& [first, second] : {std::pair{x, y}, {x, z}, {y, z}}) {
    for (int i = 0; i <= kCorners; ++i) {
      const double angle = 2 * std::numbers::pi * i / kCorners;
      rings.points.push_back(middle + subject.distance *
                                          (std::cos(angle) * first + std::sin(angle) * second));
    }
    rings.points.push_back(Eigen::Vector3d::Constant(nowhere));
  }
  drawing.lines.push_back(std::move(rings));
}

// A subject that stands is a point; one that moves, its track while the flight lasts.
void add_track(const Plan& plan, const Subject& subject, Drawing& drawing) {
  constexpr int kMost = 200;
  const auto& samples = plan.trajectory.samples;
  const double start = samples.front().time, duration = plan.trajectory.duration();
  drawing.points.push_back({subject.name, subject.position(start)});
  if (!subject.filmed && subject.distance > 0) {
    add_distance(subject, start, drawing);
    if (subject.positions.size() > 1) add_distance(subject, start + duration, drawing);
  }
  if (subject.positions.size() < 2 || !(duration > 0)) return;
  Polyline track{subject.name, {}, {}, {}};
  for (int i = 0; i <= kMost; ++i) {
    track.along.push_back(start + duration * i / kMost);
    track.points.push_back(subject.position(track.along.back()));
  }
  drawing.lines.push_back(std::move(track));
}

// The outline of an opening at both ends of its tunnel; a ball is a body.
void add_gate(const GateTask& gate, Drawing& drawing) {
  if (gate.ball()) {
    drawing.spheres.push_back({gate.name, gate.position, gate.radius});
    return;
  }
  Polyline outline{gate.name, {}, {}, {}};
  const double half = 0.5 * gate.tunnel_length;
  for (const double place : {-half, half}) {
    for (std::size_t k = 0; k <= gate.corners.size(); ++k) {
      const Eigen::Vector2d& corner = gate.corners[k % gate.corners.size()];
      outline.points.push_back(gate.position + place * gate.direction + corner.x() * gate.left() +
                               corner.y() * gate.up);
    }
    if (half == 0) break;
  }
  drawing.lines.push_back(std::move(outline));
}

// What surrounds the whole flight says nothing in a picture.
bool all_around(const Zone& zone) {
  return zone.name == "floor";
}

// The side that a drawing of light is read from; of other flights, where they look widest.
Projection better_side(const Plan& plan) {
  const Eigen::Vector3d& view = plan.task.drawing_view;
  if (!plan.task.strokes.empty()) {
    if (std::abs(view.x()) > std::abs(view.y()))
      return view.x() > 0 ? Projection::from_west : Projection::from_east;
    return view.y() >= 0 ? Projection::from_south : Projection::from_north;
  }
  Eigen::Vector3d low = plan.trajectory.samples.front().position, high = low;
  for (const Sample& s : plan.trajectory.samples) {
    low = low.cwiseMin(s.position);
    high = high.cwiseMax(s.position);
  }
  const Eigen::Vector3d extent = high - low;
  return extent.x() >= extent.y() ? Projection::from_south : Projection::from_east;
}

std::vector<Block> views_of(const Drawing& drawing, const std::string& title, Projection side) {
  const std::string from = projection_names().at(static_cast<std::size_t>(side)).substr(5);
  return {PathView{title + " from above", Projection::above, drawing},
          PathView{title + " from the " + from, side, drawing},
          Scene3D{title + " in space", drawing}};
}

}  // namespace

void add_task(const Plan& plan, const std::filesystem::path& folder, Drawing& drawing) {
  for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
    drawing.points.push_back({std::to_string(i + 1), plan.task.keyframes[i].position});
  }
  add_surroundings(plan, folder, drawing);
  std::erase_if(drawing.zones, all_around);
  std::set<std::string> drawn;  // once, however many laps there are
  for (const GateTask& gate : plan.task.gates)
    if (drawn.insert(gate.name).second) add_gate(gate, drawing);
  for (const Subject& subject : plan.environment.subjects) add_track(plan, subject, drawing);
}

Section path_section(const Plan& plan, const std::filesystem::path& folder) {
  Drawing drawing;
  drawing.along = time_axis();
  Polyline line{"path", {}, {}, {}};
  for (const Sample& s : plan.trajectory.samples) {
    line.points.push_back(s.position);
    line.along.push_back(s.time);
    if (plan.trajectory.motion.moves) line.values.push_back(s.velocity.norm());
  }
  drawing.value = {"speed", "m/s"};
  drawing.lines.push_back(std::move(line));
  add_task(plan, folder, drawing);
  return {"Path", views_of(drawing, "Path", better_side(plan))};
}

Section paths_section(const std::vector<std::pair<std::string, const Plan*>>& plans,
                      const std::filesystem::path& folder) {
  if (plans.empty()) return {"Paths", {}};
  Drawing drawing;
  drawing.along = time_axis();
  for (const auto& [name, plan] : plans) {
    Polyline line{name, {}, {}, {}};
    for (const Sample& s : plan->trajectory.samples) {
      line.points.push_back(s.position);
      line.along.push_back(s.time);
    }
    drawing.lines.push_back(std::move(line));
  }
  add_task(*plans.front().second, folder, drawing);
  return {"Paths", views_of(drawing, "Paths", better_side(*plans.front().second))};
}

Section motion_section(const Plan& plan, const Vehicle& vehicle) {
  const TimeCharts charts(plan);
  Section section{"Motion", {}};
  section.blocks.push_back(
      charts.chart("Position", "position", "m",
                   {charts.series("east", [](const Sample& s) { return s.position.x(); }),
                    charts.series("north", [](const Sample& s) { return s.position.y(); }),
                    charts.series("up", [](const Sample& s) { return s.position.z(); })}));
  if (!plan.trajectory.motion.moves) return section;
  section.blocks.push_back(
      charts.chart("Speed across", "speed", "m/s",
                   {charts.series("across", [](const Sample& s) { return across(s.velocity); })},
                   {{"maximum", vehicle.speed_across_max}}));
  section.blocks.push_back(
      charts.chart("Climb and descent", "speed up", "m/s",
                   {charts.series("up", [](const Sample& s) { return s.velocity.z(); })},
                   {{"climb at most", vehicle.climb_speed_max},
                    {"descent at most", -vehicle.descent_speed_max}}));
  section.blocks.push_back(
      charts.chart("Acceleration across", "acceleration", "m/s\u00b2",
                   {charts.series(
                       "across", [](const Sample& s) { return across(s.acceleration); }, true)},
                   {{"maximum", vehicle.acceleration_across_max}}));
  Chart up = charts.chart("Acceleration up", "acceleration up", "m/s\u00b2",
                          {charts.series(
                              "up", [](const Sample& s) { return s.acceleration.z(); }, true)});
  if (vehicle.acceleration_up_max) up.limits.push_back({"maximum", *vehicle.acceleration_up_max});
  if (vehicle.acceleration_down_max) {
    up.limits.push_back({"minimum", -*vehicle.acceleration_down_max});
  }
  section.blocks.push_back(std::move(up));
  return section;
}

namespace {

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// A motion's own columns, a chart each, with the unit that the motion states.
void add_columns(const TimeCharts& charts, const Trajectory& trajectory, Section& section) {
  for (const MotionColumn& column : trajectory.motion.columns) {
    std::vector<Series> series;
    const std::vector<std::string> names = component_names(column);
    for (int i = 0; i < column.size; ++i)
      series.push_back(charts.series(
          in_words(names[static_cast<std::size_t>(i)]),
          [name = column.name, i](const Sample& s) {
            const auto values = s.columns.find(name);
            return static_cast<std::size_t>(i) < values.size()
                       ? values[static_cast<std::size_t>(i)]
                       : std::numeric_limits<double>::quiet_NaN();
          },
          column.input));
    std::string title = in_words(column.name);
    title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
    section.blocks.push_back(
        charts.chart(title, in_words(column.name), column.unit, std::move(series)));
  }
}

}  // namespace

Section input_section(const Plan& plan, const Vehicle& vehicle) {
  const TimeCharts charts(plan);
  Section section{"Inputs", {}};
  if (plan.trajectory.motion.tracked == Tracking::force) {
    section.blocks.push_back(charts.chart(
        "Thrust", "thrust", "N",
        {charts.series(
            "norm", [](const Sample& s) { return s.columns.vector3("force").norm(); }, true)},
        {{"maximum", vehicle.thrust_max()}, {"minimum", vehicle.thrust_min()}}));
    section.blocks.push_back(charts.chart(
        "Yaw torque", "torque", "N m",
        {charts.series(
            "yaw torque", [](const Sample& s) { return s.columns.scalar("yaw_torque"); }, true)},
        both_ways(vehicle.yaw_torque_max())));
  } else if (plan.trajectory.motion.tracked == Tracking::rotors) {
    std::vector<Series> rotors;
    for (int i = 0; i < 4; ++i) {
      rotors.push_back(charts.series(
          "rotor " + std::to_string(i + 1),
          [i](const Sample& s) { return s.columns.vector<4>("rotor_thrusts")[i]; }, true));
    }
    section.blocks.push_back(charts.chart(
        "Rotor thrusts", "thrust", "N", std::move(rotors),
        {{"maximum", vehicle.rotors.thrust_max}, {"minimum", vehicle.rotors.thrust_min}}));
  } else {
    add_columns(charts, plan.trajectory, section);
  }
  return section;
}

Section direction_section(const Plan& plan, const Vehicle& vehicle) {
  const TimeCharts charts(plan);
  Section section{"Direction", {}};
  section.blocks.push_back(
      charts.chart("Yaw", "yaw", "\u00b0",
                   {charts.series("yaw", [](const Sample& s) { return degrees(s.yaw); })}));
  if (plan.trajectory.motion.moves) {
    // Of whole quadrotors the limit is that of the body's own axis, however the heading turns.
    const bool rotors = plan.trajectory.motion.tracked == Tracking::rotors;
    section.blocks.push_back(charts.chart(
        rotors ? "Body rate about the thrust" : "Yaw rate", rotors ? "rate" : "yaw rate",
        "\u00b0/s",
        {charts.series("rate",
                       [=](const Sample& s) {
                         return degrees(rotors ? s.columns.vector3("body_rates").z() : s.yaw_rate);
                       })},
        both_ways(degrees(vehicle.yaw_rate_max))));
  }
  return section;
}

}  // namespace lapwing
