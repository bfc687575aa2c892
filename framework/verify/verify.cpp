#include "framework/verify/verify.h"

#include "framework/verify/checks.h"

namespace lapwing {

Certificate verify(const Plan& plan, const std::filesystem::path& folder) {
  Certificate certificate;
  const Document document = check_document(plan, folder);
  certificate.checks.push_back(document.check);
  if (!document.check.pass) {
    for (std::size_t i = 1; i < kCheckKinds.size(); ++i) {
      certificate.checks.push_back(
          skipped_check(kCheckKinds[i].name, "the check 'document' failed"));
    }
    skip_constraints(plan, "the check 'document' failed", certificate);
    return certificate;
  }
  certificate.checks.push_back(skipped_check("provenance", "the numbers alone do not tell"));
  Motion motion(plan.trajectory, document.vehicle);
  const Flight flight{plan, document.vehicle, motion, document.meshes, document.maps};
  check_dynamics(flight, certificate);
  check_limits(flight, certificate);
  check_clearance(flight, certificate);
  check_flight_zones(flight, certificate);
  check_subject_distance(flight, certificate);
  check_time(flight, certificate);
  const std::optional<FlownPath> flown = check_closed_loop(flight, certificate);
  check_task(flight, flown, certificate);
  check_constraints(flight, certificate);
  return certificate;
}

}  // namespace lapwing
