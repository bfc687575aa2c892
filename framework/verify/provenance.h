// SPDX-License-Identifier: Apache-2.0
// Whose limits, obstacles and task a certificate is about. The numbers of a plan do not tell; who
// knows the vehicle's file and the plan's configuration states it here.
#pragma once

#include <string>
#include <vector>

#include "framework/verify/certificate.h"

namespace lapwing {

struct Provenance {
  std::string summary;              // "vehicle 'vehicles/solo' as in configs/...; 2 spheres; ..."
  std::vector<std::string> faults;  // what of the plan is not as its sources say
};

// Fills the check `provenance`, which `verify` leaves skipped: it passes where there is no fault.
// A certificate whose `document` failed keeps it skipped. Throws Error where there is no such
// check.
void state_provenance(const Provenance& provenance, Certificate& certificate);

// Limits, tolerances and verdicts that a plan's stored certificate has otherwise than `now`, a
// sentence each; empty where the plan has none or it cannot be read.
std::vector<std::string> changes_since(const Value& stored, const Certificate& now);

}  // namespace lapwing
