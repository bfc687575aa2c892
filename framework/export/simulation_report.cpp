// SPDX-License-Identifier: Apache-2.0
#include "framework/export/simulation_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "framework/core/units.h"
#include "framework/export/flight_charts.h"

namespace lapwing {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

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

Drawing paths(const Plan& plan, const FlownPath& path, const std::filesystem::path& folder) {
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
  add_task(plan, folder, drawing);
  return drawing;
}

Facts facts_of(const Simulation& simulation) {
  const FlightConditions& c = simulation.conditions;
  Facts facts;
  facts.facts = {{"controller", simulation.controller, ""},
                 {"wind", number(c.wind_mean), "m/s"},
                 {"wind blows towards", number(degrees(c.wind_yaw)), "\u00b0"},
                 {"gusts", number(c.wind_gust), "m/s"},
                 {"mass above that of the plan", number(100 * c.mass_error), "%"},
                 {"seed of gusts and noise", std::to_string(c.seed), ""}};
  for (const DisturbanceField& f : disturbance_fields())
    if (c.disturbances.*f.field != 0)
      facts.facts.push_back({f.name, number(c.disturbances.*f.field), f.unit});
  for (const Check& check : simulation.distances)
    facts.facts.push_back(
        {check.name, distance_in_words(check), "", check.pass ? Mark::pass : Mark::fail});
  return facts;
}

}  // namespace

bool Simulation::too_near() const {
  return std::any_of(distances.begin(), distances.end(), [](const Check& c) { return !c.pass; });
}

std::string Simulation::conditions_in_words() const {
  return in_words(conditions);
}

std::string distance_in_words(const Check& check) {
  return (check.worst ? number(*check.worst) : std::string("?")) + " m at " + number(check.at) +
         " s, " + number(check.limit) + " m are required: " + check.detail;
}

Report simulation_report(const Plan& plan, const Vehicle& vehicle, const Simulation& simulation,
                         const std::filesystem::path& folder) {
  const FlownPath& path = simulation.path;
  Report report;
  report.title = plan.mission;
  report.subtitle = "simulated flight of vehicle '" + vehicle.name + "'";
  report.status = path.lost ? "lost" : simulation.too_near() ? "too near" : "flown";
  report.status_mark = path.lost || simulation.too_near() ? Mark::fail : Mark::pass;
  report.sections.push_back({"Conditions and distances", {facts_of(simulation)}});

  const Drawing drawing = paths(plan, path, folder);
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
