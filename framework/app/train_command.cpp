// SPDX-License-Identifier: Apache-2.0
// lapwing train: samples of oracle episodes, training, judging a model.
#include <cmath>
#include <cstdio>
#include <iostream>

#include "framework/app/exploration_settings.h"
#include "framework/app/interruption.h"
#include "framework/app/progress_line.h"
#include "framework/app/train_command.h"
#include "framework/config/overrides.h"
#include "framework/core/files.h"
#include "framework/core/portable.h"
#include "framework/core/visible_text.h"
#include "framework/explore/trainable.h"
#include "framework/items/statement.h"
#include "framework/mission/explore_library.h"
#include "framework/study/study_settings.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const Trainable& trainable_of(const Registry& registry, const std::string& utility) {
  registry.find("utility", utility);
  const void* table = registry.extension("utility", utility, kTrainable);
  if (!table) throw InputError("utility '" + utility + "' is not a trained utility");
  return *static_cast<const Trainable*>(table);
}

Parameters training_parameters(const ParameterTable& table, const Invocation& invocation) {
  Value given = Value::map();
  for (const std::string& text : invocation.overrides) apply_override(given, text);
  return check(table, given);
}

std::string file_name(const std::string& world, std::int64_t episode) {
  return file_text(world) + "_" + std::to_string(episode) + ".samples";
}

// A utility explores; what every neighbour looked like, and its value to the oracle, is kept.
SampleSet sampled_episode(const World& world, const GroundTruth& truth,
                          const ExplorationSetup& setup, const Registry& registry,
                          const std::string& explorer, const Value& parameters,
                          const Value& made_by, const ViewInput& input, std::int64_t episode,
                          std::uint64_t seed) {
  SampleSet samples;
  samples.world = world.name;
  samples.episode = episode;
  samples.made_by = made_by;
  samples.input = input;
  const auto utility = registry.create<ViewUtility>(explorer, parameters, explorer);
  const auto new_map = setup.new_map(registry);
  Random random = Random(seed).split(static_cast<std::uint64_t>(episode));
  ObservedSurface observed(truth, setup.episode.sensor, new_map);
  const std::unique_ptr<Map> map = new_map();
  std::vector<float> numbers(numbers_of(input)), parts(targets_of(input));
  const auto keep = [&](const EpisodeMoment& moment) {
    if (samples.mapping.is_null()) samples.mapping = mapping_of(moment.known);
    if (const auto* grid = std::get_if<GridShape>(&input))
      moment.known.means->refresh(grid->levels);
    for (const Viewpoint& view : moment.neighbours) {
      sample_view(moment.known, view, input, numbers);
      view_targets(observed, view, moment.known.pinhole, input, parts);
      samples.add(numbers, parts);
    }
  };
  try {
    const Viewpoint start = random_start(truth, setup.episode.clear, setup.episode.sensor.range / 2,
                                         setup.pitch, random);
    explore(setup.episode, start, truth, observed, *utility, *map, keep);
  } catch (const StartError& error) {
    throw setup.with_options(error, world.name);
  }
  return samples;
}

// Whether an episode's file is there. What is there is neither written over nor, where it was made
// otherwise, taken for this episode.
bool has_samples(const TrainRequest& request, const std::string& world, std::int64_t episode,
                 const Value& made_by) {
  const fs::path file = request.target / file_name(world, episode);
  if (!fs::exists(file)) return false;
  if (!request.items.continues())
    throw InputError("'" + file.string() +
                     "' exists: --resume keeps it and makes the missing ones; another " +
                     "folder keeps both");
  const SampleSet there = read_samples(file);
  const std::string difference = there.world != world ? "its world is " + there.world
                                 : there.episode != episode
                                     ? "it is episode " + std::to_string(there.episode)
                                     : settings_difference(there.made_by, made_by);
  if (!difference.empty())
    throw InputError("'" + file.string() + "' was made with other settings: " + difference +
                     "; another folder keeps both");
  return true;
}

// What samples are made of, the same in every process.
struct Dataset {
  ViewInput input;
  std::vector<WorldName> worlds;
  Value explorer = Value::map();         // its parameters
  std::vector<Value> made_by;            // by world: what its files state
  std::vector<ExplorationSetup> setups;  // by world
};

