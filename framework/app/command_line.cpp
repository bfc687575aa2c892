#include "framework/app/command_line.h"
#include "framework/app/descriptions.h"
#include "framework/app/evaluate_explore.h"
#include "framework/app/new_files.h"
#include "framework/app/plugin_check.h"
#include "framework/app/sweep_command.h"
#include "framework/app/train_command.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <functional>
#include <iostream>
#include <sstream>

#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"

#ifndef LAPWING_VERSION
#define LAPWING_VERSION "0.1.0"
#endif

namespace lapwing {

namespace {

constexpr std::uint64_t kMostThreads = 1024;
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;  // JSON readers hold no more
constexpr const char* kMovesHelp = "step, turn_deg, body or clear, as a mission's `moves`";

using Command = std::function<ExitStatus()>;

void add_json(CLI::App& command, Invocation& invocation) {
  command.add_flag("--json", invocation.json, "one JSON object on standard output");
}

// Options go through CLI11's callbacks on text: its typed ones instantiate a conversion of every
// kind for each type, which took most of this source's compile time.
CLI::Option* add_text(CLI::App& command, const std::string& name, const std::string& value_name,
                      const std::string& help, std::function<void(const std::string&)> take) {
  const auto callback = [take = std::move(take)](const CLI::results_t& values) {
    for (const std::string& value : values) take(value);
    return true;
  };
  return command.add_option(name, callback, help)->type_name(value_name)->expected(1);
}

// A report page: refused before any work when its name does not say so.
CLI::Option* add_page(CLI::App& command, std::filesystem::path& target) {
  return add_text(command, "-o,--output", "PATH", "the report page to write, .html",
                  [&](const std::string& path) {
                    target = path;
                    if (target.extension() != ".html")
                      throw CLI::ValidationError("-o", "'" + path +
                                                           "' is no name for a page: expected one "
                                                           "that ends in .html");
                  });
}

// Repeatable; every use takes one value, which may hold brackets and commas.
template <class T>
void add_repeated(CLI::App& command, const std::string& name, const std::string& value_name,
                  std::vector<T>& values, const std::string& help) {
  add_text(command, name, value_name, help,
           [&values](const std::string& value) { values.emplace_back(value); })
      ->allow_extra_args(false)
      ->take_all();
}

void add_count(CLI::App& command, const std::string& name, std::uint64_t least, std::uint64_t most,
               const std::string& help, std::function<void(std::uint64_t)> take) {
  add_text(command, name, "N", help, [=](const std::string& text) {
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || end != text.data() + text.size() || count < least || count > most)
      throw CLI::ValidationError(name, "must be a whole number from " + std::to_string(least) +
                                           " to " + std::to_string(most) + ", not '" + text + "'");
    take(count);
  });
}

void add_configuration(CLI::App& command, Invocation& invocation) {
  add_repeated(command, "--config", "FILE", invocation.configs,
               "a configuration file or its name in configs/; later ones win");
  add_repeated(command, "--set", "KEY=VALUE", invocation.overrides, "set one option");
  add_repeated(command, "--data", "DIR", invocation.data, "a folder that the script may read");
  add_count(command, "--seed", 0, kLargestSeed, "of all random numbers",
            [&](std::uint64_t seed) { invocation.seed = seed; });
}

void add_mission(CLI::App& command, std::filesystem::path& script) {
  add_text(command, "mission", "MISSION.lua", "mission script", [&](const std::string& path) {
    script = path;
  })->required();
}

void add_run(CLI::App& app, Invocation& invocation, std::filesystem::path& script,
             Command& command) {
  CLI::App* run = app.add_subcommand("run", "plan a mission, certify and write it");
  add_mission(*run, script);
  add_configuration(*run, invocation);
  add_text(*run, "--out", "DIR", "folder of the results; else out/<mission>",
           [&](const std::string& path) { invocation.out = path; });
  add_count(*run, "--threads", 1, kMostThreads, "threads to use; else one per core",
            [&](std::uint64_t threads) { invocation.threads = static_cast<int>(threads); });
  run->add_flag("--quiet", invocation.quiet, "no progress, no summary");
  add_json(*run, invocation);
  run->callback([&] { command = [&] { return run_mission(script, invocation); }; });

  CLI::App* config = app.add_subcommand("config", "effective options and where each came from");
  add_mission(*config, script);
  add_configuration(*config, invocation);
  add_json(*config, invocation);
  config->callback([&] { command = [&] { return show_configuration(script, invocation); }; });
}

void add_sweep(CLI::App& app, Invocation& invocation, Sweep& asked, Command& command) {
  CLI::App* sweep =
      app.add_subcommand("sweep", "run a mission with several values of its options, in a table");
  add_mission(*sweep, asked.script);
  add_configuration(*sweep, invocation);
  add_repeated(*sweep, "--vary", "KEY=VALUE,VALUE,...", asked.varied,
               "values of one option; of several, all combinations are run");
  add_count(*sweep, "--jobs", 1, 64, "runs at once; else 2",
            [&](std::uint64_t jobs) { asked.jobs = static_cast<int>(jobs); });
  add_text(*sweep, "--out", "DIR", "folder of the results; else out/sweep",
           [&](const std::string& path) { invocation.out = path; });
  add_json(*sweep, invocation);
  sweep->callback([&] { command = [&] { return sweep_missions(asked, invocation); }; });
}

void add_plan(CLI::App& command, std::filesystem::path& plan) {
  add_text(command, "plan", "PLAN.json", "plan document", [&](const std::string& path) {
    plan = path;
  })->required();
}

// A number and nothing else.
double read_number(const std::string& option, const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size())
    throw CLI::ValidationError(option, "expected a number, not '" + text + "'");
  return number;
}

