// SPDX-License-Identifier: Apache-2.0
#include "framework/app/evaluate_explore.h"

#include <algorithm>
#include <iostream>

#include "framework/app/exploration_settings.h"
#include "framework/app/interruption.h"
#include "framework/config/overrides.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/parallel.h"
#include "framework/core/visible_text.h"
#include "framework/mission/explore_library.h"
#include "framework/study/exploration_figures.h"
#include "framework/study/study_settings.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// False where it was cancelled: nothing is written then.
bool run_trial(const Trial& trial, const World& world, const GroundTruth& truth,
               const ExplorationSetup& setup, const Registry& registry, const Value& parameters,
               std::uint64_t seed, const fs::path& folder) {
  Random random = Random(seed).split(static_cast<std::uint64_t>(trial.episode));
  EpisodeSettings settings = setup.episode;
  settings.show_truth = needs_truth(registry, trial.utility);
  settings.seed = seed + static_cast<std::uint64_t>(trial.episode) * 1'000'003;
  const auto new_map = setup.new_map(registry);
  const Value* given = parameters.find(trial.utility);
  const auto utility =
      registry.create<ViewUtility>(trial.utility, given ? *given : Value::map(), trial.utility);
  ObservedSurface observed(truth, settings.sensor, new_map);
  const auto map = new_map();
  EpisodeResult result;
  try {
    const Viewpoint start =
        random_start(truth, settings.clear, settings.sensor.range / 2, setup.pitch, random);
    result = explore(settings, start, truth, observed, *utility, *map);
  } catch (const StartError& error) {
    throw setup.with_options(error, world.name);
  }
  if (result.end == EpisodeEnd::cancelled) return false;
  std::vector<double> curve;
  double seconds = 0;
  for (const EpisodeStep& step : result.steps) {
    curve.push_back(step.observed);
    seconds += step.seconds;
  }
  if (settings.sensor.noise || settings.sensor.stereo) {
    ObservedSurface anew(truth, settings.sensor, new_map);
    const auto clean = new_map();
    curve = replay(settings, result, truth, anew, *clean);
  }
  Value object = Value::map();
  object.set("world", world.name);
  object.set("utility", trial.utility);
  object.set("episode", trial.episode);
  object.set("end", to_string(result.end));
  object.set("surface", result.surface);
  object.set("length", result.length());
  object.set("observed", Value(Value::List(curve.begin(), curve.end())));
  Value time = Value::map();
  time.set("world", world.name);
  time.set("utility", trial.utility);
  time.set("seconds_per_step",
           seconds / static_cast<double>(std::max<std::size_t>(1, curve.size())));
  write_file_atomically(folder / "seconds" / (trial.name() + ".json"), to_json(time) + "\n");
  write_file_atomically(folder / "episodes" / (trial.name() + ".json"), to_json(object) + "\n");
  return true;
}

bool of_an_evaluation(const Value& there) {
  return there.is_map() && there.find("steps") && there.find("lookahead");
}

// Whether the folder may be used, and what its settings.json will say. Nothing is taken away from a
// folder that is not an evaluation's.
Value settings_for(const ExploreEvaluation& request, Value stated) {
  const fs::path settings = request.folder / "settings.json";
  const fs::path episodes = request.folder / "episodes";
  if (fs::exists(episodes) && !fs::is_empty(episodes)) {
    if (!fs::exists(settings))
      throw InputError("'" + episodes.string() + "' exists, but no settings.json that states " +
                       "its content: choose another folder with -o");
    const Value there = from_json(read_file(settings), settings.string());
    if (!of_an_evaluation(there))
      throw InputError("'" + settings.string() +
                       "' is not of an evaluation of explorations: choose another folder with -o");
    if (!request.resume)
      throw InputError("'" + request.folder.string() +
                       "' contains an evaluation: continue it with " +
                       "--resume, or choose another folder with -o");
    if (const std::string difference = settings_difference(there, stated); !difference.empty()) {
      throw InputError("'" + settings.string() +
                       "': the evaluation there has other settings: " + difference);
    } else if (const Value* files = there.find("files")) {
      for (const auto& [name, sum] : files->as_map())
        if (!stated.at("files").find(name)) stated.find("files")->set(name, sum);
      if (const Value* own = there.find("world_moves"))
        for (const auto& [world, moves] : own->as_map()) {
          if (!stated.find("world_moves")) stated.set("world_moves", Value::map());
          if (!stated.at("world_moves").find(world)) stated.find("world_moves")->set(world, moves);
        }
    }
  } else if (!fs::exists(settings) ||
             !of_an_evaluation(from_json(read_file(settings), settings.string()))) {
    for (const char* name :
         {"settings.json", "table.csv", "curves.csv", "seconds.csv", "report.html"})
      if (fs::exists(request.folder / name))
        throw InputError("'" + (request.folder / name).string() + "' is not of an evaluation of " +
                         "explorations: choose another folder with -o");
  }
  require_writable(settings);
  return stated;
}

