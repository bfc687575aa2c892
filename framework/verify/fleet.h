// SPDX-License-Identifier: Apache-2.0
// Judges the plans of a fleet together: what the certificate of one plan cannot say.
//
// fleet_document  contradictions of the fleet document, and between its plans; what was changed in
//                 it after writing; a file that is not the plan named
// provenance      where the fleet asks for less than the configuration of its plans
// tours           tours whose own certificate fails
// sequence        s, least time between two tours of one drone: at least the swap
// homes           m, between the places where the tours of one drone begin and end
// reserve         s, least flight that is left of a battery
// separation      m, least distance between two drones at equal times, along continuous paths
// fleet_coverage  voxels that the views of all tours see, as a share of the stated number
#pragma once

#include <span>
#include <string>

#include "framework/trajectory/fleet.h"
#include "framework/trajectory/plan_digest.h"
#include "framework/verify/verify.h"

namespace lapwing {

// One per tour of the fleet, in its order.
struct FleetMember {
  const Plan* plan = nullptr;
  const Certificate* certificate = nullptr;  // of that plan
  std::string sha256;                        // of the bytes of its file
};

// Never throws on a bad fleet, as verify does. Where `fleet_document` fails, or the document of a
// plan, everything else is skipped. Half a swap before and after a tour its drone may be anywhere
// on the vertical line below the tour's first and last place. Maps are read from the folder of the
// request. `digest`: what the document's own digest says; null for one that was not written yet.
// `faults`: where the fleet asks for less than its configuration, a sentence each.
// Throws Cancelled when told to stop, and nothing else.
Certificate verify_fleet(const Fleet& fleet, std::span<const FleetMember> members,
                         const DigestFindings* digest, const VerifyRequest& request,
                         std::span<const std::string> faults = {});

}  // namespace lapwing
