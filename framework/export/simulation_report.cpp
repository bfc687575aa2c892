#include "framework/export/simulation_report.h"

#include <array>

#include "framework/core/units.h"

namespace lapwing {
namespace {

Series series_of(const char* name, const FlownPath& path, auto value_of) {
  Series series{name, {}, {}, false};
  for (const FlownSample& sample : path.samples) {
    series.x.push_back(sample.time);
    series.y.push_back(value_of(sample));
  }
  return series;
}

Chart chart_over_time(std::string title, std::string quantity, std::string unit) {
  Chart chart;
  chart.title = std::move(title);
  chart.x = {"time", "s"};
  chart.y = {std::move(quantity), std::move(unit)};
  return chart;
}

Drawing paths(const Plan& plan, const FlownPath& path) {
  Drawing drawing;
  drawing.along = {"time", "s"};
  drawing.value = {"distance from the plan", "m"};
  Polyline planned{"planned", {}, {}, {}}, flown{"flown", {}, {}, {}};
  for (const FlownSample& sample : path.samples) {
    planned.points.push_back(sample.wanted);
    planned.along.push_back(sample.time);
    flown.points.push_back(sample.state.position);
    flown.along.push_back(sample.time);
    flown.values.push_back(sample.position_error);
  }
  drawing.lines = {planned, flown};
  drawing.spheres = plan.environment.spheres;
  drawing.boxes = plan.environment.boxes;
  drawing.zones = plan.environment.zones;
  return drawing;
}

}  // namespace

Report simulation_report(const Plan& plan, const Vehicle& vehicle, const FlownPath& path) {
  Report report;
  report.title = plan.mission;
  report.subtitle = "flown in simulation by vehicle '" + vehicle.name + "'";
  report.status = path.lost ? "lost" : "flown";
  report.status_mark = path.lost ? Mark::fail : Mark::pass;

  const Drawing drawing = paths(plan, path);
  report.sections.push_back({"Path",
                             {PathView{"Path from above", Projection::above, drawing},
                              PathView{"Path from the south", Projection::from_south, drawing}}});

  Chart distance = chart_over_time("Distance from the plan", "distance", "m");
  distance.series = {series_of("distance", path, [](const auto& s) { return s.position_error; })};
  Chart yaw = chart_over_time("Yaw against the plan", "yaw", "\u00b0");
  yaw.series = {series_of("error", path, [](const auto& s) { return degrees(s.yaw_error); })};
  report.sections.push_back({"Tracking", {distance, yaw}});

  Chart thrusts = chart_over_time("Rotor thrusts", "thrust", "N");
  constexpr std::array kRotors = {"rotor 1", "rotor 2", "rotor 3", "rotor 4"};
  for (int i = 0; i < 4; ++i)
    thrusts.series.push_back(
        series_of(kRotors[i], path, [i](const auto& s) { return s.state.rotor_thrusts(i); }));
  thrusts.limits = {{"largest", vehicle.rotors.thrust_max},
                    {"smallest", vehicle.rotors.thrust_min}};
  Chart tilt = chart_over_time("Tilt", "angle to the vertical", "\u00b0");
  tilt.series = {series_of("tilt", path, [](const auto& s) {
    const Eigen::Vector3d up = s.state.orientation * Eigen::Vector3d::UnitZ();
    return degrees(std::atan2(up.head<2>().norm(), up.z()));
  })};
  report.sections.push_back({"Vehicle", {thrusts, tilt}});
  return report;
}

}  // namespace lapwing
