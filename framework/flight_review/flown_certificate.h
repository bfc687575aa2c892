// SPDX-License-Identifier: Apache-2.0
// The verifier's own checks of a flight that was flown, in the place of its plan.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/flight_review/flown_track.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// A check that the flight was judged by, beside what the plan's own certificate says of it.
struct FlownCheck {
  Check flown;                    // its time is that of the plan
  std::optional<double> planned;  // the plan's own worst value
  bool planned_pass = true;       // or not made
};

// What became of a view of a scan: the nearest image of the flight in time.
struct FlownView {
  std::size_t number = 0;          // in the order of the plan, from 1
  double time = 0;                 // s, of the image
  double distance = 0, angle = 0;  // m, rad
  bool taken = false;              // within the tolerances of the plan
};

struct FlownCertificate {
  std::vector<FlownCheck> checks;       // that were made, in the order of certificates
  std::vector<std::string> not_judged;  // sentences: which checks not, and why
  std::vector<FlownView> views;         // of a scan
  bool views_by_time = false;           // no image is in the log: the poses at the planned times

  // Checks that the flight fails, those first that the plan passes.
  std::vector<FlownCheck> broken() const;
  const FlownCheck* find(std::string_view name) const;
};

// `folder`, the plan's, holds the meshes and maps of its environment. What depends on inputs that a
// log does not hold (thrusts, defects of the motion, the constraints of the script) is not judged.
FlownCertificate judge_flown(const Plan& plan, const FlownTrack& flown,
                             const std::filesystem::path& folder);

}  // namespace lapwing
