// SPDX-License-Identifier: Apache-2.0
// The command line of studies and of training.
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <numbers>

#include "framework/app/command_options.h"
#include "framework/app/evaluate_explore.h"
#include "framework/app/reproduce_command.h"
#include "framework/app/tour_command.h"
#include "framework/app/train_command.h"

namespace lapwing {

namespace {

constexpr const char* kWorldHelp =
    "a scene of scripts/scene with its seeds; a mesh file, which gets a ground plane; or "
    "FILE@X,Y,Z, the space inside a mesh around that point; repeatable, at least one; no default";
constexpr const char* kMovesHelp =
    "step, turn_deg, body or clear, as in `moves` of a mission; repeatable; default: those of the "
    "mission";
constexpr const char* kMappingHelp =
    "width, height, view_deg, pitch_deg or range of the camera, resolution, hit or miss of the "
    "map, as in a mission; a model fits one set of them; repeatable; default: those of the mission";

std::uint64_t read_seed(const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size() || seed > kLargestSeed)
    throw CLI::ValidationError("--seeds", "expected whole numbers, not '" + text + "'");
  return seed;
}

double above_zero(const char* option, const std::string& text, double most) {
  const double number = read_within(option, text, most);
  if (!(number > 0))
    throw CLI::ValidationError(option, "expected a number above 0, not '" + text + "'");
  return number;
}

}  // namespace

void add_evaluate_scan(CLI::App& evaluate, Invocation& invocation, ScanEvaluation& asked,
                       Command& command) {
  CLI::App* scan =
      evaluate.add_subcommand("scan", "compare scan tours by the surface models from their images");
  add_text(*scan, "missions", "MISSION.lua...", "scans to plan by every method",
           [&](const std::string& path) { asked.missions.emplace_back(path); })
      ->required()
      ->expected(-1)
      ->take_all();
  add_repeated(*scan, "--method", "NAME", asked.methods,
               "a tour solver (milp, milp:nodes=100, greedy+local_search) or a pattern "
               "(circle_50, ellipse_60x40, meander_85x100, hemisphere_60); default: all");
  add_text(*scan, "--seeds", "N,N,...", "seeds of the missions; default: 1",
           [&](const std::string& text) {
             asked.seeds.clear();
             read_list(text,
                       [&](const std::string& part) { asked.seeds.push_back(read_seed(part)); });
           });
  add_text(*scan, "--budgets", "S,S,...", "flight times in s; default: that of each mission",
           [&](const std::string& text) {
             read_list(text, [&](const std::string& part) {
               asked.budgets.push_back(read_number("--budgets", part));
             });
           });
  add_text(*scan, "--noise", "SIGMA[,DROPPED]",
           "noise of the evaluated depth in m, and fraction of dropped pixels; default: ideal",
           [&](const std::string& text) {
             std::vector<double> numbers;
             read_list(text, [&](const std::string& part) {
               numbers.push_back(read_number("--noise", part));
             });
             if (numbers.empty() || numbers.size() > 2)
               throw CLI::ValidationError("--noise", "expected SIGMA or SIGMA,DROPPED");
             asked.noise = DepthNoise{numbers.size() > 1 ? numbers[1] : 0, numbers[0]};
           });
  add_text(*scan, "--range", "M",
           "largest distance of evaluated depth in m; default: `usable.range` of each mission",
           [&](const std::string& text) { asked.range = above_zero("--range", text, 1000); });
  add_text(*scan, "--angle", "DEG",
           "largest angle of incidence of evaluated depth; default: `usable.incidence_deg` of each "
           "mission",
           [&](const std::string& text) {
             asked.incidence = above_zero("--angle", text, 90) * std::numbers::pi / 180;
           });
  add_text(*scan, "--guard", "S", "wall-clock limit of a solver in s; default: 300",
           [&](const std::string& text) { asked.guard = read_number("--guard", text); });
  scan->add_flag("--photos", asked.photos,
                 "render photographs along each tour and register them with COLMAP");
  add_items(*scan, asked.items, "continue an interrupted study");
  add_repeated(
      *scan, "--config", "FILE", invocation.configs,
      "a configuration file or its name in configs/, of all missions; repeatable; default: none");
  add_repeated(*scan, "--set", "KEY=VALUE", invocation.overrides,
               "set one option of all missions; repeatable; default: none");
  add_repeated(*scan, "--data", "DIR", invocation.data,
               "a folder that the scripts may read; repeatable; default: those of LAPWING_DATA");
  add_text(*scan, "-o,--out", "DIR", "folder of the results; default: out/evaluate_scan",
           [&](const std::string& path) { invocation.out = path; });
  add_threads(*scan, invocation, "rows at once; default: one per core");
  scan->add_flag("--quiet", invocation.quiet, "no progress, no tables");
  add_json(*scan, invocation);
  scan->callback([&] { command = [&] { return evaluate_scan(asked, invocation); }; });
}