// "5,1" or "5,1,90".
void read_wind(const std::string& text, FlightConditions& conditions) {
  std::vector<double> numbers;
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');)
    numbers.push_back(read_number("--wind", part));
  if (numbers.size() < 2 || numbers.size() > 3)
    throw CLI::ValidationError("--wind", "expected MEAN,GUST or MEAN,GUST,TO, not '" + text + "'");
  conditions.wind_mean = numbers[0];
  conditions.wind_gust = numbers[1];
  if (numbers.size() > 2) conditions.wind_yaw = radians(numbers[2]);
}

void add_plan_commands(CLI::App& app, Invocation& invocation, std::filesystem::path& plan,
                       FlightConditions& conditions, std::string& format,
                       std::filesystem::path& target, Command& command) {
  CLI::App* verify = app.add_subcommand("verify", "judge a plan from its numbers alone");
  add_plan(*verify, plan);
  add_json(*verify, invocation);
  verify->callback([&] { command = [&] { return verify_plan(plan, invocation); }; });

  CLI::App* simulate =
      app.add_subcommand("simulate", "fly a plan by the whole quadrotor under control");
  add_plan(*simulate, plan);
  add_text(*simulate, "--wind", "MEAN,GUST[,TO]",
           "wind and gusts in m/s, and where it blows to in degrees (0: east)",
           [&](const std::string& text) { read_wind(text, conditions); });
  add_text(*simulate, "--mass-error", "PERCENT", "by which the true mass exceeds the plan's",
           [&](const std::string& text) {
             conditions.mass_error = read_number("--mass-error", text) / 100;
           });
  add_count(*simulate, "--seed", 0, kLargestSeed, "of the gusts",
            [&](std::uint64_t seed) { conditions.seed = seed; });
  add_page(*simulate, target);
  add_json(*simulate, invocation);
  simulate->callback(
      [&] { command = [&] { return simulate_plan(plan, conditions, target, invocation); }; });

  CLI::App* exported = app.add_subcommand("export", "write a plan in another format");
  add_plan(*exported, plan);
  add_text(*exported, "--format", "NAME", "an exporter's name", [&](const std::string& name) {
    format = name;
  })->required();
  add_text(*exported, "-o,--output", "PATH", "the file to write", [&](const std::string& path) {
    target = path;
  })->required();
  exported->callback(
      [&] { command = [&] { return export_plan(plan, format, target, invocation); }; });
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
  CLI::App* info = add("info", "what a map holds");
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
  add_count(*view, "--seed", 0, kLargestSeed, "of a Lua scene",
            [&](std::uint64_t seed) { stated.seed = seed; });
  add_text(*view, "--unit", "M", "metres that one unit of a mesh file is, in place of what it says",
           [&](const std::string& text) { stated.unit = read_number("--unit", text); });
  add_text(*view, "--up", "x|y|z", "the axis of a mesh file that points up, in place of its own",
           [&](const std::string& axis) { stated.up = axis; });
  view->callback([&] { command = [&] { return view_scene(file, stated, target, invocation); }; });
}

