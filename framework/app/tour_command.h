// SPDX-License-Identifier: Apache-2.0
// lapwing tour: tour solvers on published instances of the orienteering problem.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/app/command_line.h"

namespace lapwing {

struct TourRun {
  std::vector<std::filesystem::path> files;  // view/orienteering_file.h
  std::vector<std::string> solvers;          // none: local_search
  std::optional<double> guard;               // s of wall clock for one solution
  int team = 1;                              // tours, each with that part of the cost limit
};

// Solves every instance by every solver, which take the parameters of `--set`, and prints a table:
// score, upper bound, gap, nodes, length, time. With a team, several tours share the score, each
// with an equal part of the cost limit (Chao, Golden and Wasil, EJOR 1996). InputError for a file
// or a parameter that cannot be read, before anything is solved. Not certified: a solver found no
// tour.
ExitStatus solve_tours(const TourRun& asked, const Invocation& invocation);

}  // namespace lapwing
