// SPDX-License-Identifier: Apache-2.0
// What a run simulates beside its certificate, where a plan has something for it: a photograph of a
// plan with lights, a game of a plan with players.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/progress.h"
#include "framework/export/report.h"
#include "framework/mission/mission.h"
#include "framework/verify/certificate.h"

namespace lapwing {

struct RunAddition {
  std::vector<Section> sections;  // of the report, before those of every flight
  std::string key;                // of `figures` in the answer of --json; "": none
  Value figures;
  std::string summary;                       // printed as it stands, or ""
  std::string failure;                       // why it came to nothing, a sentence; or ""
  std::optional<std::string> long_exposure;  // a PNG file
};

// Of all that apply, in the order of the report. Whatever comes of one of them, the plan stays:
// what is thrown in a simulation of players becomes a `failure`.
std::vector<RunAddition> run_additions(const MissionResult& result, const Certificate& certificate,
                                       const CancellationToken& token);

}  // namespace lapwing