void add_race_command(CLI::App& app, Invocation& invocation, std::filesystem::path& plan,
                      std::vector<std::string>& pilots, RaceRules& rules,
                      std::filesystem::path& target, Command& command) {
  CLI::App* race = app.add_subcommand("race", "fly a course by hand, from logs of pilots' sticks");
  add_plan(*race, plan);
  add_repeated(*race, "--pilot", "LOG[:KEY=VALUE,...]", pilots,
               "a stick log (CSV: time,forward,left), and of its pilot: name, weight, strength, "
               "reach, speed, handicap; one or more");
  add_text(*race, "--deviation-price", "S", "s per metre of mean distance from the course",
           [&](const std::string& text) {
             rules.deviation_price = read_number("--deviation-price", text);
           });
  add_text(*race, "--gate-price", "S", "s per gate that is missed",
           [&](const std::string& text) { rules.gate_price = read_number("--gate-price", text); });
  add_page(*race, target);
  add_json(*race, invocation);
  race->callback(
      [&] { command = [&] { return race_plan(plan, pilots, rules, target, invocation); }; });
}

// "1,2,5": each entry is read by `take`.
void read_list(const std::string& text, const std::function<void(const std::string&)>& take) {
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');) take(part);
}

std::uint64_t read_seed(const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size() || seed > kLargestSeed)
    throw CLI::ValidationError("--seeds", "expected whole numbers, not '" + text + "'");
  return seed;
}

void add_evaluate_scan(CLI::App& evaluate, Invocation& invocation, ScanEvaluation& asked,
                       Command& command) {
  CLI::App* scan = evaluate.add_subcommand(
      "scan", "scan tours and their rivals, judged by the models that their images would make");
  add_text(*scan, "missions", "MISSION.lua...", "scans to plan by every method",
           [&](const std::string& path) { asked.missions.emplace_back(path); })
      ->required()
      ->expected(1, 1000);
  add_repeated(*scan, "--method", "NAME", asked.methods,
               "a tour solver (milp, milp:nodes=100, cost_benefit+local_search) or a pattern "
               "(circle_50, ellipse_60x40, meander_85x100, hemisphere_60); else all");
  add_text(*scan, "--seeds", "N,N,...", "of the missions; else 1", [&](const std::string& text) {
    asked.seeds.clear();
    read_list(text, [&](const std::string& part) { asked.seeds.push_back(read_seed(part)); });
  });
  add_text(*scan, "--budgets", "S,S,...", "of flight; else each mission's own",
           [&](const std::string& text) {
             read_list(text, [&](const std::string& part) {
               asked.budgets.push_back(read_number("--budgets", part));
             });
           });
  add_text(*scan, "--noise", "SIGMA[,DROPPED]",
           "of the judged depth: m, and the share of pixels without any; else ideal",
           [&](const std::string& text) {
             std::vector<double> numbers;
             read_list(text, [&](const std::string& part) {
               numbers.push_back(read_number("--noise", part));
             });
             if (numbers.empty() || numbers.size() > 2)
               throw CLI::ValidationError("--noise", "expected SIGMA or SIGMA,DROPPED");
             asked.noise = DepthNoise{numbers.size() > 1 ? numbers[1] : 0, numbers[0]};
           });
  add_text(*scan, "--guard", "S", "of wall clock that one solver may take; else 300",
           [&](const std::string& text) { asked.guard = read_number("--guard", text); });
  scan->add_flag("--photos", asked.photos,
                 "render photographs along each tour and ask COLMAP how many fit into one model");
  scan->add_flag("--resume", asked.resume, "go on with a study that was ended");
  add_repeated(*scan, "--config", "FILE", invocation.configs,
               "a configuration file or its name in configs/, of all missions");
  add_repeated(*scan, "--set", "KEY=VALUE", invocation.overrides, "set one option of all missions");
  add_repeated(*scan, "--data", "DIR", invocation.data, "a folder that the scripts may read");
  add_text(*scan, "--out", "DIR", "folder of the results; else out/evaluate_scan",
           [&](const std::string& path) { invocation.out = path; });
  add_count(*scan, "--threads", 1, kMostThreads, "rows at once; else one per core",
            [&](std::uint64_t threads) { invocation.threads = static_cast<int>(threads); });
  scan->add_flag("--quiet", invocation.quiet, "no progress, no tables");
  add_json(*scan, invocation);
  scan->callback([&] { command = [&] { return evaluate_scan(asked, invocation); }; });
}