void add_reproduce_command(CLI::App& app, Invocation& invocation, ReproduceRequest& asked,
                           Command& command) {
  CLI::App* made = app.add_subcommand(
      "reproduce", "make a table or a figure of the thesis again, its own figures beside ours");
  add_text(*made, "table", "TABLE", "`list`, or a name that it prints: 4.3",
           [&](const std::string& name) { asked.table = name; })
      ->required();
  made->add_flag("--quick", asked.quick, "less of it, within five minutes; the caption says what");
  made->add_flag("--resume", asked.resume, "continue an interrupted reproduction");
  add_repeated(*made, "--data", "DIR", invocation.data,
               "a folder with `meshes/` in it; repeatable; default: those of LAPWING_DATA");
  add_text(*made, "-o,--out", "DIR", "folder of all reproductions; default: out/reproduce",
           [&](const std::string& path) { invocation.out = path; });
  add_threads(*made, invocation, "threads to use; default: one per core");
  made->add_flag("--quiet", invocation.quiet, "no progress, no table");
  add_json(*made, invocation);
  made->callback([&] { command = [&] { return reproduce_table(asked, invocation); }; });
}

void add_tour_command(CLI::App& app, Invocation& invocation, TourRun& asked, Command& command) {
  CLI::App* tour = app.add_subcommand(
      "tour", "solve instances of the orienteering problem, from files, by tour solvers");
  add_text(*tour, "files", "FILE...",
           "instances: TSPLIB-style (.oplib), or `budget 1` and lines `x y score`",
           [&](const std::string& path) { asked.files.emplace_back(path); })
      ->required()
      ->expected(-1)
      ->take_all();
  add_repeated(*tour, "--solver", "NAME", asked.solvers,
               "a tour solver; repeatable; default: local_search");
  add_repeated(*tour, "--set", "KEY=VALUE", invocation.overrides,
               "set one parameter of every solver; repeatable; default: none");
  add_text(*tour, "--team", "N",
           "number of tours that share the score, each with the N-th part of the limit; default: 1",
           [&](const std::string& text) {
             const double number = read_number("--team", text);
             if (!(number >= 1 && number <= 1000) || number != std::floor(number))
               throw CLI::ValidationError(
                   "--team", "expected a whole number from 1 to 1000, not '" + text + "'");
             asked.team = static_cast<int>(number);
           });
  add_text(*tour, "--guard", "S", "wall-clock limit of one tour in s; default: none",
           [&](const std::string& text) {
             asked.guard = read_number("--guard", text);
             if (!(*asked.guard > 0))
               throw CLI::ValidationError("--guard",
                                          "expected seconds above 0, not '" + text + "'");
           });
  add_seed(*tour, invocation.seed, "seed of all random numbers; default: 1");
  add_json(*tour, invocation);
  tour->callback([&] { command = [&] { return solve_tours(asked, invocation); }; });
}