Dataset dataset_of(const TrainRequest& request, const Invocation& invocation,
                   const Registry& registry, const CancellationToken& cancellation) {
  Dataset dataset;
  const Trainable& trainable = trainable_of(registry, request.utility);
  dataset.input =
      trainable.sample_input(training_parameters(trainable.sample_parameters(), invocation));
  dataset.worlds = distinct_worlds(request.worlds, "train dataset");
  for (const WorldName& name : dataset.worlds) require_world(name, request.up);
  ExplorationSetup setup;
  setup.episode.steps = request.steps;
  const Value mapping = setup.set_mapping(request.mapping);
  const Value moves = setup.set_moves(request.moves);
  setup.episode.show_truth = needs_truth(registry, request.explorer);
  setup.episode.cancellation = &cancellation;
  if (request.sigma > 0 || request.dropped > 0)
    setup.episode.sensor.noise = DepthNoise{request.dropped, request.sigma};
  for (const std::string& text : request.explorer_overrides)
    apply_override(dataset.explorer, text, "--explorer-set");
  registry.create<ViewUtility>(request.explorer, dataset.explorer, request.explorer);  // may refuse
  Value parameters = Value::map();
  parameters.set(request.explorer, dataset.explorer);
  for (const WorldName& name : dataset.worlds) {
    const WorldRecords records =
        records_of({name}, {request.explorer}, parameters, setup, registry, invocation);
    dataset.setups.push_back(setup_of(setup, records, name.text()));
    const Value* own = records.moves.find(name.text());
    Value made = Value::map();
    made.set("program", std::string("lapwing ") + program_version());
    made.set(kMachineEntry, machine_of_numbers());
    made.set("explorer", request.explorer);
    made.set("parameters", dataset.explorer);
    made.set("seed", static_cast<std::int64_t>(invocation.seed));
    made.set("steps", request.steps);
    made.set("moves", own ? *own : moves);
    made.set("mapping", mapping);
    made.set("up", request.up);
    made.set("sigma", request.sigma);
    made.set("dropped", request.dropped);
    made.set("input", to_value(dataset.input));
    made.set("files", records.files);
    dataset.made_by.push_back(std::move(made));
  }
  return dataset;
}

// The items: the episodes in every world; those of one world are a group.
class SampledEpisodes {
 public:
  SampledEpisodes(const TrainRequest& request, const Dataset& dataset, const Registry& registry,
                  const Invocation& invocation, const CancellationToken& cancellation)
      : request_(request),
        dataset_(dataset),
        registry_(registry),
        invocation_(invocation),
        cancellation_(cancellation),
        missing_(dataset.worlds.size(), 0),
        made_(dataset.worlds.size(), 0) {}

  ItemList list() {
    ItemList list;
    list.folder = request_.target;
    list.groups = dataset_.worlds.size();
    for (std::size_t world = 0; world < list.groups; ++world)
      for (std::int64_t episode = 1; episode <= request_.episodes; ++episode)
        list.items.push_back(
            {file_name(name_of(world), episode), world, {"episode in " + name_of(world)}});
    list.is_made = [this](std::size_t item) {
      const std::size_t world = world_of(item);
      const bool there =
          has_samples(request_, name_of(world), episode_of(item), dataset_.made_by[world]);
      if (!there) ++missing_[world];
      return there;
    };
    list.prepare = [this](std::size_t world) {
      return load_for_episodes(dataset_.worlds[world], request_.up, dataset_.setups[world],
                               registry_, invocation_);
    };
    list.make = [this](std::size_t item, const void* prepared) {
      const auto& used = *static_cast<const WorldInUse*>(prepared);
      const std::size_t world = world_of(item);
      const SampleSet set =
          sampled_episode(used.world, used.truth, dataset_.setups[world], registry_,
                          request_.explorer, dataset_.explorer, dataset_.made_by[world],
                          dataset_.input, episode_of(item), invocation_.seed);
      if (cancellation_.cancelled()) throw Cancelled();
      write_samples(set, request_.target / file_name(name_of(world), episode_of(item)));
    };
    list.done = [this](std::size_t item) {
      const std::size_t world = world_of(item);
      ++made_[world];
      if (!invocation_.quiet)
        std::cerr << visible_line(name_of(world)) + ": " + std::to_string(made_[world]) + " of " +
                         std::to_string(missing_[world]) + " episodes\n";
    };
    return list;
  }