void add_plugin_commands(CLI::App& app, Invocation& invocation, std::string& name,
                         Description& described, PluginCheck& asked, Command& command) {
  CLI::App* plugins = app.add_subcommand("plugins", "what plugins there are");
  plugins->require_subcommand(1);
  CLI::App* list = plugins->add_subcommand("list", "every plugin, by kind");
  add_json(*list, invocation);
  list->callback([&] { command = [&] { return list_plugins(invocation); }; });
  CLI::App* show = plugins->add_subcommand("show", "a plugin's parameters");
  add_text(*show, "name", "[KIND/]NAME", "its name", [&](const std::string& given) {
    name = given;
  })->required();
  show->add_flag("--markdown", described.markdown, "its parameters as a table of a README");
  add_json(*show, invocation);
  show->callback(
      [&] { command = [&] { return show_plugin(name, described.markdown, invocation); }; });
  CLI::App* path = plugins->add_subcommand("path", "the folders that are searched");
  add_json(*path, invocation);
  path->callback([&] { command = [&] { return show_plugin_path(invocation); }; });
  CLI::App* check = plugins->add_subcommand(
      "check", "what every plugin of its kind must pass, each test in a process of its own");
  add_text(*check, "plugin", "FILE.so|[KIND/]NAME", "a library, or the name of a plugin",
           [&](const std::string& given) { asked.target = given; })
      ->required();
  add_repeated(*check, "--only", "TEST", asked.only, "this test alone; repeatable");
  add_text(*check, "--limit", "S", "s that one test may take; else 60",
           [&](const std::string& text) {
             asked.limit = read_number("--limit", text);
             if (!(asked.limit > 0))
               throw CLI::ValidationError("--limit",
                                          "expected a number above 0, not '" + text + "'");
           });
  add_json(*check, invocation);
  check->callback([&] { command = [&] { return check_plugins(asked, invocation); }; });
}

void add_description_commands(CLI::App& app, Invocation& invocation, Description& asked,
                              Command& command) {
  CLI::App* annotations = app.add_subcommand(
      "annotations", "what scripts may call and set, for editors with a Lua language server");
  CLI::App* schema = app.add_subcommand(
      "schema", "a JSON schema of configurations, for editors that check YAML");
  for (CLI::App* one : {annotations, schema})
    add_text(*one, "-o,--output", "FILE", "the file to write; else standard output",
             [&](const std::string& path) { asked.target = path; });
  annotations->add_flag("--markdown", asked.markdown, "the calls alone, as a table of a README");
  add_text(*schema, "kind", "KIND", "a kind of mission, or vehicle; else all missions",
           [&](const std::string& given) { asked.kind = given; });
  annotations->callback([&] { command = [&] { return write_annotations(asked, invocation); }; });
  schema->callback([&] { command = [&] { return write_schema(asked, invocation); }; });
}

void add_new_commands(CLI::App& app, Invocation& invocation, NewFiles& wanted, Command& command) {
  CLI::App* made = app.add_subcommand("new", "files to begin from");
  made->require_subcommand(1);
  CLI::App* plugin = made->add_subcommand(
      "plugin", "a folder with a plugin that builds, passes its tests and says what it does");
  CLI::App* mission = made->add_subcommand("mission", "a mission script with comments that teach");
  for (CLI::App* one : {plugin, mission}) {
    add_text(*one, "kind", "KIND", one == plugin ? "cost_term, constraint, ..." : "film, race, ...",
             [&](const std::string& given) { wanted.kind = given; })
        ->required();
    add_text(*one, "name", one == plugin ? "NAME" : "FILE",
             one == plugin ? "its name, in snake_case; also the folder's" : "the file to write",
             [&](const std::string& given) { wanted.name = given; })
        ->required();
    add_json(*one, invocation);
  }
  add_text(*plugin, "--in", "DIR", "where the folder is made; else here",
           [&](const std::string& given) { wanted.folder = given; });
  plugin->callback([&] { command = [&] { return new_plugin(wanted, invocation); }; });
  mission->callback([&] { command = [&] { return new_mission(wanted, invocation); }; });
}

