// SPDX-License-Identifier: Apache-2.0
// lapwing evaluate explore
#pragma once

#include "framework/app/item_command.h"

namespace lapwing {

struct ExploreEvaluation {
  std::vector<std::string> worlds;     // "downtown:101-104", "street", files
  std::vector<std::string> utilities;  // empty: all that are shipped
  std::vector<std::string> moves;      // "clear=2": ExplorationSetup::set_moves
  std::vector<std::string> mapping;    // "range=30": likewise set_mapping
  std::string up;                      // of mesh files, as `load_world` takes it
  std::int64_t episodes = 10;          // of each world, with the same starts for every utility
  int steps = 200, lookahead = 1;
  double sigma = 0, dropped = 0;  // of the camera's depth (table 5.4); replayed without
  double smooth_to = 0;           // m, to which the noise of sigma is smoothed; 0: it is not
  double stereo = 0;              // m between a pair of cameras; 0: a depth camera
  std::filesystem::path folder = "out/evaluate_explore";
  std::filesystem::path against;  // another evaluation's folder, from the same starts; or empty
  ItemOptions items;              // an item is an episode
};

// The invocation's overrides are parameters of utilities, as "learned.blank=true".
//
// Every episode is a file in FOLDER/episodes, whole or not there; from these come the tables
// (study/exploration_figures.h). Wall-clock figures stand apart, in FOLDER/seconds and seconds.csv.
// FOLDER/settings.json says what all of it was made of; InputError for a folder with episodes but
// without it, and for an evaluation to compare with that has other starts or lacks an episode.
ExitStatus evaluate_explore(const ExploreEvaluation& request, const Invocation& invocation);

}  // namespace lapwing
