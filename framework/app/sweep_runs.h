// SPDX-License-Identifier: Apache-2.0
// The runs of a sweep: which there are, the processes that do them, and what they left behind.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/app/plan_figures.h"
#include "framework/core/progress.h"
#include "framework/core/value.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

struct VariedKey {
  std::string name;
  std::vector<std::string> values;
};

struct SweepRun {
  std::string name;                 // run_001; also of its folder
  std::vector<std::string> values;  // one for each key
  std::filesystem::path folder;
  std::optional<int> exit;  // of `lapwing run`; none: it was not begun, or did not come to its end
  Value answer;             // its --json; null where it gave none
  std::string errors;       // what it wrote on standard error
  std::optional<Plan> plan;
  PlanFigures figures;  // of the plan

  // ok, not_certified, ..., "not run"; "exit 3" where there is no answer.
  std::string status() const;
  // Why it is not certified or failed, a sentence each.
  std::vector<std::string> reasons() const;
};

// "weights.effort=0.01,0.1"; commas within brackets belong to a value. InputError.
VariedKey read_varied(const std::string& text);

// All combinations, in folders below `out`. InputError above a thousand.
std::vector<SweepRun> combinations(const std::vector<VariedKey>& keys,
                                   const std::filesystem::path& out);

// Fills in what a run left in its folder; `exit` stays none where it did not come to its end.
void read_results(SweepRun& run);

// Does every run whose `exit` is none, `jobs` at once, each by `lapwing run` with `arguments(run)`
// in a process of its own, which ends when this one does. Once the token is cancelled no more are
// begun and those that run are ended. Runs that ended have their results read. Error where there
// can be no process.
void do_runs(std::vector<SweepRun>& runs, int jobs,
             const std::function<std::vector<std::string>(const SweepRun&)>& arguments,
             const CancellationToken& token, Progress& progress);

}  // namespace lapwing