void add_train_commands(CLI::App& app, Invocation& invocation, TrainRequest& request,
                        Command& command) {
  CLI::App* train = app.add_subcommand("train", "learned utilities: samples, training, judging");
  train->require_subcommand(1);
  const auto add = [&](const char* name, const char* help, const char* target) {
    CLI::App* made = train->add_subcommand(name, help);
    add_text(*made, "-o,--output", "PATH", target, [&](const std::string& path) {
      request.target = path;
    })->required();
    add_text(*made, "--utility", "NAME", "the utility that is trained; else learned",
             [&](const std::string& given) { request.utility = given; });
    add_repeated(*made, "--set", "KEY=VALUE", invocation.overrides,
                 "set one parameter of the network or its training");
    add_count(*made, "--threads", 1, kMostThreads, "threads to use; else one per core",
              [&](std::uint64_t threads) { invocation.threads = static_cast<int>(threads); });
    add_count(*made, "--seed", 0, kLargestSeed, "of all random numbers",
              [&](std::uint64_t seed) { invocation.seed = seed; });
    made->add_flag("--quiet", invocation.quiet, "no lines of progress");
    return made;
  };
  const auto add_samples = [&](CLI::App& made) {
    add_text(made, "samples", "DIR", "a folder of samples", [&](const std::string& path) {
      request.samples = path;
    })->required();
    add_json(made, invocation);
  };
  CLI::App* dataset = add("dataset", "samples from episodes of the oracle", "a folder");
  add_repeated(*dataset, "--world", "NAME[:FIRST-LAST]", request.worlds,
               "a scene of scripts/scene with its seeds, or a mesh file; repeatable");
  add_text(*dataset, "--explorer", "NAME", "the utility that explores; else the oracle",
           [&](const std::string& given) { request.explorer = given; });
  add_repeated(*dataset, "--explorer-set", "KEY=VALUE", request.explorer_overrides,
               "set one parameter of the utility that explores, as model=FILE");
  add_repeated(*dataset, "--moves", "KEY=VALUE", request.moves, kMovesHelp);
  add_count(*dataset, "--episodes", 1, 100'000, "of each world",
            [&](std::uint64_t count) { request.episodes = static_cast<std::int64_t>(count); });
  add_count(*dataset, "--steps", 1, 100'000, "of each episode",
            [&](std::uint64_t count) { request.steps = static_cast<int>(count); });
  CLI::App* fit = add("fit", "train a model", "the model's file");
  add_samples(*fit);
  add_text(*fit, "--validation", "DIR", "samples of other worlds or episodes",
           [&](const std::string& path) { request.validation = path; })
      ->required();
  for (CLI::App* made : {dataset, fit})
    made->add_flag("--resume", request.resume, "go on with what is there");
  CLI::App* score = add("score", "rank correlation and loss of a model", "the model's file");
  add_samples(*score);
  dataset->callback([&] { command = [&] { return make_dataset(request, invocation); }; });
  fit->callback([&] { command = [&] { return fit_model(request, invocation); }; });
  score->callback([&] { command = [&] { return score_model(request, invocation); }; });
}

