// SPDX-License-Identifier: Apache-2.0
#include "framework/export/runs_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <tuple>

#include "framework/core/units.h"
#include "framework/export/flight_charts.h"

namespace lapwing {
namespace {

constexpr double kDash = 0.4;  // m, and as much between two
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// Of each line one, with gaps between them, so that they are one name in the legend.
Polyline all_ways(const SimulatedRuns& runs, std::size_t worst) {
  const Eigen::Vector3d gap = Eigen::Vector3d::Constant(std::nan(""));
  Polyline line{std::to_string(runs.runs.size()) + " flown ways", {}, {}, {}};
  for (std::size_t i = 0; i < runs.runs.size(); ++i) {
    if (i == worst) continue;
    if (!line.points.empty()) line.points.push_back(gap);
    for (const FlownSample& s : runs.runs[i].path.samples)
      line.points.push_back(s.state.position.allFinite() ? s.state.position : gap);
  }
  return line;
}

Polyline dashed(const SeededRun& run) {
  const Eigen::Vector3d gap = Eigen::Vector3d::Constant(std::nan(""));
  Polyline line{"worst run, seed " + std::to_string(run.conditions.seed), {}, {}, {}};
  double way = 0;
  Eigen::Vector3d before = gap;
  for (const FlownSample& s : run.path.samples) {
    const Eigen::Vector3d& p = s.state.position;
    if (!p.allFinite()) break;
    if (before.allFinite()) way += (p - before).norm();
    before = p;
    line.points.push_back(static_cast<std::int64_t>(way / kDash) % 2 == 0 ? p : gap);
  }
  return line;
}

Drawing ways(const Plan& plan, const SimulatedRuns& runs, const std::filesystem::path& folder) {
  Drawing drawing;
  Polyline planned{"planned", {}, {}, {}};
  const std::size_t worst = runs.worst();
  for (const FlownSample& s : runs.runs[worst].path.samples) planned.points.push_back(s.wanted);
  drawing.lines = {planned};
  if (runs.runs.size() > 1) drawing.lines.push_back(all_ways(runs, worst));
  drawing.lines.push_back(dashed(runs.runs[worst]));
  add_task(plan, folder, drawing);
  return drawing;
}

// Quantiles of the distance from the plan at each kept time, over the runs that came so far.
Chart distances(const SimulatedRuns& runs) {
  Chart chart;
  chart.title = "Distance from the plan";
  chart.x = {"time", "s"};
  chart.y = {"distance", "m"};
  std::size_t longest = 0;
  for (std::size_t i = 0; i < runs.runs.size(); ++i)
    if (runs.runs[i].path.samples.size() > runs.runs[longest].path.samples.size()) longest = i;
  const auto& times = runs.runs[longest].path.samples;
  const std::pair<const char*, double> kShown[] = {
      {"median", 0.5}, {"95 % of runs", 0.95}, {"worst", 1.0}};
  for (const auto& [name, share] : kShown) chart.series.push_back({name, {}, {}, false});
  for (std::size_t k = 0; k < times.size(); ++k) {
    std::vector<double> errors;
    for (const SeededRun& run : runs.runs)
      if (k < run.path.samples.size()) errors.push_back(run.path.samples[k].position_error);
    for (std::size_t s = 0; s < 3; ++s) {
      chart.series[s].x.push_back(times[k].time);
      chart.series[s].y.push_back(quantile_of(errors, kShown[s].second));
    }
  }
  chart.limits = {{"tolerance", runs.tolerance}};
  return chart;
}

Fact share_fact(const std::string& label, double share) {
  return {label, short_number(100 * share), "%", share == 1 ? Mark::pass : Mark::fail};
}

Facts facts_of(const SimulatedRuns& runs) {
  Facts facts;
  facts.facts = {{"controller", runs.controller, ""},
                 {"conditions", spread_in_words(runs.spread), ""},
                 {"runs", std::to_string(runs.runs.size()), ""}};
  if (const auto share = runs.share(&RunVerdict::gates))
    facts.facts.push_back(share_fact("through all gates", *share));
  facts.facts.push_back(
      share_fact("within " + short_number(runs.tolerance) + " m", runs.followed_share()));
  if (const auto share = runs.share(&RunVerdict::framed))
    facts.facts.push_back(share_fact("with the subject in the image", *share));
  if (const auto share = runs.share(&RunVerdict::distance))
    facts.facts.push_back(share_fact("clear of obstacles and subjects", *share));
  for (const double share : {0.5, 0.95, 1.0})
    facts.facts.push_back({share == 1 ? "worst distance of all runs"
                                      : short_number(100 * share) + " % of runs stay within",
                           short_number(runs.distance_quantile(share)), "m"});
  facts.facts.push_back(
      {"seed of the worst", std::to_string(runs.runs[runs.worst()].conditions.seed), ""});
  return facts;
}

std::string disturbances_in_words(const Disturbances& d, bool drawn) {
  std::string text;
  for (const DisturbanceField& f : disturbance_fields()) {
    const double value = d.*f.field;
    if (value == 0) continue;
    std::string name = f.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    const bool share = std::string(f.unit).empty();
    text += "; " + name + (drawn && f.field == &Disturbances::inertia_error ? " within " : " ") +
            short_number(share       ? 100 * value
                         : f.degrees ? degrees(value)
                                     : value) +
            " " +
            (share                          ? "%"
             : !f.degrees                   ? f.unit
             : std::string(f.unit) == "rad" ? "degrees"
                                            : "degrees/s");
  }
  return text;
}

std::string words_of(const FlightConditions& c, bool drawn) {
  std::string text = "still air";
  if (c.wind_mean != 0 || c.wind_gust != 0)
    text = "wind " + short_number(c.wind_mean) + " m/s towards " +
           short_number(degrees(c.wind_yaw)) + " degrees, gusts " + short_number(c.wind_gust) +
           " m/s, seed " + std::to_string(c.seed);
  const double more = 100 * c.mass_error;
  text += "; mass ";
  if (more == 0)
    text += "as planned";
  else if (drawn)
    text += "within " + short_number(std::abs(more)) + " % of the plan's";
  else
    text += short_number(std::abs(more)) + " % " + (more > 0 ? "above" : "below") + " the plan's";
  return text + disturbances_in_words(c.disturbances, drawn);
}

}  // namespace

std::string in_words(const FlightConditions& conditions) {
  return words_of(conditions, false);
}

std::string spread_in_words(const FlightConditions& conditions) {
  return words_of(conditions, true);
}

std::optional<double> SimulatedRuns::share(std::optional<bool> RunVerdict::*part) const {
  double count = 0;
  for (const RunVerdict& v : verdicts) {
    if (!(v.*part)) return std::nullopt;
    count += *(v.*part);
  }
  return count / static_cast<double>(verdicts.size());
}

double SimulatedRuns::followed_share() const {
  return static_cast<double>(std::count_if(verdicts.begin(), verdicts.end(),
                                           [](const RunVerdict& v) { return v.followed; })) /
         static_cast<double>(verdicts.size());
}

double SimulatedRuns::good_share() const {
  return static_cast<double>(std::count_if(verdicts.begin(), verdicts.end(),
                                           [](const RunVerdict& v) { return v.good(); })) /
         static_cast<double>(verdicts.size());
}

std::size_t SimulatedRuns::worst() const {
  const auto rank = [&](std::size_t i) {
    const FlownPath& path = runs[i].path;
    return std::tuple(
        path.lost, !verdicts[i].gates.value_or(true),
        std::isfinite(path.position_error_worst) ? path.position_error_worst : kInfinite);
  };
  std::size_t worst = 0;
  for (std::size_t i = 1; i < runs.size(); ++i)
    if (rank(i) > rank(worst)) worst = i;
  return worst;
}

double SimulatedRuns::distance_quantile(double share) const {
  std::vector<double> worst;
  for (const SeededRun& run : runs) worst.push_back(run.path.position_error_worst);
  return quantile_of(std::move(worst), share);
}

Value to_value(const FlightConditions& conditions) {
  Value value = Value::map();
  value.set("wind", conditions.wind_mean);
  value.set("gusts", conditions.wind_gust);
  value.set("wind_yaw", conditions.wind_yaw);
  value.set("mass_error", conditions.mass_error);
  for (const DisturbanceField& f : disturbance_fields())
    if (conditions.disturbances.*f.field != 0) value.set(f.name, conditions.disturbances.*f.field);
  value.set("seed", static_cast<std::int64_t>(conditions.seed));
  return value;
}

Value to_value(const SimulatedRuns& runs) {
  Value value = Value::map();
  value.set("controller", runs.controller);
  value.set("conditions", to_value(runs.spread));
  value.set("runs", static_cast<std::int64_t>(runs.runs.size()));
  value.set("tolerance", runs.tolerance);
  value.set("good_share", runs.good_share());
  value.set("followed_share", runs.followed_share());
  if (const auto share = runs.share(&RunVerdict::gates)) value.set("gates_share", *share);
  if (const auto share = runs.share(&RunVerdict::framed)) value.set("framed_share", *share);
  if (const auto share = runs.share(&RunVerdict::distance)) value.set("clear_share", *share);
  Value& quantiles = value.set("position_error", Value::map());
  const std::pair<const char*, double> kTold[] = {
      {"least", 0.0}, {"quarter", 0.25}, {"median", 0.5}, {"95", 0.95}, {"worst", 1.0}};
  for (const auto& [name, share] : kTold) {
    const double quantile = runs.distance_quantile(share);
    if (std::isfinite(quantile)) quantiles.set(name, quantile);
  }
  const SeededRun& worst = runs.runs[runs.worst()];
  Value& case_ = value.set("worst", Value::map());
  case_.set("seed", static_cast<std::int64_t>(worst.conditions.seed));
  case_.set("lost", worst.path.lost);
  if (std::isfinite(worst.path.position_error_worst)) {
    case_.set("position_error_worst", worst.path.position_error_worst);
    case_.set("position_error_at", worst.path.position_error_at);
  }
  return value;
}

Report runs_report(const Plan& plan, const Vehicle& vehicle, const SimulatedRuns& runs,
                   const std::filesystem::path& folder) {
  Report report;
  report.title = plan.mission;
  report.subtitle = std::to_string(runs.runs.size()) + " simulated flights by vehicle '" +
                    vehicle.name + "' under the controller '" + runs.controller + "'";
  const double good = runs.good_share();
  report.status = short_number(100 * good) + " % good";
  report.status_mark = good == 1 ? Mark::pass : Mark::fail;
  report.sections.push_back({"Result", {facts_of(runs)}});
  const Drawing drawing = ways(plan, runs, folder);
  report.sections.push_back({"Flown ways",
                             {PathView{"From above", Projection::above, drawing},
                              PathView{"From the south", Projection::from_south, drawing},
                              Scene3D{"In space", drawing}}});
  report.sections.push_back({"Tracking", {distances(runs)}});
  return report;
}

}  // namespace lapwing
