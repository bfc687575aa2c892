// SPDX-License-Identifier: Apache-2.0
#include "framework/app/evaluate_explore.h"

#include <algorithm>
#include <iostream>

#include "framework/app/exploration_settings.h"
#include "framework/config/overrides.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/portable.h"
#include "framework/core/visible_text.h"
#include "framework/geometry/depth_smoothing.h"
#include "framework/items/statement.h"
#include "framework/mission/explore_library.h"
#include "framework/study/exploration_figures.h"
#include "framework/study/study_settings.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// Throws Cancelled where it was cancelled: nothing is written then.
void run_trial(const Trial& trial, const World& world, const GroundTruth& truth,
               const ExplorationSetup& setup, const Registry& registry, const Value& parameters,
               std::uint64_t seed, const Value& mark, const fs::path& folder) {
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
  if (result.end == EpisodeEnd::cancelled) throw Cancelled();
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
  object.set(kMadeByEntry, mark);
  Value time = Value::map();
  time.set("world", world.name);
  time.set("utility", trial.utility);
  time.set("seconds_per_step",
           seconds / static_cast<double>(std::max<std::size_t>(1, curve.size())));
  write_file_atomically(folder / "seconds" / (trial.name() + ".json"), to_json(time) + "\n");
  write_file_atomically(folder / "episodes" / (trial.name() + ".json"), to_json(object) + "\n");
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
    if (!request.items.continues())
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
  } else if (request.items.gather || request.items.schedule) {
    throw InputError(request.items.name() + ": there is no evaluation in '" +
                     request.folder.string() + "'");
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

// What an evaluation is made of, the same in every process.
struct Evaluation {
  std::vector<std::string> utilities;
  std::vector<WorldName> worlds;
  ExplorationSetup setup;
  Value parameters = Value::map();  // of utilities
  Value moves, mapping;
  WorldRecords records;
  Value stated = Value::map();  // the settings
  Value mark;                   // of episodes
};

// All that are shipped, or those that are asked for. InputError for an unknown one, or one twice.
std::vector<std::string> utilities_of(const ExploreEvaluation& request, const Registry& registry) {
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
  return utilities;
}

void set_depth(const ExploreEvaluation& request, ExplorationSetup& setup) {
  if (request.sigma > 0 || request.dropped > 0)
    setup.episode.sensor.noise = DepthNoise{request.dropped, request.sigma};
  setup.episode.sensor.smooth_to = request.smooth_to;
  if (request.smooth_to > 0)
    if (const std::string why = why_not_smoothed(request.sigma, request.smooth_to, request.dropped);
        !why.empty())
      throw InputError("--smooth-to: " + why);
  if (request.stereo > 0) {
    setup.episode.sensor.stereo.emplace();
    setup.episode.sensor.stereo->baseline = request.stereo;
  }
}

// What another run of other settings left would be taken for this one's.
Value settings_stated(const ExploreEvaluation& request, const Evaluation& of,
                      const Invocation& invocation) {
  Value stated = Value::map();
  stated.set("program", std::string("lapwing ") + program_version());
  stated.set(kMachineEntry, machine_of_numbers());
  stated.set("steps", request.steps);
  stated.set("seed", static_cast<std::int64_t>(invocation.seed));
  stated.set("sigma", request.sigma);
  stated.set("dropped", request.dropped);
  stated.set("smooth_to", request.smooth_to);
  stated.set("stereo", request.stereo);
  stated.set("lookahead", request.lookahead);
  stated.set("parameters", of.parameters);
  stated.set("moves", of.moves);
  stated.set("mapping", of.mapping);
  stated.set("up", request.up);
  return stated;
}

Evaluation evaluation_of(const ExploreEvaluation& request, const Invocation& invocation,
                         const Registry& registry) {
  Evaluation made;
  made.utilities = utilities_of(request, registry);
  made.worlds = distinct_worlds(request.worlds, "evaluate explore");
  for (const WorldName& name : made.worlds) require_world(name, request.up);
  made.setup.episode.steps = request.steps;
  made.setup.episode.lookahead = request.lookahead;
  made.mapping = made.setup.set_mapping(request.mapping);
  made.moves = made.setup.set_moves(request.moves);
  set_depth(request, made.setup);
  for (const std::string& text : invocation.overrides) apply_override(made.parameters, text);
  for (const auto& [name, given] : made.parameters.as_map()) {
    if (std::find(made.utilities.begin(), made.utilities.end(), name) == made.utilities.end())
      throw InputError("--set " + name +
                       ": no utility of this name is evaluated; expected UTILITY.KEY=VALUE");
    registry.create<ViewUtility>(name, given, name);
  }
  made.stated = settings_stated(request, made, invocation);
  // Worlds and utilities may join, so that they are not part of an episode's mark.
  made.mark = made_by(made.stated.at("program").as_text(), made.stated);
  made.records =
      records_of(made.worlds, made.utilities, made.parameters, made.setup, registry, invocation);
  if (!made.records.moves.as_map().empty()) made.stated.set("world_moves", made.records.moves);
  made.stated.set("files", made.records.files);
  return made;
}

// The items: every utility's episodes in every world; those of one world are a group.
class Trials {
 public:
  Trials(const ExploreEvaluation& request, const Evaluation& evaluation, const Registry& registry,
         const Invocation& invocation)
      : request_(request),
        evaluation_(evaluation),
        registry_(registry),
        invocation_(invocation),
        missing_(evaluation.worlds.size(), 0),
        made_(evaluation.worlds.size(), 0) {
    for (const WorldName& world : evaluation.worlds)
      for (std::int64_t episode = 1; episode <= request.episodes; ++episode)
        for (const std::string& utility : evaluation.utilities)
          trials_.push_back({world.text(), utility, episode});
  }

  ItemList list() {
    ItemList list;
    list.folder = request_.folder;
    list.groups = evaluation_.worlds.size();
    const std::size_t each = trials_.size() / list.groups;
    for (std::size_t k = 0; k < trials_.size(); ++k)
      list.items.push_back({file_of(k).string(),
                            k / each,
                            {trials_[k].utility + " in " + trials_[k].world, trials_[k].utility}});
    list.is_made = [this, each](std::size_t item) {
      const bool there = has_item(request_.folder / file_of(item), evaluation_.mark);
      if (!there) ++missing_[item / each];
      return there;
    };
    list.prepare = [this](std::size_t world) {
      return load_for_episodes(evaluation_.worlds[world], request_.up, evaluation_.setup, registry_,
                               invocation_);
    };
    list.make = [this](std::size_t item, const void* prepared) {
      const auto& used = *static_cast<const WorldInUse*>(prepared);
      run_trial(trials_[item], used.world, used.truth,
                setup_of(evaluation_.setup, evaluation_.records, trials_[item].world), registry_,
                evaluation_.parameters, invocation_.seed, evaluation_.mark, request_.folder);
    };
    list.done = [this, each](std::size_t item) {
      const std::size_t world = item / each;
      ++made_[world];
      if (!invocation_.quiet)
        std::cerr << visible_line(trials_[item].world) + ": " + std::to_string(made_[world]) +
                         " of " + std::to_string(missing_[world]) + " episodes\n";
    };
    return list;
  }

 private:
  fs::path file_of(std::size_t k) const {
    return fs::path("episodes") / (trials_[k].name() + ".json");
  }

  const ExploreEvaluation& request_;
  const Evaluation& evaluation_;
  const Registry& registry_;
  const Invocation& invocation_;
  std::vector<Trial> trials_;
  std::vector<int> missing_, made_;  // by world
};

// A folder in which nothing was made is left without settings.
void forget_settings(const fs::path& folder) {
  std::error_code code;
  if (fs::exists(folder / "episodes", code) && !fs::is_empty(folder / "episodes", code)) return;
  fs::remove(folder / "settings.json", code);
  fs::remove_all(folder / "times", code);
}

void print_figures(const Evaluation& evaluation, const ExplorationTables& tables,
                   const std::string& report, const Invocation& invocation) {
  const Value& moves = evaluation.records.moves;
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "ok");
    object.set("report", report);
    object.set("moves", evaluation.moves);
    if (!moves.as_map().empty()) object.set("world_moves", moves);
    object.set("rows", tables.rows);
    print_json(object);
  } else if (!invocation.quiet) {
    std::cout << visible_text(tables.text);
    for (const auto& [world, own] : moves.as_map())
      std::cout << "\n"
                << visible_line(world) << " was explored with the moves that its scene recommends: "
                << visible_line(settings_text(own)) << " (--moves KEY=VALUE sets others)";
    std::cout << "\nreport: " << visible_line(report) << std::endl;
  }
}

