// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "framework/app/command_options.h"
#include "framework/app/scan_check.h"

namespace lapwing {
namespace {

double read_above_zero(const std::string& option, const std::string& text) {
  const double number = read_number(option, text);
  if (!(number > 0))
    throw CLI::ValidationError(option, "expected a number above 0, not '" + text + "'");
  return number;
}

}  // namespace

void add_scan_commands(CLI::App& app, Invocation& invocation, ScanCheckRequest& asked,
                       Command& command) {
  CLI::App* scan = app.add_subcommand("scan", "scans after their flight");
  scan->require_subcommand(1);
  CLI::App* check = scan->add_subcommand(
      "check", "compare the photographs of a flight with the views of its plan");
  add_text(*check, "folder", "FOLDER",
           "photographs (.jpg) with GPS positions in their EXIF data, or a COLMAP model",
           [&](const std::string& path) { asked.folder = path; })
      ->required();
  add_text(*check, "--plan", "PLAN.json", "the plan of the scan", [&](const std::string& path) {
    asked.plan = path;
  })->required();
  add_text(*check, "--photos", "DIR",
           "photographs whose GPS positions place the COLMAP model; default: none",
           [&](const std::string& path) { asked.photos = path; });
  add_text(*check, "--gps-accuracy", "M",
           "accuracy of these positions, in m; those three times farther off are left out; "
           "default: 5",
           [&](const std::string& text) {
             asked.gps_accuracy = read_above_zero("--gps-accuracy", text);
           });
  check->add_flag("--placed", asked.placed,
                  "the COLMAP model is in metres, in the frame of the plan");
  add_text(*check, "--within", "M",
           "largest distance of a photograph from its view, in m; default: 3",
           [&](const std::string& text) { asked.within = read_above_zero("--within", text); });
  add_text(*check, "--angle", "DEG",
           "largest angle between their directions, in degrees, where that of the photograph is "
           "known; default: 15",
           [&](const std::string& text) { asked.angle_deg = read_above_zero("--angle", text); });
  add_text(
      *check, "--height-offset", "M",
      "height of the photographs above the plan, in m, by another reference of altitudes; "
      "default: estimated, with --placed 0",
      [&](const std::string& text) { asked.height_offset = read_number("--height-offset", text); });
  add_text(*check, "-o,--output", "FILE.lua",
           "write a mission for the views that are missing; default: none",
           [&](const std::string& path) { asked.rest = path; });
  add_json(*check, invocation);
  check->callback([&] { command = [&] { return check_scan(asked, invocation); }; });
}

}  // namespace lapwing