 private:
  std::string name_of(std::size_t world) const { return dataset_.worlds[world].text(); }
  std::size_t world_of(std::size_t item) const {
    return item / static_cast<std::size_t>(request_.episodes);
  }
  std::int64_t episode_of(std::size_t item) const {
    return 1 + static_cast<std::int64_t>(item % static_cast<std::size_t>(request_.episodes));
  }

  const TrainRequest& request_;
  const Dataset& dataset_;
  const Registry& registry_;
  const Invocation& invocation_;
  const CancellationToken& cancellation_;
  std::vector<int> missing_, made_;  // by world
};

}  // namespace

ExitStatus make_dataset(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  return run_items(
      request.items, invocation, registry,
      [&](ItemRun& run, const CancellationToken& cancellation) {
        if (fs::exists(request.target) && !fs::is_directory(request.target))
          throw InputError("'" + request.target.string() + "' is a file: samples go into a folder");
        require_writable(request.target / "any.samples");
        const Dataset dataset = dataset_of(request, invocation, registry, cancellation);
        SampledEpisodes episodes(request, dataset, registry, invocation, cancellation);
        std::optional<FolderClaim> claim;
        Value statement = Value(Value::List(dataset.made_by.begin(), dataset.made_by.end()));
        const bool whole = run.make(episodes.list(), statement, [&] {
          claim.emplace(request.target, claim_for(request.items));
        });
        return whole ? ExitStatus::done : print_answer(run, invocation);
      });
}

ExitStatus fit_model(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Interruption interruption;
  const Trainable& trainable = trainable_of(registry, request.utility);
  if (request.validation.empty())
    throw InputError(
        "train fit: name samples with --validation, which the model is evaluated with");
  FitRequest fit;
  fit.training = sample_files(request.samples);
  fit.validation = sample_files(request.validation);
  fit.model = request.target;
  fit.checkpoint = request.target;
  fit.checkpoint += ".checkpoint";
  fit.resume = request.resume;
  if (fs::is_directory(fit.model))
    throw InputError("'" + fit.model.string() + "' is a folder: a model is a file");
  for (const fs::path& file : {fit.model, fit.checkpoint})
    if (!request.resume && fs::exists(file))
      throw InputError("'" + file.string() +
                       "' exists: --resume continues it; another name keeps both");
  require_writable(fit.model);
  require_writable(fit.checkpoint);
  fit.seed = invocation.seed;
  fit.threads = invocation.threads;
  fit.cancellation = &interruption.token();
  fit.log = [&](const std::string& line) {
    if (!invocation.quiet) std::cerr << visible_text(line) << std::endl;
  };
  const Value figures =
      trainable.fit(training_parameters(trainable.fit_parameters(), invocation), fit);
  if (invocation.json) print_json(figures);
  return ExitStatus::done;
}

ExitStatus score_model(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Trainable& trainable = trainable_of(registry, request.utility);
  struct OneWorld {
    std::vector<float> predicted, targets;
    double squares = 0;  // sum of errors
  };
  std::map<std::string, OneWorld> worlds;
  for (const fs::path& file : sample_files(request.samples)) {
    const SampleSet set = read_samples(file);
    const Prediction predicted = trainable.predict(request.model, set, invocation.threads);
    OneWorld& world = worlds[set.world];
    world.predicted.insert(world.predicted.end(), predicted.values.begin(), predicted.values.end());
    const std::vector<float> gains = set.gains();
    world.targets.insert(world.targets.end(), gains.begin(), gains.end());
    world.squares += predicted.loss * static_cast<double>(set.size());
  }
  Value object = Value::map();
  if (!invocation.json) std::printf("%-24s %8s %8s %8s\n", "world", "samples", "rho", "loss");
  for (const auto& [name, world] : worlds) {
    const std::size_t count = world.targets.size();
    const double rho = rank_correlation(world.predicted, world.targets);
    const double loss = world.squares / static_cast<double>(std::max<std::size_t>(count, 1));
    Value& entry = object.set(name, Value::map());
    entry.set("samples", static_cast<std::int64_t>(count));
    entry.set("rho", std::isfinite(rho) ? Value(rho) : Value());
    entry.set("loss", loss);
    if (!invocation.json)
      std::printf("%-24s %8zu %8.3f %8.3f\n", visible_line(name).c_str(), count, rho, loss);
  }
  if (invocation.json) print_json(object);
  return ExitStatus::done;
}

}  // namespace lapwing
