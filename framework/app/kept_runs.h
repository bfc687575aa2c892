// SPDX-License-Identifier: Apache-2.0
// The runs of `lapwing simulate --runs N --keep-runs DIR`: a file each, named by its seed.
#pragma once

#include "framework/export/runs_report.h"
#include "framework/items/item_run.h"

namespace lapwing {

// What a report needs of one run. Attitudes, velocities and thrusts are not kept.
struct KeptRun {
  FlownPath path;
  RunVerdict verdict;
};
// A map of numbers that reads back as the same bits. Numbers that are not finite become null.
Value to_value(const KeptRun& run);
// InputError where it is not such a map.
KeptRun kept_run_from(const Value& value);

// What runs are made from: the plan and the files beside it that it names, the controller, the
// conditions without their seed.
struct RunInputs {
  std::filesystem::path plan;
  std::string controller;  // as the user states it, with the plugin's checksum
  Value conditions;
  double tolerance = 0;  // m
};
Value statement_of(const RunInputs& inputs);

// The items: `count` runs, the first with the seed `first`, which `fly` makes.
ItemList run_items_of(const std::filesystem::path& folder, std::uint64_t first, std::size_t count,
                      const Value& mark, std::function<KeptRun(std::uint64_t seed)> fly);
// All of them, in their order.
std::vector<KeptRun> read_runs(const ItemList& list);

}  // namespace lapwing
