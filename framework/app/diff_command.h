// SPDX-License-Identifier: Apache-2.0
// lapwing diff: what two plans have in common and in what they differ.
#pragma once

#include <filesystem>

#include "framework/app/command_options.h"

namespace lapwing {

struct PlanDifference {
  std::filesystem::path first, second;  // plan documents, or folders that hold a plan.json
  std::filesystem::path page;           // the report page to write; empty: none
};

// Exit status as of diff: done (0) where both plans say the same, not_certified (1) where they
// differ. InputError for a plan that cannot be read.
ExitStatus diff_plans(const PlanDifference& asked, const Invocation& invocation);

void add_difference(CLI::App& app, Invocation& invocation, PlanDifference& asked, Command& command);

}  // namespace lapwing
