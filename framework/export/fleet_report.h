// SPDX-License-Identifier: Apache-2.0
// The report of a fleet: its tours, where and when they are flown, and how near drones come.
#pragma once

#include <filesystem>
#include <span>

#include "framework/export/report.h"
#include "framework/trajectory/fleet.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// s from the beginning of the fleet until its last tour ends. `plans`: one for each tour.
double end_of_fleet(const Fleet& fleet, std::span<const Plan* const> plans);

// The whole page. Each plan holds its certificate, and so does the fleet, where they were judged.
// The report of tour N is the file report_N.html. Meshes are drawn where `folder` holds them.
Report fleet_report(const Fleet& fleet, std::span<const Plan* const> plans,
                    const std::filesystem::path& folder = {});

}  // namespace lapwing
