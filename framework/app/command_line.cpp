// SPDX-License-Identifier: Apache-2.0
#include "framework/app/command_line.h"
#include "framework/app/command_options.h"
#include "framework/app/command_reference.h"
#include "framework/app/descriptions.h"
#include "framework/app/diff_command.h"
#include "framework/app/evaluate_explore.h"
#include "framework/app/flight_log_commands.h"
#include "framework/app/fly_command.h"
#include "framework/app/help_commands.h"
#include "framework/app/item_command.h"
#include "framework/app/new_files.h"
#include "framework/app/plugin_check.h"
#include "framework/app/plugin_guard.h"
#include "framework/app/provenance.h"
#include "framework/app/reproduce_command.h"
#include "framework/app/scan_check.h"
#include "framework/app/simulation_request.h"
#include "framework/app/studio_command.h"
#include "framework/app/sweep_command.h"
#include "framework/app/terminal.h"
#include "framework/app/tour_command.h"
#include "framework/app/train_command.h"
#include "framework/app/version.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <new>
#include <sstream>
#include <system_error>

#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/core/visible_text.h"
#include "framework/mission/controller_source.h"

namespace lapwing {

const char* program_version() {
  return LAPWING_VERSION;
}

namespace {

void add_run(CLI::App& app, Invocation& invocation, std::filesystem::path& script,
             Command& command) {
  CLI::App* run = app.add_subcommand("run", "plan a mission, certify and write it");
  add_mission(*run, script);
  add_configuration(*run, invocation);
  add_text(*run, "-o,--out", "DIR", "folder of the results; default: out/<mission>",
           [&](const std::string& path) { invocation.out = path; });
  add_text(*run, "--from", "PLAN.json",
           "begin from this plan of an earlier run; default: from a guess",
           [&](const std::string& path) { invocation.from = path; });
  run->add_flag("--keep", invocation.keep, "keep an older run in the folder as DIR.1, DIR.2, ...");
  run->add_flag("--report-data", invocation.report_data,
                "write report.json too: tables, curves and pictures of the report");
  add_threads(*run, invocation, "threads to use; default: one per core");
  run->add_flag("--quiet", invocation.quiet, "no progress, no summary");
  run->add_flag("--verbose", invocation.verbose, "print failed attempts too");
  add_json(*run, invocation);
  run->callback([&] { command = [&] { return run_mission(script, invocation); }; });

  CLI::App* config = app.add_subcommand("config", "print effective options with their origins");
  add_mission(*config, script);
  add_configuration(*config, invocation);
  add_json(*config, invocation);
  config->callback([&] { command = [&] { return show_configuration(script, invocation); }; });
}

void add_sweep(CLI::App& app, Invocation& invocation, Sweep& asked, Command& command) {
  CLI::App* sweep = app.add_subcommand("sweep", "run a mission with several values of its options");
  add_mission(*sweep, asked.script);
  add_configuration(*sweep, invocation);
  add_repeated(*sweep, "--vary", "KEY=VALUE,VALUE,...", asked.varied,
               "values of one option; repeatable: all combinations are run; default: none");
  add_count(*sweep, "--jobs", 1, 64, "runs at once in one process; default: 2, with mpi 1",
            [&](std::uint64_t jobs) { asked.jobs = static_cast<int>(jobs); });
  add_text(*sweep, "-o,--out", "DIR", "folder of the results; default: out/sweep",
           [&](const std::string& path) { invocation.out = path; });
  add_items(*sweep, asked.items, "continue an interrupted sweep: run what is missing");
  sweep->add_flag("--quiet", invocation.quiet, "no progress, no table");
  add_json(*sweep, invocation);
  sweep->callback([&] { command = [&] { return sweep_missions(asked, invocation); }; });
}

void add_plan_commands(CLI::App& app, Invocation& invocation, std::filesystem::path& plan,
                       ExportRequest& asked, Judges& judges, Command& command) {
  CLI::App* verify =
      app.add_subcommand("verify", "judge a plan or a fleet again, independently of its solver");
  add_text(*verify, "plan", "PLAN.json|FLEET",
           "plan document; fleet.json, or its folder, judges all its plans and the fleet",
           [&](const std::string& path) { plan = path; })
      ->required();
  add_text(*verify, "--vehicle", "FILE",
           "vehicle file, or its name in configs/, that states the limits; default: the vehicle of "
           "the plan",
           [&](const std::string& path) { judges.vehicle = path; });
  add_text(*verify, "--environment", "FILE",
           "YAML file that states the obstacles; default: those of the plan",
           [&](const std::string& path) { judges.environment = path; });
  add_json(*verify, invocation);
  verify->callback([&] { command = [&] { return verify_plan(plan, judges, invocation); }; });

  CLI::App* exported = app.add_subcommand("export", "write a plan in another format");
  add_plan(*exported, asked.plan);
  add_text(*exported, "--format", "NAME[:KEY=VALUE,...]", "an exporter and its parameters",
           [&](const std::string& name) { asked.format = name; })
      ->required();
  add_text(*exported, "-o,--output", "PATH", "the file to write", [&](const std::string& path) {
    asked.target = path;
  })->required();
  exported->add_flag("--uncertified", asked.uncertified,
                     "also export a plan that is not certified");
  add_text(*exported, "--origin", "LAT,LON,HEIGHT,OF",
           "origin of a plan that has none: degrees north, degrees east, height in m of z = 0 "
           "above OF: ellipsoid, sea, or ground (that at the origin); default: none",
           [&](const std::string& text) { asked.origin = text; });
  exported->callback([&] { command = [&] { return export_plan(asked, invocation); }; });
}

void add_map_commands(CLI::App& app, Invocation& invocation, std::filesystem::path& file,
                      std::filesystem::path& target, Command& command) {
  CLI::App* map = app.add_subcommand("map", "map files: .bt, .ot");
  map->require_subcommand(1);
  const auto add = [&](const char* name, const char* help) {
    CLI::App* made = map->add_subcommand(name, help);
    add_text(*made, "file", "MAP", "a .bt or .ot file", [&](const std::string& path) {
      file = path;
    })->required();
    return made;
  };
  CLI::App* info = add("info", "print the content of a map");
  add_json(*info, invocation);
  info->callback([&] { command = [&] { return show_map(file, invocation); }; });
  CLI::App* convert = add("convert", "write a map in another format: .ot, .bt, .ply");
  CLI::App* view = add("view", "write a report page with pictures");
  add_text(*convert, "-o,--output", "PATH", "the file to write", [&](const std::string& path) {
    target = path;
  })->required();
  add_page(*view, target)->required();
  convert->callback([&] { command = [&] { return convert_map(file, target, invocation); }; });
  view->callback([&] { command = [&] { return view_map(file, target, invocation); }; });
}

void add_scene_commands(CLI::App& app, Invocation& invocation, std::filesystem::path& file,
                        SceneStatement& stated, std::filesystem::path& target, Command& command) {
  CLI::App* scene = app.add_subcommand("scene", "scenes: meshes, and scripts that make them");
  scene->require_subcommand(1);
  CLI::App* view = scene->add_subcommand("view", "write a report page with pictures");
  add_text(*view, "file", "SCENE", "a mesh file, a Lua scene, or the name of a shipped one",
           [&](const std::string& path) { file = path; })
      ->required();
  add_page(*view, target)->required();
  add_count(*view, "--seed", 0, kLargestSeed, "seed of a Lua scene; default: that of the scene",
            [&](std::uint64_t seed) { stated.seed = seed; });
  add_text(*view, "--unit", "M", "m per unit of a mesh file; default: what the file says",
           [&](const std::string& text) { stated.unit = read_number("--unit", text); });
  add_text(*view, "--up", "x|y|z",
           "the axis of a mesh file that points up; default: what the file says",
           [&](const std::string& axis) { stated.up = axis; });
  view->callback([&] { command = [&] { return view_scene(file, stated, target, invocation); }; });
}

void add_race_command(CLI::App& app, Invocation& invocation, std::filesystem::path& plan,
                      std::vector<std::string>& pilots, RaceRules& rules,
                      std::filesystem::path& target, Command& command) {
  CLI::App* race = app.add_subcommand("race", "fly a course by hand, from stick logs of pilots");
  add_plan(*race, plan);
  add_repeated(*race, "--pilot", "LOG[:KEY=VALUE,...]", pilots,
               "a stick log (CSV: time,forward,left) with settings of its pilot: name, weight, "
               "strength, reach, speed, handicap; repeatable, at least one; no default; out is who "
               "needs more than 3 times the time of the plan divided by speed");
  add_text(*race, "--deviation-price", "S",
           "penalty in s per m of mean deviation from the course; default: 5",
           [&](const std::string& text) {
             rules.deviation_price = read_number("--deviation-price", text);
           });
  add_text(*race, "--gate-price", "S", "penalty in s per missed gate; default: 10",
           [&](const std::string& text) { rules.gate_price = read_number("--gate-price", text); });
  add_page(*race, target);
  add_json(*race, invocation);
  race->callback(
      [&] { command = [&] { return race_plan(plan, pilots, rules, target, invocation); }; });
}

ExitStatus report_error(const Invocation& invocation, ExitStatus status,
                        const std::string& message) {
  std::cerr << tinted_error(Tone::bad, "lapwing:") << " " << visible_text(message) << "\n";
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "failed");
    object.set("error", as_utf8(message));
    print_json(object);
  }
  return status;
}