ExitStatus evaluate(const ExploreEvaluation& request, const Invocation& invocation,
                    const Registry& registry, ItemRun& run, const CancellationToken& cancellation) {
  Evaluation evaluation = evaluation_of(request, invocation, registry);
  evaluation.setup.episode.cancellation = &cancellation;
  if (!request.against.empty())
    require_same_starts(request, evaluation.stated, evaluation.worlds, evaluation.utilities);
  std::optional<FolderClaim> claim;
  Value settings;
  bool stated = false;  // by this process, in the folder
  const auto open = [&] {
    claim.emplace(request.folder, claim_for(request.items));
    settings = settings_for(request, evaluation.stated);
    if (request.items.gather || request.items.schedule) return;
    write_file_atomically(request.folder / "settings.json", to_json(settings) + "\n");
    stated = true;
  };
  Trials trials(request, evaluation, registry, invocation);
  try {
    if (!run.make(trials.list(), evaluation.stated, open)) return print_answer(run, invocation);
  } catch (...) {
    if (stated && !request.items.continues()) forget_settings(request.folder);
    throw;
  }
  std::vector<std::string> worlds;
  for (const WorldName& name : evaluation.worlds) worlds.push_back(name.text());
  const ExplorationTables tables =
      write_exploration_figures({request.folder, request.against, settings, worlds,
                                 evaluation.utilities, request.episodes, request.steps});
  print_figures(evaluation, tables, (request.folder / "report.html").string(), invocation);
  return ExitStatus::done;
}

}  // namespace

ExitStatus evaluate_explore(const ExploreEvaluation& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  return run_items(request.items, invocation, registry,
                   [&](ItemRun& run, const CancellationToken& cancellation) {
                     return evaluate(request, invocation, registry, run, cancellation);
                   });
}

}  // namespace lapwing