void add_train_commands(CLI::App& app, Invocation& invocation, TrainRequest& request,
                        Command& command) {
  CLI::App* train = app.add_subcommand("train", "learned utilities: samples, training, evaluation");
  train->require_subcommand(1);
  const auto add = [&](const char* name, const char* help) {
    CLI::App* made = train->add_subcommand(name, help);
    add_text(*made, "--utility", "NAME", "the utility that is trained; default: learned",
             [&](const std::string& given) { request.utility = given; });
    add_threads(*made, invocation, "threads to use; default: one per core");
    return made;
  };
  const auto add_making = [&](CLI::App& made, const char* target) {
    add_text(made, "-o,--output", "PATH", target, [&](const std::string& path) {
      request.target = path;
    })->required();
    add_repeated(made, "--set", "KEY=VALUE", invocation.overrides,
                 "set one parameter of the network or its training; repeatable; default: none");
    add_seed(made, invocation.seed, "seed of all random numbers; default: 1");
    made.add_flag("--quiet", invocation.quiet, "no lines of progress");
  };
  const auto add_samples = [&](CLI::App& made) {
    add_text(made, "samples", "DIR|FILE...", "files of samples, and folders of them",
             [&](const std::string& path) { request.samples.emplace_back(path); })
        ->required()
        ->expected(-1)
        ->take_all();
    add_json(made, invocation);
  };
  CLI::App* dataset = add("dataset", "samples from episodes of the oracle");
  add_making(*dataset, "a folder");
  add_items(*dataset, request.items, "continue an interrupted run");
  add_repeated(*dataset, "--world", "NAME[:FIRST-LAST]", request.worlds, kWorldHelp);
  add_text(*dataset, "--explorer", "NAME", "the utility that explores; default: the oracle",
           [&](const std::string& given) { request.explorer = given; });
  add_repeated(
      *dataset, "--explorer-set", "KEY=VALUE", request.explorer_overrides,
      "set one parameter of the utility that explores, as model=FILE; repeatable; default: none");
  add_text(*dataset, "--up", "x|y|z",
           "the axis of mesh files that points up; default: what the files say",
           [&](const std::string& axis) { request.up = axis; });
  add_repeated(*dataset, "--moves", "KEY=VALUE", request.moves, kMovesHelp);
  add_repeated(*dataset, "--mapping", "KEY=VALUE", request.mapping, kMappingHelp);
  add_count(*dataset, "--episodes", 1, 100'000, "episodes per world; default: 4",
            [&](std::uint64_t count) { request.episodes = static_cast<std::int64_t>(count); });
  add_count(*dataset, "--steps", 1, 100'000, "images per episode; default: 200",
            [&](std::uint64_t count) { request.steps = static_cast<int>(count); });
  add_text(*dataset, "--sigma", "M",
           "depth noise in m; the oracle's values are without it; default: 0",
           [&](const std::string& text) { request.sigma = read_within("--sigma", text, 100); });
  add_text(*dataset, "--dropped", "SHARE", "fraction of pixels without a measurement; default: 0",
           [&](const std::string& text) { request.dropped = read_within("--dropped", text, 1); });
  CLI::App* all = add("all", "train a model from nothing by a recipe: samples and fits in rounds");
  add_text(*all, "-o,--output", "PATH", "the model's file", [&](const std::string& path) {
    request.target = path;
  })->required();
  add_text(
      *all, "--hours", "H",
      "about how long to train: takes the fraction H / `hours` of the recipe's seeds; default: "
      "`default_hours` of the recipe: 1 for the shipped model (80 minutes on two shared cores, "
      "1.6 GB of memory). Memory grows with H",
      [&](const std::string& text) { request.hours = read_number("--hours", text); });
  add_text(*all, "--recipe", "FILE", "another recipe; default: that of the utility",
           [&](const std::string& path) { request.recipe = path; });
  add_repeated(*all, "--mapping", "KEY=VALUE", request.mapping, kMappingHelp);
  add_seed(*all, invocation.seed, "seed of all random numbers; default: 1");
  all->add_flag("--resume", request.resume, "continue an interrupted run");
  add_json(*all, invocation);
  all->add_flag("--quiet", invocation.quiet, "no lines of progress");
  CLI::App* fit = add("fit", "train a model");
  add_making(*fit, "the model's file");
  fit->add_flag("--resume", request.resume, "continue an interrupted run");
  add_samples(*fit);
  add_repeated(*fit, "--validation", "DIR|FILE", request.validation,
               "samples of other worlds or episodes; repeatable, at least one; no default");
  CLI::App* score = add("score", "rank correlation and loss of a model");
  add_text(*score, "--model", "FILE", "the model to evaluate", [&](const std::string& path) {
    request.model = path;
  })->required();
  add_samples(*score);
  all->callback([&] { command = [&] { return train_all(request, invocation); }; });
  dataset->callback([&] { command = [&] { return make_dataset(request, invocation); }; });
  fit->callback([&] { command = [&] { return fit_model(request, invocation); }; });
  score->callback([&] { command = [&] { return score_model(request, invocation); }; });
}

