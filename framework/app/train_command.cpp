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
#include "framework/core/parallel.h"
#include "framework/core/visible_text.h"
#include "framework/explore/trainable.h"
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
                          const Value& made_by, const GridShape& shape, std::int64_t episode,
                          std::uint64_t seed) {
  SampleSet samples;
  samples.world = world.name;
  samples.episode = episode;
  samples.made_by = made_by;
  samples.shape = shape;
  const auto utility = registry.create<ViewUtility>(explorer, parameters, explorer);
  const auto new_map = setup.new_map(registry);
  Random random = Random(seed).split(static_cast<std::uint64_t>(episode));
  ObservedSurface observed(truth, setup.episode.sensor, new_map);
  const std::unique_ptr<Map> map = new_map();
  std::vector<float> grid(shape.size());
  const auto keep = [&](const EpisodeMoment& moment) {
    if (samples.mapping.is_null()) samples.mapping = mapping_of(moment.known);
    moment.known.means->refresh(shape.levels);
    for (const Viewpoint& view : moment.neighbours) {
      sample_grid(moment.known, view, shape, grid);
      samples.add(grid, observed.gain(view));
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

// The episodes of a world that are to be flown; what is there is neither written over nor, where
// it was made otherwise, taken for these.
std::vector<std::int64_t> missing_episodes(const TrainRequest& request, const std::string& world,
                                           const Value& made_by) {
  std::vector<std::int64_t> missing;
  for (std::int64_t episode = 1; episode <= request.episodes; ++episode) {
    const fs::path file = request.target / file_name(world, episode);
    if (!fs::exists(file)) {
      missing.push_back(episode);
    } else if (!request.resume) {
      throw InputError("'" + file.string() +
                       "' exists: --resume keeps it and makes the missing ones; another " +
                       "folder keeps both");
    } else {
      const SampleSet there = read_samples(file);
      const std::string difference = there.world != world ? "its world is " + there.world
                                     : there.episode != episode
                                         ? "it is episode " + std::to_string(there.episode)
                                         : settings_difference(there.made_by, made_by);
      if (!difference.empty())
        throw InputError("'" + file.string() + "' was made with other settings: " + difference +
                         "; another folder keeps both");
    }
  }
  return missing;
}

}  // namespace

ExitStatus make_dataset(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Interruption interruption;
  const Trainable& trainable = trainable_of(registry, request.utility);
  const GridShape shape =
      trainable.sample_shape(training_parameters(trainable.sample_parameters(), invocation));
  const std::vector<WorldName> names = distinct_worlds(request.worlds, "train dataset");
  for (const WorldName& name : names) require_world(name, request.up);
  if (fs::exists(request.target) && !fs::is_directory(request.target))
    throw InputError("'" + request.target.string() + "' is a file: samples go into a folder");
  require_writable(request.target / "any.samples");
  ExplorationSetup setup;
  setup.episode.steps = request.steps;
  const Value mapping = setup.set_mapping(request.mapping);
  const Value moves = setup.set_moves(request.moves);
  setup.episode.show_truth = needs_truth(registry, request.explorer);
  setup.episode.cancellation = &interruption.token();
  Value explorer = Value::map();
  for (const std::string& text : request.explorer_overrides)
    apply_override(explorer, text, "--explorer-set");
  registry.create<ViewUtility>(request.explorer, explorer, request.explorer);  // may refuse it
  Value parameters = Value::map();
  parameters.set(request.explorer, explorer);
  std::vector<Value> made_by;
  std::vector<ExplorationSetup> setups;
  std::vector<std::vector<std::int64_t>> missing;
  for (const WorldName& name : names) {
    const WorldRecords records =
        records_of({name}, {request.explorer}, parameters, setup, registry, invocation);
    setups.push_back(setup_of(setup, records, name.text()));
    const Value* own = records.moves.find(name.text());
    Value made = Value::map();
    made.set("program", std::string("lapwing ") + program_version());
    made.set("explorer", request.explorer);
    made.set("parameters", explorer);
    made.set("seed", static_cast<std::int64_t>(invocation.seed));
    made.set("steps", request.steps);
    made.set("moves", own ? *own : moves);
    made.set("mapping", mapping);
    made.set("up", request.up);
    made.set("grid", to_value(shape));
    made.set("files", records.files);
    missing.push_back(missing_episodes(request, name.text(), made));
    made_by.push_back(std::move(made));
  }
  std::vector<std::pair<std::size_t, std::int64_t>> tasks;  // world, episode
  WorldsInUse in_use(setup, request.up, registry, invocation);
  for (std::size_t w = 0; w < names.size(); ++w)
    for (const std::int64_t episode : missing[w]) {
      tasks.emplace_back(w, episode);
      in_use.expect(names[w]);
    }
  parallel_for(tasks.size(), invocation.threads, [&](std::size_t k) {
    if (interruption.token().cancelled()) return;
    const auto [w, episode] = tasks[k];
    const auto used = in_use.begin(names[w]);
    const SampleSet set =
        sampled_episode(used->world, used->truth, setups[w], registry, request.explorer, explorer,
                        made_by[w], shape, episode, invocation.seed);
    if (interruption.token().cancelled()) return;
    write_samples(set, request.target / file_name(names[w].text(), episode));
    const auto [ended, expected] = in_use.end(names[w]);
    if (!invocation.quiet)
      std::cerr << visible_line(names[w].text()) + ": " + std::to_string(ended) + " of " +
                       std::to_string(expected) + " episodes, this one of " +
                       std::to_string(set.size()) + " samples\n";
  });
  if (interruption.token().cancelled()) throw Cancelled();
  return ExitStatus::done;
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
    world.targets.insert(world.targets.end(), set.targets.begin(), set.targets.end());
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
