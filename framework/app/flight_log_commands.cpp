// SPDX-License-Identifier: Apache-2.0
#include "framework/app/flight_log_commands.h"

#include <CLI/CLI.hpp>

namespace lapwing {
namespace {

void add_log(CLI::App& command, FlightLogRequest& asked) {
  add_text(command, "log", "LOG", "a recorded flight: .ulg, .bin, .tlog, .csv, .gpx, .mcap",
           [&](const std::string& path) { asked.log = path; })
      ->required();
  add_text(command, "--format", "NAME[:KEY=VALUE,...]",
           "a reader and its parameters; default: the one that recognizes the content",
           [&](const std::string& name) { asked.format = name; });
}

void add_compare(CLI::App& app, Invocation& invocation, FlightLogRequest& asked, Command& command) {
  CLI::App* compare = app.add_subcommand("compare", "compare a flown flight with its plan");
  add_plan(*compare, asked.plan);
  add_log(*compare, asked);
  add_text(*compare, "--origin", "LAT,LON,HEIGHT,OF",
           "origin of a plan that has none: degrees north, degrees east, height in m of z = 0 "
           "above OF: ellipsoid, sea, or ground (that at the origin); default: none",
           [&](const std::string& text) { asked.origin = text; });
  add_text(*compare, "--time-offset", "S",
           "time of the log, in s, at which the plan begins; default: estimated",
           [&](const std::string& text) { asked.clock = read_number("--time-offset", text); });
  compare->add_flag("--no-offset", asked.no_offset,
                    "take the positions of the log as they are; otherwise their constant offset "
                    "is estimated");
  compare->add_flag("--turn", asked.turn,
                    "estimate the heading of the log's local frame too, where nothing places it on "
                    "the earth");
  add_page(*compare, asked.target);
  add_json(*compare, invocation);
  compare->callback([&] { command = [&] { return compare_flight(asked, invocation); }; });
}

}  // namespace

void add_flight_log_commands(CLI::App& app, Invocation& invocation, FlightLogRequest& asked,
                             Command& command) {
  add_compare(app, invocation, asked, command);
  CLI::App* log = app.add_subcommand("log", "logs of flights");
  log->require_subcommand(1);
  CLI::App* info = log->add_subcommand("info", "print the content of a flight log");
  add_log(*info, asked);
  add_json(*info, invocation);
  info->callback([&] { command = [&] { return show_flight_log(asked, invocation); }; });
  CLI::App* vehicle = app.add_subcommand("vehicle", "vehicle files");
  vehicle->require_subcommand(1);
  CLI::App* from = vehicle->add_subcommand("from", "write a vehicle file with the limits of a log");
  add_log(*from, asked);
  add_text(*from, "--base", "FILE",
           "vehicle file, or its name in configs/, that states what a log does not show; default: "
           "vehicles/solo",
           [&](const std::string& name) { asked.base = name; });
  add_text(*from, "-o,--output", "FILE", "the file to write; default: print it",
           [&](const std::string& path) { asked.target = path; });
  add_json(*from, invocation);
  from->callback([&] { command = [&] { return vehicle_from_log(asked, invocation); }; });
}

}  // namespace lapwing