ExitStatus guarded_command(const Command& command, const Invocation& invocation) {
  try {
    return command();
  } catch (const InputError& error) {
    return report_error(invocation, ExitStatus::bad_input, error.what());
  } catch (const Cancelled&) {
    return report_error(invocation, ExitStatus::interrupted, "cancelled");
  } catch (const std::filesystem::filesystem_error& error) {  // a path that nobody checked before
    return report_error(invocation, ExitStatus::bad_input,
                        "cannot use '" + error.path1().string() + "': " + error.code().message());
  } catch (const std::bad_alloc&) {
    return report_error(invocation, ExitStatus::defect,
                        "out of memory: it needs more than the system or a limit (ulimit -v) "
                        "gives");
  } catch (const std::system_error& error) {
    const bool scarce = error.code() == std::errc::resource_unavailable_try_again;
    return report_error(invocation, ExitStatus::defect,
                        scarce ? "the system refuses more threads or memory; is there a limit "
                                 "(ulimit -u, ulimit -v)?"
                               : std::string("internal error: ") + error.what());
  } catch (const std::exception& error) {
    return report_error(invocation, ExitStatus::defect,
                        std::string("internal error: ") + error.what());
  } catch (...) {
    return report_error(invocation, ExitStatus::defect, "internal error of unknown kind");
  }
}

}  // namespace

