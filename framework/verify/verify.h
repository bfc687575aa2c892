// Judges a plan from its numbers alone.
//
// Nothing of the planner is used: the verifier reads the vehicle inside the plan, integrates the
// motion model itself and measures clearance itself. See README.md for the list of checks.
#pragma once

#include <filesystem>

#include "framework/trajectory/plan.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// Never throws on a bad plan: what makes a plan unreadable (numbers that are not finite, times out
// of order, a vehicle that contradicts itself, a motion model that this version cannot integrate)
// fails the check `document`, and everything else is then skipped. The certificate inside the plan
// is not looked at. Meshes that the plan names are read from `folder`, where the plan is; one that
// is not there, or not as it was, fails `document`. Deterministic; const access only, so plans may
// be shared between threads. The check `provenance` is skipped: see provenance.h.
Certificate verify(const Plan& plan, const std::filesystem::path& folder = ".");

}  // namespace lapwing
