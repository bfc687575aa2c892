// SPDX-License-Identifier: Apache-2.0
// What a study of scans compares, and what it writes down of each: methods and rows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/plugin/registry.h"
#include "framework/surface/reconstruction.h"

namespace lapwing {

// A pattern, or tour solvers of which each begins with the tour of the one before.
struct ScanMethod {
  struct Solver {
    std::string name;
    Value parameters = Value::map();
  };
  std::string name;  // as it was asked for
  std::vector<Solver> solvers = {};
  bool pattern = false;
};

// "greedy", "cost_benefit+local_search", "milp:candidates=500,nodes=100", "hemisphere_60".
// InputError for what is neither a pattern nor a known solver with right parameters.
ScanMethod scan_method(const std::string& text, const Registry& registry);

// What one method did in one case with one budget.
struct ScanRow {
  std::string mission, method;
  std::uint64_t seed = 0;
  double budget = 0;  // s
  std::string status = "", message = "";
  bool found = false;        // a tour
  bool reproducible = true;  // false: the wall clock ended it
  bool counts = true;        // of milp: see counts_as_rival
  // Of what all candidates show together; not a number for views that are none of them.
  double score = 0, score_share = 0;
  std::optional<double> upper_bound = std::nullopt;
  double seconds = 0;  // of flight
  int images = 0, first_images = 0, candidates = 0;
  std::int64_t evaluations = 0;
  double surface_share = 1;                         // of the region's surface, that counts
  ReconstructionScore with_first = {}, alone = {};  // with and without the first flight's images
};
Value to_value(const ScanRow& row);
ScanRow scan_row_from(const Value& value);

}  // namespace lapwing