void add_evaluate_explore(CLI::App& evaluate, Invocation& invocation, ExploreEvaluation& request,
                          Command& command) {
  CLI::App* made =
      evaluate.add_subcommand("explore", "compare utilities with the oracle (thesis, table 5.2)");
  add_repeated(*made, "--world", "NAME[:FIRST-LAST]", request.worlds, kWorldHelp);
  add_repeated(*made, "--utility", "NAME", request.utilities,
               "a utility to compare; repeatable; default: all");
  add_text(*made, "--up", "x|y|z",
           "the axis of mesh files that points up; default: what the files say",
           [&](const std::string& axis) { request.up = axis; });
  add_repeated(*made, "--moves", "KEY=VALUE", request.moves, kMovesHelp);
  add_repeated(*made, "--mapping", "KEY=VALUE", request.mapping, kMappingHelp);
  add_count(*made, "--episodes", 1, 10'000, "episodes per world; default: 10",
            [&](std::uint64_t count) { request.episodes = static_cast<std::int64_t>(count); });
  add_count(*made, "--steps", 1, 100'000, "images per episode; default: 200",
            [&](std::uint64_t count) { request.steps = static_cast<int>(count); });
  add_count(*made, "--lookahead", 1, 4, "length of the evaluated view sequences; default: 1",
            [&](std::uint64_t count) { request.lookahead = static_cast<int>(count); });
  add_text(*made, "--sigma", "M", "depth noise in m; views are evaluated without it; default: 0",
           [&](const std::string& text) { request.sigma = read_within("--sigma", text, 100); });
  add_text(*made, "--dropped", "SHARE", "fraction of pixels without a measurement; default: 0",
           [&](const std::string& text) { request.dropped = read_within("--dropped", text, 1); });
  add_text(
      *made, "--smooth-to", "M",
      "standard deviation in m to which the noise of --sigma is smoothed before depth is "
      "mapped; default: 0, it is not smoothed",
      [&](const std::string& text) { request.smooth_to = read_within("--smooth-to", text, 100); });
  add_text(*made, "--stereo", "M",
           "depth from a stereo pair with this baseline in m; default: a depth camera",
           [&](const std::string& text) { request.stereo = read_within("--stereo", text, 100); });
  add_repeated(*made, "--set", "UTILITY.KEY=VALUE", invocation.overrides,
               "set one parameter of a utility; repeatable; default: none");
  add_text(*made, "--against", "DIR",
           "folder of another evaluation: efficiency relative to it from the same starts (table "
           "5.4); default: none",
           [&](const std::string& path) { request.against = path; });
  add_text(*made, "-o,--out,--output", "DIR",
           "folder of the results; default: out/evaluate_explore",
           [&](const std::string& path) { request.folder = path; });
  add_threads(*made, invocation, "threads to use; default: one per core");
  add_seed(*made, invocation.seed, "seed of the starts; default: 1");
  add_items(*made, request.items, "keep existing episodes");
  add_json(*made, invocation);
  made->add_flag("--quiet", invocation.quiet, "no progress, no tables");
  made->callback([&] { command = [&] { return evaluate_explore(request, invocation); }; });
}

}  // namespace lapwing
