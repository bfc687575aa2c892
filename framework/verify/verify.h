// SPDX-License-Identifier: Apache-2.0
// Judges a plan from its numbers alone.
//
// Nothing of the planner is used: the verifier reads the vehicle inside the plan, integrates the
// motion model itself and measures clearance itself. See README.md for the list of checks.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "framework/core/progress.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/controller.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// Never throws on a bad plan: what makes a plan unreadable (numbers that are not finite, times out
// of order, a vehicle that contradicts itself, a motion model that this version cannot integrate)
// fails the check `document`, and everything else is then skipped. The certificate inside the plan
// is not looked at. Meshes that the plan names are read from `folder`, where the plan is; one that
// is not there, or not as it was, fails `document`. Deterministic; const access only, so plans may
// be shared between threads. The check `provenance` is skipped: see provenance.h.
Certificate verify(const Plan& plan, const std::filesystem::path& folder = ".");

// What the verifier is given beside the plan.
struct VerifyRequest {
  std::filesystem::path folder = ".";  // where the plan is
  // Files of meshes and maps that whoever judges put in the place of the plan's own and that lie
  // elsewhere, by the names that the environment has for them.
  std::map<std::string, std::filesystem::path> elsewhere = {};
  const CancellationToken* cancellation = nullptr;
  // Opens the controller that a plan names, which the verifier itself may not; none: a plan that
  // names another than the thesis's is not flown, and fails where a controlled flight is required.
  ControllerSource controllers = {};
  Progress* progress = nullptr;  // told the share of all checks that is done; it never falls
};

// The same. Throws Cancelled when told to stop, and nothing else.
Certificate verify(const Plan& plan, const VerifyRequest& request);

// Why no plan of this motion could be integrated, whatever the vehicle: an unknown name without
// derivatives, columns that are not those of its name, a table that does not hold together. Empty
// where it could.
std::vector<std::string> motion_faults(const MotionRecord& motion);

}  // namespace lapwing
