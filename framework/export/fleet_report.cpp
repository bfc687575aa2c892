// SPDX-License-Identifier: Apache-2.0
#include "framework/export/fleet_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "framework/core/error.h"
#include "framework/export/flight_charts.h"
#include "framework/export/flight_report.h"
#include "framework/trajectory/interpolate.h"
#include "framework/verify/certificate.h"

namespace lapwing {
namespace {

constexpr int kDistanceSteps = 2000;  // of a chart

struct FleetVerdict {
  std::string text = "not judged";
  Mark mark = Mark::none;
};

FleetVerdict fleet_verdict_of(const Value& certificate) {
  if (certificate.is_null()) return {};
  const bool feasible = Certificate::from_value(certificate).feasible();
  return {feasible ? "certified" : "not certified", feasible ? Mark::pass : Mark::fail};
}

Axis fleet_time() {
  return {"time since the fleet begins", "s"};
}

Table tour_table(const Fleet& fleet, std::span<const Plan* const> plans) {
  Table table{"Tours, in the order of their starts",
              {{"drone", ""},
               {"battery", ""},
               {"begins", "s"},
               {"flight", "s"},
               {"images", ""},
               {"plan", ""},
               {"report", ""}},
              {}};
  for (std::size_t t = 0; t < plans.size(); ++t) {
    const FleetTour& tour = fleet.tours[t];
    const auto& scan = plans[t]->task.scan;
    table.rows.push_back({{tour.drone, double(tour.battery), tour.start,
                           plans[t]->trajectory.duration(), double(scan ? scan->views.size() : 0),
                           tour.file, "report_" + std::to_string(t + 1) + ".html"},
                          fleet_verdict_of(plans[t]->certificate).mark});
  }
  return table;
}

Section fleet_section(const Fleet& fleet, std::span<const Plan* const> plans) {
  const int swaps = swaps_of(fleet);
  Facts facts;
  facts.facts = {{"tours", std::to_string(fleet.tours.size()), ""},
                 {"drones", std::to_string(static_cast<int>(fleet.tours.size()) - swaps), ""},
                 {"changes of batteries", std::to_string(swaps), ""},
                 {"last tour ends", number_text(end_of_fleet(fleet, plans)), "s"},
                 {"smallest distance of two drones", number_text(fleet.separation), "m"},
                 {"smallest time between two tours of a drone", number_text(fleet.swap), "s"},
                 {"reserve of every battery", number_text(fleet.reserve), "s"},
                 {"voxels that all tours see", std::to_string(fleet.seen), ""}};
  return {"Fleet", {std::move(facts), tour_table(fleet, plans)}};
}

Chart height_chart(const Fleet& fleet, std::span<const Plan* const> plans) {
  Chart chart;
  chart.title = "Height over time";
  chart.x = fleet_time();
  chart.y = {"height in the world", "m"};
  for (std::size_t t = 0; t < plans.size(); ++t) {
    Series series{name_of_tour(fleet.tours[t]), {}, {}};
    for (const Sample& s : plans[t]->trajectory.samples) {
      series.x.push_back(fleet.tours[t].start + s.time);
      series.y.push_back(s.position.z());
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

// The least distance of two drones at a time; infinite where fewer than two fly.
double least_distance(const Fleet& fleet, std::span<const Plan* const> plans, double time) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::pair<const std::string*, Eigen::Vector3d>> flying;
  for (std::size_t t = 0; t < plans.size(); ++t) {
    const Trajectory& flight = plans[t]->trajectory;
    const double own = time - fleet.tours[t].start;
    if (own < 0 || own > flight.duration()) continue;
    const Eigen::Vector3d at = sample_at(flight, flight.samples.front().time + own).position;
    for (const auto& [drone, position] : flying)
      if (*drone != fleet.tours[t].drone) least = std::min(least, (position - at).norm());
    flying.emplace_back(&fleet.tours[t].drone, at);
  }
  return least;
}

std::optional<Chart> distance_chart(const Fleet& fleet, std::span<const Plan* const> plans) {
  Series series{"smallest distance", {}, {}};
  const double end = end_of_fleet(fleet, plans);
  bool met = false;
  for (int k = 0; k <= kDistanceSteps; ++k) {
    const double time = end * k / kDistanceSteps;
    series.x.push_back(time);
    series.y.push_back(least_distance(fleet, plans, time));
    met = met || std::isfinite(series.y.back());
  }
  if (!met) return std::nullopt;
  Chart chart;
  chart.title = "Distance of drones that fly at the same time";
  chart.x = fleet_time();
  chart.y = {"distance", "m"};
  chart.series.push_back(std::move(series));
  if (fleet.separation > 0) chart.limits.push_back({"separation", fleet.separation});
  return chart;
}

}  // namespace

double end_of_fleet(const Fleet& fleet, std::span<const Plan* const> plans) {
  double end = 0;
  for (std::size_t t = 0; t < plans.size(); ++t)
    end = std::max(end, fleet.tours[t].start + plans[t]->trajectory.duration());
  return end;
}

Report fleet_report(const Fleet& fleet, std::span<const Plan* const> plans,
                    const std::filesystem::path& folder) {
  if (plans.empty() || plans.size() != fleet.tours.size())
    throw Error("a report of a fleet needs one plan for each tour");
  const FleetVerdict verdict = fleet_verdict_of(fleet.certificate);
  Report report;
  report.title = fleet.mission;
  report.subtitle = fleet.kind + ", " + std::to_string(fleet.tours.size()) + " tours, " +
                    number_text(end_of_fleet(fleet, plans)) + " s in all";
  report.status = verdict.text;
  report.status_mark = verdict.mark;
  report.sections.push_back(fleet_section(fleet, plans));
  std::vector<std::pair<std::string, const Plan*>> named;
  for (std::size_t t = 0; t < plans.size(); ++t)
    named.emplace_back(name_of_tour(fleet.tours[t]), plans[t]);
  report.sections.push_back(paths_section(named, folder));
  Section times{"Times", {height_chart(fleet, plans)}};
  if (auto distances = distance_chart(fleet, plans)) times.blocks.push_back(std::move(*distances));
  report.sections.push_back(std::move(times));
  if (!fleet.certificate.is_null())
    report.sections.push_back(certificate_section(Certificate::from_value(fleet.certificate)));
  return report;
}

}  // namespace lapwing
