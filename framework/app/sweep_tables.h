// SPDX-License-Identifier: Apache-2.0
// What a sweep comes to: tables for the terminal and for files, an object, a page.
#pragma once

#include <string>
#include <vector>

#include "framework/app/sweep_runs.h"

namespace lapwing {

// A row a run, the cost of each term, and why runs failed; at most `width` characters a line where
// words are that short.
std::string sweep_text(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs,
                       std::size_t width);
// One line of titles, one line a run; numbers with all their digits, nothing for what is not there.
std::string sweep_csv(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs);
// {"runs": [{"values", "folder", "exit", "status", "figures", "reasons", "answer"}]}
Value sweep_value(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs);
// The tables, and the paths of all runs in one picture.
std::string sweep_page(const std::string& script, const std::vector<VariedKey>& keys,
                       const std::vector<SweepRun>& runs);

}  // namespace lapwing