void print_json(const Value& value) {
  std::cout << to_json(value) << std::endl;
}

Registry Invocation::registry() const {
  guard_plugin_calls(call_limit_from_environment());
  return Registry(plugin_search_path(plugin_path));
}

ControllerSource controllers_of(const Invocation& invocation) {
  return [invocation](const ControllerChoice& choice) {
    const Registry registry = invocation.registry();
    return controllers_of(registry)(choice);
  };
}

namespace {

// What the options of a command line are read into.
struct Requests {
  Invocation invocation;
  std::filesystem::path script, plan, target;
  std::string name;
  ExportRequest exporting;
  Judges judges;
  SimulationRequest simulation;
  FlightLogRequest flight_log;
  SceneStatement stated;
  std::vector<std::string> pilots;
  RaceRules rules;
  FlyRequest flying;
  AutopilotRequest autopilot;
  TourRun tour;
  TrainRequest training;
  PluginCheck checking;
  Description described;
  NewFiles wanted;
  Sweep sweep;
  StudioRequest studio;
  PlanDifference difference;
  ScanEvaluation scanning;
  ScanCheckRequest checking_scan;
  ReproduceRequest reproducing;
  ExploreEvaluation exploring;
  HelpRequest help;
  Command command;
};

// Everything that there is. `asked` outlives the parse and the command.
void declare_commands(CLI::App& app, Requests& asked) {
  Invocation& invocation = asked.invocation;
  Command& command = asked.command;
  app.set_version_flag("--version", std::string("lapwing ") + program_version(),
                       "print the version of the program");
  app.require_subcommand(1);
  add_repeated(app, "--plugin-path", "DIR", invocation.plugin_path,
               "a folder of plugins, searched first; repeatable; default: none");
  add_colour(app);
  app.fallthrough();
  add_run(app, invocation, asked.script, command);
  add_sweep(app, invocation, asked.sweep, command);
  add_studio_commands(app, invocation, asked.studio, command);
  add_difference(app, invocation, asked.difference, command);
  add_plan_commands(app, invocation, asked.plan, asked.exporting, asked.judges, command);
  add_simulate_command(app, invocation, asked.plan, asked.simulation, asked.target, command);
  add_flight_log_commands(app, invocation, asked.flight_log, command);
  add_fly_command(app, invocation, asked.flying, command);
  add_autopilot_command(app, invocation, asked.autopilot, command);
  add_map_commands(app, invocation, asked.plan, asked.target, command);
  add_scene_commands(app, invocation, asked.plan, asked.stated, asked.target, command);
  add_race_command(app, invocation, asked.plan, asked.pilots, asked.rules, asked.target, command);
  add_tour_command(app, invocation, asked.tour, command);
  add_scan_commands(app, invocation, asked.checking_scan, command);
  add_plugin_commands(app, invocation, asked.name, asked.described, asked.checking, command);
  add_description_commands(app, invocation, asked.described, command);
  add_new_commands(app, invocation, asked.wanted, command);
  add_train_commands(app, invocation, asked.training, command);
  CLI::App* evaluate = app.add_subcommand("evaluate", "studies that compare methods");
  evaluate->require_subcommand(1);
  add_evaluate_scan(*evaluate, invocation, asked.scanning, command);
  add_reproduce_command(app, invocation, asked.reproducing, command);
  add_evaluate_explore(*evaluate, invocation, asked.exploring, command);
  add_help_commands(app, invocation, asked.help, command);
  add_footers(app);
}

constexpr const char* kAbout = "Plan flights for camera drones.";

}  // namespace

