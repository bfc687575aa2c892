// SPDX-License-Identifier: Apache-2.0
// What two plans are compared by, read from the plans alone.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/value.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// The required check that comes nearest to its limit, or is furthest beyond it. A check of shares
// that must be at least some share counts by what is missing: 0.98 where 0.95 is asked uses 40 %.
struct NearestLimit {
  std::string check;
  double share = 0;  // 1: at the limit
};

struct PlanFigures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string verdict = "not judged";  // certified, not certified
  double duration = 0;                 // s
  double path_length = 0;              // m
  double top_speed = kNone;            // m/s; none for a path without speeds
  double clearance = kNone;            // m, to the nearest obstacle
  double cost = kNone;
  std::vector<std::pair<std::string, double>> terms;  // cost of each
  std::optional<NearestLimit> nearest;
  std::vector<std::string> reasons;  // why it is not certified, a sentence each
};

// InputError naming the field where certificate or solver report is malformed.
PlanFigures figures_of(const Plan& plan);
Value to_value(const PlanFigures& figures);

// Sentences without those that another one contains: what failed is said once.
std::vector<std::string> said_once(const std::vector<std::string>& sentences);

// plan.json of a run folder, beside a report.html, or the file itself. InputError where there is
// none.
std::filesystem::path plan_file(const std::filesystem::path& given);

}  // namespace lapwing
