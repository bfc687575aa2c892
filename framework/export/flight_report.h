// The report of a flight, from its plan alone.
#pragma once

#include <vector>

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// Summary, path, motion, inputs, keyframes, solver, certificate and configuration; sections for
// which the plan holds nothing are left out. Angles in degrees. Certificate and solver report are
// read as DESIGN of plan.json has them: {"feasible", "checks": [{"name", "worst", "limit", "unit",
// "at", "pass", "required", "skipped"}]} and {"name", "status", "iterations", "cost", "terms",
// "history": [{"iteration", "cost", "violation", "step", "terms"}]}.
// Throws InputError naming the field when one of the two or the vehicle is malformed.
std::vector<Section> flight_sections(const Plan& plan);

// The whole page: title, verdict, the sections above.
Report flight_report(const Plan& plan);

}  // namespace lapwing