CommandEntry command_tree() {
  CLI::App app(kAbout, "lapwing");
  Requests asked;
  declare_commands(app, asked);
  return entry_of(app, "lapwing");
}

int run_command_line(int argc, const char* const* argv) {
  CLI::App app(kAbout, "lapwing");
  Requests asked;
  declare_commands(app, asked);
  choose_colour(ColourChoice::automatic);
  // Documents name files, and JSON holds nothing else.
  for (int k = 1; k < argc; ++k)
    if (!is_utf8(argv[k])) {
      asked.invocation.json = std::any_of(argv + 1, argv + argc,
                                          [](const char* a) { return std::string(a) == "--json"; });
      return static_cast<int>(
          report_error(asked.invocation, ExitStatus::bad_input,
                       "'" + as_utf8(argv[k]) + "': a name or text that is not UTF-8; rename it"));
    }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool success = dynamic_cast<const CLI::Success*>(&error) != nullptr;  // --help, --version
    if (launched_rank() > 0) return static_cast<int>(ExitStatus::done);         // process 0 says it
    if (success && !help_of_unknown(app)) return app.exit(error);
    std::cerr << tinted_error(Tone::bad, "lapwing:") << " " << visible_text(usage_error(app, error))
              << "\n";
    return static_cast<int>(ExitStatus::bad_input);
  }
  return static_cast<int>(guarded_command(asked.command, asked.invocation));
}

}  // namespace lapwing
