// SPDX-License-Identifier: Apache-2.0
#include "framework/app/configured_fleet.h"

#include <set>

#include "framework/app/stated_values.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

void compare_count(const std::string& what, std::size_t here, std::optional<double> asked,
                   ConfigurationComparison& found) {
  if (asked && static_cast<double>(here) > *asked)
    found.faults.push_back("the number of " + what + " is " + std::to_string(here) +
                           " in the fleet and " + plain_number(*asked) + " in its configuration");
}

}  // namespace

ConfigurationComparison compare_fleet(const Fleet& fleet, std::span<const Plan* const> plans) {
  ConfigurationComparison found;
  if (plans.empty()) return found;
  const Value& asked = plans.front()->configuration;
  for (std::size_t t = 1; t < plans.size(); ++t)
    if (plans[t]->configuration != asked)
      found.faults.push_back(name_of_tour(fleet.tours[t]) +
                             " has another configuration than the first tour");
  const Value* stated = asked.is_map() ? asked.find("fleet") : nullptr;
  if (!stated || !stated->is_map()) {
    found.not_compared.emplace_back(
        "separation, swap and reserve: the plans state no configuration of a fleet");
    return found;
  }
  const auto compare = [&](const char* what, double here, std::optional<double> limit,
                           const char* unit) {
    compare_number(what, here, limit, unit, Than::below, found);
  };
  // Between planned places: each drone may be elsewhere by the accuracy of its position.
  auto separation = stated_number(*stated, "separation");
  if (separation && *separation > 0)
    *separation += 2 * stated_number(asked, "gps_accuracy").value_or(0);
  compare("the separation", fleet.separation, separation, " m");
  compare("the swap", fleet.swap, stated_number(*stated, "swap"), " s");
  compare("the reserve", fleet.reserve, stated_number(*stated, "reserve"), " s");
  compare("the share that must be seen again", fleet.seen_share, ScanTask().seen_share, "");
  std::set<std::string> drones;
  for (const FleetTour& tour : fleet.tours) drones.insert(tour.drone);
  compare_count("drones", drones.size(), stated_number(asked, "drones"), found);
  const auto batteries = stated_number(asked, "batteries");
  // An accuracy takes as many batteries as it needs where no other number is stated.
  if (stated_number(asked, "accuracy") && batteries == 1)
    found.not_compared.emplace_back("the number of batteries: the accuracy decides it");
  else
    compare_count("batteries", fleet.tours.size(), batteries, found);
  return found;
}

}  // namespace lapwing
