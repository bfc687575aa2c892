#include "framework/export/flight_charts.h"

#include "framework/core/units.h"

namespace lapwing {
namespace {

// Charts of one plan over time; each `read` is a function of a sample.
class Charts {
 public:
  explicit Charts(const Plan& plan) : plan_(plan) {
    for (const Sample& s : plan.trajectory.samples) times_.push_back(s.time);
    for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
      markers_.push_back({std::to_string(i + 1), plan.task.keyframes[i].time});
    }
  }

  template <class Read>
  Series series(const std::string& name, Read read, bool stepped = false) const {
    Series out{name, times_, {}, stepped && plan_.trajectory.inputs_held};
    for (const Sample& s : plan_.trajectory.samples) out.y.push_back(read(s));
    return out;
  }

  Chart chart(const std::string& title, const std::string& label, const std::string& unit,
              std::vector<Series> series, std::vector<LimitLine> limits = {}) const {
    return {title,    time_axis(), Axis{label, unit}, std::move(series), std::move(limits),
            markers_, {}};
  }

 private:
  const Plan& plan_;
  std::vector<double> times_;
  std::vector<Marker> markers_;
};

double across(const Eigen::Vector3d& v) {
  return v.head<2>().norm();
}

std::vector<LimitLine> both_ways(double limit) {
  return {{"maximum", limit}, {"minimum", -limit}};
}

Projection better_side(const Trajectory& trajectory) {
  Eigen::Vector3d low = trajectory.samples.front().position, high = low;
  for (const Sample& s : trajectory.samples) {
    low = low.cwiseMin(s.position);
    high = high.cwiseMax(s.position);
  }
  const Eigen::Vector3d extent = high - low;
  return extent.x() >= extent.y() ? Projection::from_south : Projection::from_east;
}

Chart gimbal_angles(const Charts& charts, const Vehicle& vehicle) {
  Chart chart = charts.chart(
      "Gimbal angles", "angle", "\u00b0",
      {charts.series("yaw", [](const Sample& s) { return degrees(s.gimbal_yaw); }),
       charts.series("pitch", [](const Sample& s) { return degrees(s.gimbal_pitch); })});
  if (vehicle.gimbal) {
    chart.limits = {{"pitch at most", degrees(vehicle.gimbal->pitch_max)},
                    {"pitch at least", degrees(vehicle.gimbal->pitch_min)}};
    if (vehicle.gimbal->yaw_max > vehicle.gimbal->yaw_min) {
      chart.limits.push_back({"yaw at most", degrees(vehicle.gimbal->yaw_max)});
      chart.limits.push_back({"yaw at least", degrees(vehicle.gimbal->yaw_min)});
    }
  }
  return chart;
}

Chart gimbal_rates(const Charts& charts, const Vehicle& vehicle) {
  Chart chart = charts.chart(
      "Gimbal rates", "rate", "\u00b0/s",
      {charts.series("yaw", [](const Sample& s) { return degrees(s.gimbal_yaw_rate); }),
       charts.series("pitch", [](const Sample& s) { return degrees(s.gimbal_pitch_rate); })});
  if (!vehicle.gimbal) return chart;
  const double pitch = degrees(vehicle.gimbal->pitch_rate_max);
  const double yaw = degrees(vehicle.gimbal->yaw_rate_max);
  const bool turns = vehicle.gimbal->yaw_max > vehicle.gimbal->yaw_min;
  if (!turns || yaw == pitch) {
    chart.limits = both_ways(pitch);
  } else {
    chart.limits = {{"pitch at most", pitch},
                    {"pitch at least", -pitch},
                    {"yaw at most", yaw},
                    {"yaw at least", -yaw}};
  }
  return chart;
}

}  // namespace

Axis time_axis() {
  return {"time", "s"};
}

Section path_section(const Plan& plan) {
  Drawing drawing;
  drawing.along = time_axis();
  Polyline line{"path", {}, {}, {}};
  for (const Sample& s : plan.trajectory.samples) {
    line.points.push_back(s.position);
    line.along.push_back(s.time);
    if (plan.trajectory.model != MotionModel::path) line.values.push_back(s.velocity.norm());
  }
  drawing.value = {"speed", "m/s"};
  drawing.lines.push_back(std::move(line));
  for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
    drawing.points.push_back({std::to_string(i + 1), plan.task.keyframes[i].position});
  }
  drawing.spheres = plan.environment.spheres;
  drawing.boxes = plan.environment.boxes;
  const Projection side = better_side(plan.trajectory);
  const std::string from = side == Projection::from_south ? "south" : "east";
  return {"Path",
          {PathView{"Path from above", Projection::above, drawing},
           PathView{"Path from the " + from, side, drawing}, Scene3D{"Path in space", drawing}}};
}

Section motion_section(const Plan& plan, const Vehicle& vehicle) {
  const Charts charts(plan);
  Section section{"Motion", {}};
  section.blocks.push_back(
      charts.chart("Position", "position", "m",
                   {charts.series("east", [](const Sample& s) { return s.position.x(); }),
                    charts.series("north", [](const Sample& s) { return s.position.y(); }),
                    charts.series("up", [](const Sample& s) { return s.position.z(); })}));
  if (plan.trajectory.model == MotionModel::path) return section;
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

Section input_section(const Plan& plan, const Vehicle& vehicle) {
  const Charts charts(plan);
  Section section{"Inputs", {}};
  if (plan.trajectory.model == MotionModel::force) {
    section.blocks.push_back(
        charts.chart("Thrust", "thrust", "N",
                     {charts.series(
                         "norm", [](const Sample& s) { return s.force.norm(); }, true)},
                     {{"maximum", vehicle.thrust_max()}, {"minimum", vehicle.thrust_min()}}));
    section.blocks.push_back(
        charts.chart("Yaw torque", "torque", "N m",
                     {charts.series(
                         "yaw torque", [](const Sample& s) { return s.yaw_torque; }, true)},
                     both_ways(vehicle.yaw_torque_max())));
  } else if (plan.trajectory.model == MotionModel::rotors) {
    std::vector<Series> rotors;
    for (int i = 0; i < 4; ++i) {
      rotors.push_back(charts.series(
          "rotor " + std::to_string(i + 1), [i](const Sample& s) { return s.rotor_thrusts[i]; },
          true));
    }
    section.blocks.push_back(charts.chart(
        "Rotor thrusts", "thrust", "N", std::move(rotors),
        {{"maximum", vehicle.rotors.thrust_max}, {"minimum", vehicle.rotors.thrust_min}}));
  }
  return section;
}

Section direction_section(const Plan& plan, const Vehicle& vehicle) {
  const Charts charts(plan);
  Section section{"Direction", {}};
  section.blocks.push_back(
      charts.chart("Yaw", "yaw", "\u00b0",
                   {charts.series("yaw", [](const Sample& s) { return degrees(s.yaw); })}));
  if (plan.trajectory.model != MotionModel::path) {
    section.blocks.push_back(charts.chart(
        "Yaw rate", "yaw rate", "\u00b0/s",
        {charts.series("yaw rate", [](const Sample& s) { return degrees(s.yaw_rate); })},
        both_ways(degrees(vehicle.yaw_rate_max))));
  }
  if (plan.trajectory.has_gimbal) {
    section.blocks.push_back(gimbal_angles(charts, vehicle));
    section.blocks.push_back(gimbal_rates(charts, vehicle));
  }
  return section;
}

}  // namespace lapwing
