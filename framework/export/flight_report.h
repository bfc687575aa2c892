// SPDX-License-Identifier: Apache-2.0
// The report of a flight, from its plan alone.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// Summary, path, motion, inputs, keyframes, solver, certificate and configuration; sections for
// which the plan holds nothing are left out. Angles in degrees. The solver's report is read as
// {"name", "status", "iterations", "cost", "message", "terms": {name: cost}, "history":
// [{"iteration", "cost", "violation", "step", "terms"}]}; "message", "terms" and "history" may
// lack. Throws InputError naming the field when certificate, solver report or vehicle is malformed.
// Meshes of the environment are drawn where `folder`, the plan's, holds them.
std::vector<Section> flight_sections(const Plan& plan, const std::filesystem::path& folder = {});

// The checks of a certificate, safety and task one by one.
Section certificate_section(const Certificate& certificate);

// The whole page: title, verdict, the sections above.
Report flight_report(const Plan& plan, const std::filesystem::path& folder = {});

}  // namespace lapwing
