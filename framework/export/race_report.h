// SPDX-License-Identifier: Apache-2.0
// The report page of a race that was flown by hand in simulation.
#pragma once

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/race_score.h"

namespace lapwing {

// The place in `pilots` of who wins: the lowest score of those who finished; -1 for nobody.
int winner_of(const std::vector<RacedPilot>& pilots);

// {"winner", "pilots": [{"name", "end", "time", "deviation_mean", ..., "score"}]}
Value to_value(const std::vector<RacedPilot>& pilots);

// One line for every pilot and one for who wins; "" without pilots.
std::string race_result(const std::vector<RacedPilot>& pilots);

Report race_report(const Plan& plan, const std::vector<RacedPilot>& pilots,
                   const RaceRules& rules = {});

// The blocks of it, to add to another report.
std::vector<Section> race_sections(const Plan& plan, const std::vector<RacedPilot>& pilots,
                                   const RaceRules& rules);

}  // namespace lapwing