// What is compared start by start was flown from the same starts, in the same worlds, by the same
// moves; it may differ in noise, parameters, lookahead. InputError for what is not, or is not
// there.
void require_same_starts(const ExploreEvaluation& request, const Value& stated,
                         const std::vector<WorldName>& worlds,
                         const std::vector<std::string>& utilities) {
  const fs::path settings = request.against / "settings.json";
  const std::string option = "--against '" + request.against.string() + "'";
  if (!fs::exists(settings))
    throw InputError(option + ": no evaluation is there (no settings.json)");
  if (fs::exists(request.folder) && fs::equivalent(request.folder, request.against))
    throw InputError(option + ": is the folder of this evaluation");
  const Value there = from_json(read_file(settings), settings.string());
  const auto part = [&](const Value& of) {
    Value kept = Value::map();
    for (const char* key : {"program", "steps", "seed", "moves", "mapping", "up"})
      if (const Value* value = of.find(key)) kept.set(key, *value);
    if (const Value* moves = of.find("world_moves")) kept.set("world_moves", *moves);
    Value& files = kept.set("files", Value::map());
    if (const Value* sums = of.find("files"))
      for (const WorldName& world : worlds)
        if (const Value* sum = sums->find(world.text())) files.set(world.text(), *sum);
    return kept;
  };
  if (const std::string difference = settings_difference(part(there), part(stated));
      !difference.empty())
    throw InputError(option + ": its starts differ: " + difference);
  for (const WorldName& world : worlds)
    for (const std::string& utility : utilities)
      for (std::int64_t episode = 1; episode <= request.episodes; ++episode) {
        const Trial trial{world.text(), utility, episode};
        if (!fs::exists(request.against / "episodes" / (trial.name() + ".json")))
          throw InputError(option + ": " + utility + "'s episode " + std::to_string(episode) +
                           " in " + world.text() + " is not there");
      }
}

}  // namespace

