// SPDX-License-Identifier: Apache-2.0
// How a model is trained from nothing, as one YAML file says: rounds of samples, each followed by a
// fit of all samples so far that begins with the model of the round before.
//
//   utility: learned
//   hours: 6                       # for all seeds; fewer hours take fewer seeds
//   default_hours: 1               # what is taken if nobody says; without it, all
//   validation:
//     - {scenes: [mine], seeds: [901, 903], explorer: frontier, steps: 80}
//   rounds:
//     - samples:
//         - {scenes: [mine, depot], seeds: [1, 48], explorer: oracle, steps: 100}
//         - {scenes: [mine], seeds: [401, 424], explorer: itself, steps: 100,
//            sigma: 0.5, dropped: 0.4}
//       fit: {epochs: 3}           # parameters of `train fit`
//
// The explorer `itself` is the utility with the model of the round before.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// One episode in each world of each scene.
struct RecipeSamples {
  std::vector<std::string> scenes;
  std::int64_t first = 1, last = 1;  // seeds
  std::string explorer;
  int steps = 100;
  double sigma = 0, dropped = 0;  // noise of the depth camera

  // "mine:1-48", for --world.
  std::vector<std::string> worlds() const;
};

struct RecipeRound {
  std::vector<RecipeSamples> samples;
  Value fit = Value::map();
};

struct TrainingRecipe {
  static constexpr const char* kItself = "itself";

  std::string utility;
  double hours = 1;          // for all seeds
  double default_hours = 1;  // at most `hours`
  std::vector<RecipeSamples> validation;
  std::vector<RecipeRound> rounds;
  std::string checksum;  // of the file

  // The first hours/this->hours of the seeds of every line, at least one. InputError for hours that
  // are not above 0, or more than there are seeds for.
  TrainingRecipe within(double hours) const;
};
// InputError naming the file: keys that are none, a line that is missing, seeds that are no range,
// `itself` where there is no model yet, a world that is both in training and in validation or
// twice in training.
TrainingRecipe read_recipe(const std::filesystem::path& file);

}  // namespace lapwing
