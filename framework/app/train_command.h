// SPDX-License-Identifier: Apache-2.0
// lapwing train all|dataset|fit|score
#pragma once

#include "framework/app/item_command.h"

namespace lapwing {

struct TrainRequest {
  std::string utility = "learned";
  std::string explorer = "oracle";  // dataset: the utility that chooses; the oracle judges
  std::vector<std::string> explorer_overrides;  // dataset: its parameters, as "model=FILE"
  std::vector<std::string> worlds;              // dataset: "downtown:1-8", files
  std::vector<std::string> moves;               // dataset: "clear=2", ExplorationSetup::set_moves
  std::vector<std::string> mapping;             // dataset: "range=30", likewise set_mapping
  std::string up;                               // dataset: of mesh files, as `load_world` takes it
  std::int64_t episodes = 4;                    // dataset: of each world
  int steps = 200;                              // dataset: of each episode
  std::vector<std::filesystem::path> samples;   // fit, score: files and folders of them
  std::vector<std::filesystem::path> validation;  // fit: likewise, of other worlds or episodes
  std::filesystem::path target;                   // dataset: a folder; fit: a model
  std::filesystem::path model;                    // score
  bool resume = false;                            // fit, all
  double sigma = 0, dropped = 0;                  // dataset: noise of the depth camera, m and share
  std::filesystem::path recipe;                   // all; empty: the shipped one
  std::optional<double> hours;                    // all: a share of the recipe's; none: all
  ItemOptions items;                              // dataset: an item is an episode
};

// Episodes of the oracle, each a file of samples; with `resume` those that are there are kept.
ExitStatus make_dataset(const TrainRequest& request, const Invocation& invocation);
// All of a recipe (study/training_recipe.h): samples and fits in MODEL.training, the model, and
// its figures by round beside it.
ExitStatus train_all(const TrainRequest& request, const Invocation& invocation);
// Writes the model, and MODEL.checkpoint after every epoch.
ExitStatus fit_model(const TrainRequest& request, const Invocation& invocation);
// Spearman's rho and the loss of (5.4) per world.
ExitStatus score_model(const TrainRequest& request, const Invocation& invocation);

}  // namespace lapwing