ExitStatus evaluate_explore(const ExploreEvaluation& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Interruption interruption;
  std::vector<std::string> utilities = request.utilities;
  if (utilities.empty())
    for (const PluginEntry& entry : registry.entries())
      if (entry.kind == ViewUtility::kKind) utilities.push_back(entry.name);
  for (std::size_t k = 0; k < utilities.size(); ++k) {
    registry.find("utility", utilities[k]);
    if (std::find(utilities.begin(), utilities.begin() + static_cast<std::ptrdiff_t>(k),
                  utilities[k]) != utilities.begin() + static_cast<std::ptrdiff_t>(k))
      throw InputError("--utility " + utilities[k] + ": is named twice");
  }
  const std::vector<WorldName> names = distinct_worlds(request.worlds, "evaluate explore");
  for (const WorldName& name : names) require_world(name, request.up);
  ExplorationSetup setup;
  setup.episode.steps = request.steps;
  setup.episode.lookahead = request.lookahead;
  const Value mapping = setup.set_mapping(request.mapping);
  const Value moves = setup.set_moves(request.moves);
  setup.episode.cancellation = &interruption.token();
  if (request.sigma > 0 || request.dropped > 0)
    setup.episode.sensor.noise = DepthNoise{request.dropped, request.sigma};
  if (request.stereo > 0) {
    setup.episode.sensor.stereo.emplace();
    setup.episode.sensor.stereo->baseline = request.stereo;
  }
  Value parameters = Value::map();
  for (const std::string& text : invocation.overrides) apply_override(parameters, text);
  for (const auto& [name, given] : parameters.as_map()) {
    if (std::find(utilities.begin(), utilities.end(), name) == utilities.end())
      throw InputError("--set " + name + ": this utility is not among those evaluated");
    registry.create<ViewUtility>(name, given, name);
  }
  // What another run of other settings left would be taken for this one's.
  Value stated = Value::map();
  stated.set("program", std::string("lapwing ") + program_version());
  stated.set("steps", request.steps);
  stated.set("seed", static_cast<std::int64_t>(invocation.seed));
  stated.set("sigma", request.sigma);
  stated.set("dropped", request.dropped);
  stated.set("stereo", request.stereo);
  stated.set("lookahead", request.lookahead);
  stated.set("parameters", parameters);
  stated.set("moves", moves);
  stated.set("mapping", mapping);
  stated.set("up", request.up);
  const WorldRecords records =
      records_of(names, utilities, parameters, setup, registry, invocation);
  if (!records.moves.as_map().empty()) stated.set("world_moves", records.moves);
  stated.set("files", records.files);
  if (!request.against.empty()) require_same_starts(request, stated, names, utilities);
  const Value settings = settings_for(request, std::move(stated));

  const FolderClaim claim(request.folder);
  std::vector<std::pair<const WorldName*, Trial>> trials;
  WorldsInUse in_use(setup, request.up, registry, invocation);
  for (const WorldName& name : names)
    for (std::int64_t episode = 1; episode <= request.episodes; ++episode)
      for (const std::string& utility : utilities) {
        const Trial trial{name.text(), utility, episode};
        if (fs::exists(request.folder / "episodes" / (trial.name() + ".json"))) continue;
        trials.emplace_back(&name, trial);
        in_use.expect(name);
      }
  const auto write_settings = [&] {
    write_file_atomically(request.folder / "settings.json", to_json(settings) + "\n");
  };
  std::once_flag stated_once;
  parallel_for(trials.size(), invocation.threads, [&](std::size_t k) {
    if (interruption.token().cancelled()) return;
    const auto& [name, trial] = trials[k];
    const auto used = in_use.begin(*name);
    std::call_once(stated_once, write_settings);  // not for a world that cannot be loaded
    if (!run_trial(trial, used->world, used->truth, setup_of(setup, records, name->text()),
                   registry, parameters, invocation.seed, request.folder))
      return;
    const auto [ended, expected] = in_use.end(*name);
    if (!invocation.quiet)
      std::cerr << visible_line(trial.world) + ": " + std::to_string(ended) + " of " +
                       std::to_string(expected) + " episodes\n";
  });
  if (interruption.token().cancelled()) throw Cancelled();
  std::call_once(stated_once, write_settings);  // nothing was missing, but worlds may have joined
  std::vector<std::string> worlds;
  for (const WorldName& name : names) worlds.push_back(name.text());
  const ExplorationTables tables =
      write_exploration_figures({request.folder, request.against, settings, worlds, utilities,
                                 request.episodes, request.steps});
  const std::string report = (request.folder / "report.html").string();
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "ok");
    object.set("report", report);
    object.set("moves", moves);
    if (!records.moves.as_map().empty()) object.set("world_moves", records.moves);
    object.set("rows", tables.rows);
    print_json(object);
  } else if (!invocation.quiet) {
    std::cout << visible_text(tables.text);
    for (const auto& [world, own] : records.moves.as_map())
      std::cout << "\n"
                << visible_line(world) << " was explored with the moves that its scene recommends: "
                << visible_line(settings_text(own)) << " (--moves KEY=VALUE sets others)";
    std::cout << "\nreport: " << visible_line(report) << std::endl;
  }
  return ExitStatus::done;
}

}  // namespace lapwing
