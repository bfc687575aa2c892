// SPDX-License-Identifier: Apache-2.0
// Many simulated flights of one plan: what became of them, and the page that shows them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/monte_carlo.h"

namespace lapwing {

// What one flight came to. What the plan does not ask for is absent.
struct RunVerdict {
  bool followed = false;         // not lost, and always within the tolerance
  std::optional<bool> gates;     // through all of them
  std::optional<bool> framed;    // subjects in the image for the share of time that is asked
  std::optional<bool> distance;  // from obstacles and subjects, kept
  bool good() const {
    return followed && gates.value_or(true) && framed.value_or(true) && distance.value_or(true);
  }
};

struct SimulatedRuns {
  std::string controller;
  FlightConditions spread;
  double tolerance = 0;  // m
  std::vector<SeededRun> runs;
  std::vector<RunVerdict> verdicts;  // one for each run

  // Share of the runs for which a part of the verdict is true; absent where the plan asks for none.
  std::optional<double> share(std::optional<bool> RunVerdict::*part) const;
  double followed_share() const;
  double good_share() const;
  // A lost one before others, then one that misses gates, then the one furthest from the plan.
  std::size_t worst() const;
  // Of the worst distances of all runs, m.
  double distance_quantile(double share) const;
};

// "still air; mass as planned", "wind 5 m/s towards 0 degrees, gusts 1 m/s; mass 5 % above the
// plan's; estimate 0.01 s old": all that is on.
std::string in_words(const FlightConditions& conditions);
// The same for drawn ones: "mass within 5 % of the plan's".
std::string spread_in_words(const FlightConditions& conditions);

Value to_value(const FlightConditions& conditions);
Value to_value(const SimulatedRuns& runs);

// Gates with the ways of all runs in one picture, the worst dashed; quantiles over time.
Report runs_report(const Plan& plan, const Vehicle& vehicle, const SimulatedRuns& runs,
                   const std::filesystem::path& folder);

}  // namespace lapwing
