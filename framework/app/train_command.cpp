// lapwing train: samples of oracle episodes, training, judging a model.
#include <cmath>
#include <cstdio>
#include <iostream>

#include "framework/app/exploration_worlds.h"
#include "framework/app/interruption.h"
#include "framework/app/progress_line.h"
#include "framework/app/train_command.h"
#include "framework/config/overrides.h"
#include "framework/core/parallel.h"
#include "framework/explore/trainable.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const Trainable& trainable_of(const Registry& registry, const std::string& utility) {
  registry.find("utility", utility);
  const void* table = registry.extension("utility", utility, kTrainable);
  if (!table) throw InputError("utility '" + utility + "' is not one that is trained");
  return *static_cast<const Trainable*>(table);
}

Parameters training_parameters(const Trainable& trainable, const Invocation& invocation) {
  Value given = Value::map();
  for (const std::string& text : invocation.overrides) apply_override(given, text);
  return check(trainable.parameters(), given);
}

std::string file_name(const std::string& world, std::int64_t episode) {
  return file_text(world) + "_" + std::to_string(episode) + ".samples";
}

// A utility explores; what every neighbour looked like, and its value to the oracle, is kept.
SampleSet sampled_episode(const World& world, const GroundTruth& truth,
                          const ExplorationSetup& setup, const Registry& registry,
                          const std::string& explorer, const Value& parameters,
                          const GridShape& shape, std::int64_t episode, std::uint64_t seed) {
  SampleSet samples;
  samples.world = world.name;
  samples.episode = episode;
  samples.shape = shape;
  const auto utility = registry.create<ViewUtility>(explorer, parameters, explorer);
  const auto new_map = setup.new_map(registry);
  Random random = Random(seed).split(static_cast<std::uint64_t>(episode));
  const Viewpoint start =
      random_start(truth, setup.episode.clear, setup.episode.sensor.range / 2, setup.pitch, random);
  ObservedSurface observed(truth, setup.episode.sensor, new_map);
  const std::unique_ptr<Map> map = new_map();
  std::vector<float> grid(shape.size());
  explore(setup.episode, start, truth, observed, *utility, *map, [&](const EpisodeMoment& moment) {
    if (samples.mapping.is_null()) samples.mapping = mapping_of(moment.known);
    moment.known.means->refresh(shape.levels);
    for (const Viewpoint& view : moment.neighbours) {
      sample_grid(moment.known, view, shape, grid);
      samples.add(grid, observed.gain(view));
    }
  });
  return samples;
}

}  // namespace

ExitStatus make_dataset(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Interruption interruption;
  const Trainable& trainable = trainable_of(registry, request.utility);
  const GridShape shape = trainable.shape(training_parameters(trainable, invocation));
  const std::vector<WorldName> names = distinct_worlds(request.worlds, "train dataset");
  ExplorationSetup setup;
  setup.episode.steps = request.steps;
  setup.set_moves(request.moves);
  setup.episode.show_truth = request.explorer == "oracle";
  setup.episode.cancellation = &interruption.token();
  Value explorer = Value::map();
  for (const std::string& text : request.explorer_overrides) apply_override(explorer, text);
  registry.create<ViewUtility>(request.explorer, explorer, request.explorer);  // may refuse it
  std::size_t samples = 0;
  for (const WorldName& name : names) {
    std::vector<std::int64_t> missing;
    for (std::int64_t episode = 1; episode <= request.episodes; ++episode)
      if (!request.resume || !fs::exists(request.target / file_name(name.text(), episode)))
        missing.push_back(episode);
    if (missing.empty()) continue;
    const World world = load_world(name, request.up, registry, invocation);
    const GroundTruth truth = setup.truth_of(world);
    std::vector<std::size_t> made(missing.size());
    parallel_for(missing.size(), invocation.threads, [&](std::size_t k) {
      if (interruption.token().cancelled()) return;
      const SampleSet set = sampled_episode(world, truth, setup, registry, request.explorer,
                                            explorer, shape, missing[k], invocation.seed);
      if (interruption.token().cancelled()) return;
      write_samples(set, request.target / file_name(name.text(), missing[k]));
      made[k] = set.size();
    });
    if (interruption.token().cancelled()) throw Cancelled();
    for (const std::size_t count : made) samples += count;
    if (!invocation.quiet)
      std::cerr << name.text() << ": " << missing.size() << " episodes, " << samples
                << " samples so far\n";
  }
  return ExitStatus::done;
}

ExitStatus fit_model(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Interruption interruption;
  const Trainable& trainable = trainable_of(registry, request.utility);
  FitRequest fit;
  fit.training = sample_files(request.samples);
  fit.validation = sample_files(request.validation);
  fit.model = request.target;
  fit.checkpoint = request.target;
  fit.checkpoint += ".checkpoint";
  fit.resume = request.resume;
  fit.seed = invocation.seed;
  fit.threads = invocation.threads;
  fit.cancellation = &interruption.token();
  fit.log = [&](const std::string& line) {
    if (!invocation.quiet) std::cerr << line << std::endl;
  };
  const Value figures = trainable.fit(training_parameters(trainable, invocation), fit);
  if (invocation.json) print_json(figures);
  return ExitStatus::done;
}

ExitStatus score_model(const TrainRequest& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Trainable& trainable = trainable_of(registry, request.utility);
  struct Sums {
    std::vector<float> predicted, targets;
  };
  std::map<std::string, Sums> worlds;
  for (const fs::path& file : sample_files(request.samples)) {
    const SampleSet set = read_samples(file);
    const std::vector<float> predicted = trainable.predict(request.target, set, invocation.threads);
    Sums& sums = worlds[set.world];
    sums.predicted.insert(sums.predicted.end(), predicted.begin(), predicted.end());
    sums.targets.insert(sums.targets.end(), set.targets.begin(), set.targets.end());
  }
  Value object = Value::map();
  if (!invocation.json) std::printf("%-24s %8s %8s %8s\n", "world", "samples", "rho", "loss");
  for (const auto& [world, sums] : worlds) {
    const double rho = rank_correlation(sums.predicted, sums.targets);
    const double loss = trainable.loss(request.target, sums.predicted, sums.targets);
    Value& entry = object.set(world, Value::map());
    entry.set("samples", static_cast<std::int64_t>(sums.targets.size()));
    entry.set("rho", std::isfinite(rho) ? Value(rho) : Value());
    entry.set("loss", loss);
    if (!invocation.json)
      std::printf("%-24s %8zu %8.3f %8.3f\n", world.c_str(), sums.targets.size(), rho, loss);
  }
  if (invocation.json) print_json(object);
  return ExitStatus::done;
}

}  // namespace lapwing