void add_evaluate_explore(CLI::App& evaluate, Invocation& invocation, ExploreEvaluation& request,
                          Command& command) {
  CLI::App* made =
      evaluate.add_subcommand("explore", "utilities against the oracle, tables 5.1 on");
  add_repeated(*made, "--world", "NAME[:FIRST-LAST]", request.worlds,
               "a scene of scripts/scene with its seeds, or a mesh file; repeatable");
  add_repeated(*made, "--utility", "NAME", request.utilities, "repeatable; else every one");
  add_repeated(*made, "--moves", "KEY=VALUE", request.moves, kMovesHelp);
  add_count(*made, "--episodes", 1, 10'000, "of each world",
            [&](std::uint64_t count) { request.episodes = static_cast<std::int64_t>(count); });
  add_count(*made, "--steps", 1, 100'000, "of each episode",
            [&](std::uint64_t count) { request.steps = static_cast<int>(count); });
  add_count(*made, "--lookahead", 1, 4, "views of the ways that are valued; else 1",
            [&](std::uint64_t count) { request.lookahead = static_cast<int>(count); });
  add_text(*made, "--sigma", "M", "noise of the depth; the views are replayed without",
           [&](const std::string& text) { request.sigma = read_number("--sigma", text); });
  add_text(*made, "--dropped", "SHARE", "of the pixels without a measurement",
           [&](const std::string& text) { request.dropped = read_number("--dropped", text); });
  add_text(*made, "--stereo", "M", "depth by a pair of cameras so far apart, likewise",
           [&](const std::string& text) { request.stereo = read_number("--stereo", text); });
  add_repeated(*made, "--set", "UTILITY.KEY=VALUE", invocation.overrides,
               "set one parameter of a utility");
  add_text(*made, "-o,--output", "DIR", "folder of the results; else out/evaluate_explore",
           [&](const std::string& path) { request.folder = path; });
  add_count(*made, "--threads", 1, kMostThreads, "threads to use; else one per core",
            [&](std::uint64_t threads) { invocation.threads = static_cast<int>(threads); });
  add_count(*made, "--seed", 0, kLargestSeed, "of the starts",
            [&](std::uint64_t seed) { invocation.seed = seed; });
  made->add_flag("--resume", request.resume, "keep the episodes that are there");
  made->add_flag("--quiet", invocation.quiet, "no lines of progress");
  made->callback([&] { command = [&] { return evaluate_explore(request, invocation); }; });
}

// What to say of a first word that is no command; empty where there is none.
std::string unknown_command(const CLI::App& app) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().front();
  const std::vector<std::string> rest = app.remaining(true);
  if (rest.empty() || rest.front().starts_with("-")) return "";
  std::vector<std::string> known;
  for (const CLI::App* command : at->get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(command->get_name());
  }
  if (known.empty()) return "";
  const std::string nearest = nearest_name(rest.front(), known);
  return "unknown command '" + rest.front() + "'" +
         (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
}

ExitStatus report_error(const Invocation& invocation, ExitStatus status,
                        const std::string& message) {
  std::cerr << "lapwing: " << message << "\n";
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "failed");
    object.set("error", message);
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

int run_command_line(int argc, const char* const* argv) {
  CLI::App app("Planning for camera-carrying micro aerial vehicles.", "lapwing");
  app.set_version_flag("--version", "lapwing " LAPWING_VERSION);
  app.require_subcommand(1);
  Invocation invocation;
  std::filesystem::path script, plan, target;
  std::string format, name;
  FlightConditions conditions;
  SceneStatement stated;
  std::vector<std::string> pilots;
  RaceRules rules;
  TrainRequest training;
  PluginCheck checking;
  Description described;
  NewFiles wanted;
  Sweep sweep;
  ScanEvaluation asked;
  ExploreEvaluation exploring;
  Command command;
  add_repeated(app, "--plugin-path", "DIR", invocation.plugin_path,
               "a folder of plugins, searched first");
  app.fallthrough();
  add_run(app, invocation, script, command);
  add_sweep(app, invocation, sweep, command);
  add_plan_commands(app, invocation, plan, conditions, format, target, command);
  add_map_commands(app, invocation, plan, target, command);
  add_scene_commands(app, invocation, plan, stated, target, command);
  add_race_command(app, invocation, plan, pilots, rules, target, command);
  add_plugin_commands(app, invocation, name, described, checking, command);
  add_description_commands(app, invocation, described, command);
  add_new_commands(app, invocation, wanted, command);
  add_train_commands(app, invocation, training, command);
  CLI::App* evaluate = app.add_subcommand("evaluate", "studies: methods against each other");
  evaluate->require_subcommand(1);
  add_evaluate_scan(*evaluate, invocation, asked, command);
  add_evaluate_explore(*evaluate, invocation, exploring, command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    if (const std::string message = unknown_command(app); !message.empty()) {
      std::cerr << "lapwing: " << message << "\nRun with --help for more information.\n";
    } else {
      app.exit(error, std::cerr, std::cerr);
    }
    return static_cast<int>(ExitStatus::bad_input);
  }
  return static_cast<int>(guarded_command(command, invocation));
}

}  // namespace lapwing
