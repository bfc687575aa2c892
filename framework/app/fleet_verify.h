// SPDX-License-Identifier: Apache-2.0
// Judging a fleet again: every plan that it names, and all of them together.
#pragma once

#include <optional>
#include <vector>

#include "framework/app/command_line.h"
#include "framework/app/provenance.h"
#include "framework/trajectory/fleet.h"

namespace lapwing {

struct JudgedFleet {
  Fleet fleet;
  std::vector<JudgedPlan> plans;  // one for each tour
  Certificate certificate;
  std::vector<std::string> not_compared = {};  // with the configuration, a phrase each
};

// The fleet document that a path names: a document, or a folder that holds fleet.json; nothing
// where it names anything else.
std::optional<std::filesystem::path> fleet_file(const std::filesystem::path& file);

// Reads and judges it. InputError where it, or a plan that it names, cannot be read.
JudgedFleet judge_fleet(const std::filesystem::path& file, const Judges& judges = {});

ExitStatus print_fleet(const std::filesystem::path& file, const JudgedFleet& judged,
                       const Invocation& invocation);

}  // namespace lapwing
