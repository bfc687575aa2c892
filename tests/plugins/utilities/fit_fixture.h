// SPDX-License-Identifier: Apache-2.0
// Training on samples that are easy to learn, in a folder of its own.
#pragma once

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/map/plain_map.h"
#include "plugins/utilities/learned/fit.h"

namespace lapwing {

struct TrainingFolder {
  using WriteSamples = void (*)(const std::filesystem::path& folder, int files, std::uint64_t seed);

  const Trainable& trainable;
  std::filesystem::path folder;
  FitRequest request;
  Value given = Value::map();

  TrainingFolder(const Trainable& trained, const char* name, WriteSamples write, int files)
      : trainable(trained), folder(std::filesystem::path(testing::TempDir()) / name) {
    std::filesystem::remove_all(folder);
    write(folder / "training", files, 1);
    write(folder / "validation", 1, 2);
    request.training = sample_files({folder / "training"});
    request.validation = sample_files({folder / "validation"});
    request.model = folder / "a.model";
    request.checkpoint = folder / "a.checkpoint";
  }
  ~TrainingFolder() { std::filesystem::remove_all(folder); }

  Value run() { return trainable.fit(check(trainable.fit_parameters(), given), request); }
  // What it says; empty where it does not refuse.
  std::string refusal() {
    try {
      run();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

// Without samples, of a mapping that is whole.
inline SampleSet made_set(const std::string& world, const ViewInput& input) {
  SampleSet set;
  set.world = world;
  set.input = input;
  const PlainMap map{MapSettings{}};
  EpisodeView known;
  known.map = &map;
  set.mapping = mapping_of(known);
  set.mapping.set("resolution", 0.4);
  return set;
}

// Small enough to be trained in a moment.
inline constexpr GridShape kSmallGrid{8, 4, 4, 1};

// Samples whose target is how much is certain in the middle: easy to learn.
inline void write_grid_samples(const std::filesystem::path& folder, int files, std::uint64_t seed) {
  Random random(seed);
  for (int file = 0; file < files; ++file) {
    SampleSet set = made_set("made " + std::to_string(file), kSmallGrid);
    for (int k = 0; k < 64; ++k) {
      const double level = random.uniform();
      std::vector<float> grid;
      for (std::size_t i = 0; i < kSmallGrid.size(); ++i)
        grid.push_back(static_cast<float>(0.8 * level + 0.2 * random.uniform()));
      set.add(grid, std::vector{static_cast<float>(100 * level)});
    }
    write_samples(set, folder / ("set_" + std::to_string(seed * 10 + file) + ".samples"));
  }
}

struct GridTraining : TrainingFolder {
  GridTraining() : TrainingFolder(learned::kGridTrainable, "learned_fit", &write_grid_samples, 2) {
    Value& grid = given.set("grid", Value::map());
    grid.set("across", 8);
    grid.set("ahead", 4);
    grid.set("up", 4);
    grid.set("levels", 1);
    given.set("units", 1);
    given.set("hidden1", 16);
    given.set("hidden2", 8);
    given.set("batch", 32);
    given.set("epochs", 12);
    given.set("rate", 0.01);
    given.set("dropout", 0.0);
  }
};

// A cell shows as many voxels as its ray's first number says: easy to learn.
inline void write_ray_samples(const std::filesystem::path& folder, int files, std::uint64_t seed) {
  Random random(seed);
  for (int file = 0; file < files; ++file) {
    const RayShape rays{6, 5};
    SampleSet set = made_set("made " + std::to_string(seed * 10) + std::to_string(file), rays);
    for (int k = 0; k < 64; ++k) {
      std::vector<float> image(rays.size(), 0), cells;
      const double most = random.uniform(0, 5);
      for (int ray = 0; ray < rays.rays(); ++ray) {
        const double there = random.uniform();
        image[static_cast<std::size_t>(ray * RayShape::kChannels)] = static_cast<float>(there);
        image[static_cast<std::size_t>(ray * RayShape::kChannels + 1)] =
            static_cast<float>(most / 5);
        cells.push_back(static_cast<float>(most * there));
      }
      set.add(image, cells);
    }
    write_samples(
        set, folder / ("set_" + std::to_string(seed * 10) + std::to_string(file) + ".samples"));
  }
}

struct RayTraining : TrainingFolder {
  RayTraining() : TrainingFolder(learned::kRayTrainable, "learned_rays", &write_ray_samples, 4) {
    given.set("rays", to_value(RayShape{6, 5}));
    given.set("width", 16);
    given.set("convolutions", 1);
    given.set("batch", 16);
    given.set("epochs", 25);
    given.set("patience", 25);
    given.set("rate", 0.01);
  }
};

}  // namespace lapwing
