// SPDX-License-Identifier: Apache-2.0
// The runs of a sweep: which there are, the processes that do them, and what they left behind.
#pragma once

#include <filesystem>
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

// Whether a run came to its end, by a plan or a refusal, and it is known what it read; `run` then
// has its results. A run that a defect ended or that was interrupted is done again, and so is one
// of which it is not known what it read. InputError where what it read has changed since, or it was
// made by another version or on another machine (`mark`, items/statement.h).
bool has_run(SweepRun& run, const Value& mark);

// Does one run by `lapwing run` with these words, in a process of its own, which ends when this
// thread does. What an earlier run left in the folder is removed first. Once the token is cancelled
// the run is asked to end, then ended, and Cancelled is thrown. A run that a signal ended has no
// result. Error where there can be no process.
void do_run(const SweepRun& run, const std::vector<std::string>& words, const Value& mark,
            const CancellationToken& token);

}  // namespace lapwing
