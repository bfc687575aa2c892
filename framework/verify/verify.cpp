// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/verify.h"

#include <system_error>

#include "framework/verify/checks.h"

namespace lapwing {
namespace {

// What checks take in s, as measured on one machine; only their shares count.
constexpr double kReadByte = 6e-8;  // of a map or a mesh
constexpr double kStep = 1e-6;      // of the integrated motion, for any walk along it
constexpr double kNearStep = 1e-5;  // likewise, with distances to meshes and maps
constexpr double kFlownSecond = 1e-3;
constexpr double kRay = 5e-7;  // of a view
constexpr double kSmall = 1e-3;

double read_weight(const Plan& plan, const VerifyRequest& request) {
  double bytes = 0;
  for (const Obstacle& obstacle : plan.environment.obstacles) {
    const Value* file = obstacle.parameters.find("file");
    if (!file || !file->is_text()) continue;
    const auto found = request.elsewhere.find(file->as_text());
    std::error_code unreadable;
    const auto size = std::filesystem::file_size(
        found == request.elsewhere.end() ? request.folder / file->as_text() : found->second,
        unreadable);
    if (!unreadable) bytes += static_cast<double>(size);
  }
  return kSmall + kReadByte * bytes;
}

// A family of checks, and how many walks along the motion it takes.
struct Family {
  const char* name;
  double walks;
};
enum : std::size_t {
  kDynamics,
  kLimits,
  kClearance,
  kZones,
  kSubjects,
  kHome,
  kLoop,
  kTask,
  kCoverage
};
constexpr std::array kFamilies{Family{"dynamics", 1},         Family{"limits", 1},
                               Family{"clearance", 1},        Family{"flight zones", 1},
                               Family{"subject distance", 1}, Family{"home", 1},
                               Family{"closed loop", 0},      Family{"task", 3},
                               Family{"coverage", 0},         Family{"constraints", 1}};

// Of a plan that holds together; the document has been read.
std::vector<VerifierPart> parts_of(const Plan& plan, double steps, double read) {
  std::vector<VerifierPart> parts{{"document", read}};
  for (const Family& family : kFamilies)
    parts.push_back({family.name, kSmall + family.walks * kStep * steps});
  const auto weight = [&](std::size_t family) -> double& { return parts[1 + family].weight; };
  const bool files = std::any_of(
      plan.environment.obstacles.begin(), plan.environment.obstacles.end(),
      [](const Obstacle& obstacle) { return obstacle.parameters.find("file") != nullptr; });
  if (files) {
    weight(kClearance) += kNearStep * steps;
    if (!plan.task.framing.empty()) weight(kTask) += kNearStep * steps;
  }
  weight(kLoop) += kFlownSecond * plan.trajectory.duration();
  if (plan.task.scan)
    weight(kCoverage) += kRay * static_cast<double>(plan.task.scan->views.size()) *
                         plan.task.scan->camera.width * plan.task.scan->camera.height;
  return parts;
}

Certificate unreadable(const Plan& plan, Certificate certificate) {
  for (std::size_t i = 1; i < kCheckKinds.size(); ++i)
    certificate.checks.push_back(skipped_check(kCheckKinds[i].name, "the check 'document' failed"));
  skip_constraints(plan, "the check 'document' failed", certificate);
  return certificate;
}

}  // namespace

Certificate verify(const Plan& plan, const std::filesystem::path& folder) {
  return verify(plan, VerifyRequest{.folder = folder});
}

Certificate verify(const Plan& plan, const VerifyRequest& request) {
  Watch watch(request.cancellation, request.progress);
  Certificate certificate;
  const double read = read_weight(plan, request);
  // Nothing else is known of a plan that may not hold together: the rest is taken to be as long.
  watch.expect({{"document", read}, {"checks", read}});
  watch.begin();
  const Document document = check_document(plan, request, watch);
  certificate.checks.push_back(document.check);
  if (!document.check.pass) return unreadable(plan, std::move(certificate));
  certificate.checks.push_back(skipped_check("provenance", "the numbers do not determine it"));
  Motion motion(plan.trajectory, document.vehicle);
  watch.expect(parts_of(plan, motion.total_steps(), read));
  watch.begin();  // the document, which was read
  const auto intervals = static_cast<double>(std::max<std::size_t>(motion.intervals(), 1));
  motion.watch_by(
      [&](std::size_t interval) { watch.done(static_cast<double>(interval) / intervals); });
  const Flight flight{plan, document.vehicle, motion, document.shapes, request.controllers, watch};
  const auto next = [&](auto check) {
    watch.begin();
    check(flight, certificate);
  };
  next(check_dynamics);
  next(check_limits);
  next(check_clearance);
  next([](const Flight& whole, Certificate& judged) {
    check_flight_zones(whole, judged);
    check_pilot(whole, judged);
  });
  next(check_subject_distance);
  next(check_home);
  check_time(flight, certificate);
  watch.begin();
  const std::optional<FlownPath> flown = check_closed_loop(flight, certificate);
  watch.begin();
  check_task(flight, flown, certificate);
  next(check_views);
  check_coverage(flight, certificate);
  next(check_constraints);
  watch.end();
  return certificate;
}

}  // namespace lapwing
