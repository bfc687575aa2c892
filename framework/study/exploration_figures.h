// SPDX-License-Identifier: Apache-2.0
// The figures of an evaluation of explorations (tables 5.1 to 5.5, figure 5.10), made of the files
// of its episodes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// One episode of a utility in a world; episodes of one number have one start.
struct Trial {
  std::string world, utility;
  std::int64_t episode = 0;

  std::string name() const;  // of its files, without ending
};

struct ExplorationFigures {
  std::filesystem::path folder;
  std::filesystem::path against;  // another evaluation with the same starts; empty: none
  Value settings;                 // of the evaluation, for the report
  std::vector<std::string> worlds, utilities;
  std::int64_t episodes = 1;  // of each world and utility
  int steps = 1;              // images of a whole episode
};

struct ExplorationTables {
  std::string text;  // in columns
  Value rows;        // a list: what table.csv has, absent figures null
};

// Writes table.csv, seconds.csv, curves.csv and report.html into the folder. With several worlds
// the rows of "all" hold all episodes of a utility together.
//
// Efficiency is the area under the curve of observed surface (5.6), in voxels times images;
// relative: to the oracle's from the same start, below: how far it stays below `learned` there, of
// the oracle's; against: of what the same utility came to in the other evaluation from the same
// start (table 5.4). Intervals: half the width of the 95 % interval of a mean, by Student's t; of
// several worlds that of their mean for other starts in these worlds, not for other worlds.
// InputError for an episode whose file is not whole.
ExplorationTables write_exploration_figures(const ExplorationFigures& asked);

}  // namespace lapwing
