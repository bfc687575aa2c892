// The report page of a plan that was flown in simulation.
#pragma once

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {

Report simulation_report(const Plan& plan, const Vehicle& vehicle, const FlownPath& path);

}  // namespace lapwing
