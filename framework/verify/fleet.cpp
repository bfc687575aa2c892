// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/fleet.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "framework/trajectory/plan_sections.h"
#include "framework/verify/checks.h"
#include "framework/verify/drone_distance.h"
#include "framework/verify/seen_voxels.h"

namespace lapwing {
namespace {

constexpr double kSameHome = 0.1;             // m, between places that are one
constexpr double kTimeRounding = 1e-6;        // s
constexpr double kSeparationRounding = 1e-3;  // m
constexpr std::size_t kProblemsListed = 5;

constexpr CheckKind kFleetCheckKinds[] = {{"fleet_document", CheckGroup::safety, true, ""},
                                          {"provenance", CheckGroup::safety, true, ""},
                                          {"tours", CheckGroup::safety, true, ""},
                                          {"sequence", CheckGroup::safety, true, "s"},
                                          {"homes", CheckGroup::safety, true, "m"},
                                          {"reserve", CheckGroup::safety, true, "s"},
                                          {"separation", CheckGroup::safety, true, "m"},
                                          {"fleet_coverage", CheckGroup::task, true, ""}};

Check fleet_check(std::string_view name) {
  Check check;
  for (const CheckKind& kind : kFleetCheckKinds) {
    if (name != kind.name) continue;
    check.name = kind.name;
    check.group = kind.group;
    check.required = kind.required;
    check.unit = kind.unit;
  }
  return check;
}

// Passes where there are none; else lists the first of them.
Check check_of_problems(std::string_view name, std::span<const std::string> problems) {
  Check check = judged(fleet_check(name), static_cast<double>(problems.size()), 0, 0, 0);
  for (std::size_t i = 0; i < std::min(problems.size(), kProblemsListed); ++i)
    check.detail += (i ? "; " : "") + problems[i];
  if (problems.size() > kProblemsListed)
    check.detail += "; and " + std::to_string(problems.size() - kProblemsListed) + " more";
  return check;
}

void skip_check(std::string_view name, std::string reason, Certificate& certificate) {
  Check check = fleet_check(name);
  check.skipped = std::move(reason);
  certificate.checks.push_back(std::move(check));
}

// The map in which the views of a plan see, as the plan names it; empty where there is none.
std::string map_digest(const Plan& plan) {
  const Obstacle* map =
      plan.task.scan ? find_obstacle(plan.environment, "map", plan.task.scan->map) : nullptr;
  const Value* stated = map ? map->parameters.find("sha256") : nullptr;
  return stated && stated->is_text() ? stated->as_text() : "";
}

bool same_region(const ScanTask& a, const ScanTask& b) {
  return a.region == b.region && a.range == b.range && a.camera.width == b.camera.width &&
         a.camera.height == b.camera.height && a.camera.focal_x == b.camera.focal_x &&
         a.camera.focal_y == b.camera.focal_y && a.camera.principal_x == b.camera.principal_x &&
         a.camera.principal_y == b.camera.principal_y;
}

class FleetReader {
 public:
  FleetReader(const Fleet& fleet, std::span<const FleetMember> members,
              const DigestFindings* digest)
      : fleet_(fleet), members_(members), digest_(digest) {}

  Check read() {
    if (digest_) changes();
    numbers();
    if (fleet_.tours.empty()) add("there is no tour");
    if (fleet_.tours.size() > Fleet::kMostTours) add("there are more than 1000 tours");
    if (members_.size() != fleet_.tours.size()) add("plans are missing");
    if (problems_.empty())
      for (std::size_t t = 0; t < fleet_.tours.size(); ++t) tour(t);
    if (problems_.empty()) seen();
    return check_of_problems("fleet_document", problems_);
  }

 private:
  void add(std::string problem) { problems_.push_back(std::move(problem)); }

  void changes() {
    if (!digest_->stated) return add("the document states no digest: changes cannot be detected");
    std::string changed;
    for (const std::string& section : digest_->changed)
      changed += (changed.empty() ? "" : ", ") + section;
    if (!changed.empty()) add("the document was changed after writing: " + changed);
  }

  // All tours together see at least what one of them sees, and at most what they see one by one.
  void seen() {
    std::int64_t most = 0;
    double sum = 0;
    for (const FleetMember& member : members_) {
      most = std::max(most, member.plan->task.scan->seen);
      sum += static_cast<double>(member.plan->task.scan->seen);
    }
    if (fleet_.seen < most || static_cast<double>(fleet_.seen) > sum)
      add("the number of seen voxels, " + std::to_string(fleet_.seen) +
          ", contradicts those of the plans");
  }

  void numbers() {
    const auto least = [&](const char* name, double number) {
      if (!(number >= 0) || !sound(number))
        add(std::string(name) + " must be at least 0 and at most 1e7");
    };
    least("separation", fleet_.separation);
    least("swap", fleet_.swap);
    least("reserve", fleet_.reserve);
    if (fleet_.seen < 1) add("the number of seen voxels must be at least 1");
    if (!(fleet_.seen_share > 0 && fleet_.seen_share <= 1))
      add("seen_share must be above 0 and at most 1");
  }

  void tour(std::size_t t) {
    const FleetTour& tour = fleet_.tours[t];
    const FleetMember& member = members_[t];
    const std::string name = name_of_tour(tour);
    if (!sound(tour.start) || tour.start < 0) add(name + " must start at 0 s or later");
    if (!names_.insert(name).second) add(name + " is listed twice");
    if (!files_.insert(tour.file).second) add("'" + tour.file + "' is flown twice");
    if (member.sha256 != tour.sha256)
      add("'" + tour.file + "' is not the file that the fleet names: its SHA-256 differs");
    const Check* document = member.certificate->find("document");
    if (!document || !document->pass) return add("the document of " + name + " does not hold");
    const Plan& first = *members_.front().plan;
    if (!member.plan->task.scan || !first.task.scan) return add(name + " is no scan");
    if (!same_region(*member.plan->task.scan, *first.task.scan) ||
        map_digest(*member.plan) != map_digest(first))
      add(name + " has another region, camera or map than the first tour");
    if (environment_to_value(member.plan->environment) != environment_to_value(first.environment))
      add(name + " keeps another margin, or other obstacles, zones or pilots, than the first tour");
    if (member.plan->geodetic_origin != first.geodetic_origin)
      add(name + " has another origin on the earth than the first tour");
    if (member.plan->home != first.home) add(name + " has another home than the first tour");
    // A drone has one vehicle, whichever battery is in it.
    const Value& vehicle = vehicles_.emplace(tour.drone, member.plan->vehicle).first->second;
    if (vehicle != member.plan->vehicle)
      add(name + " has another vehicle than the other tours of its drone");
  }

  const Fleet& fleet_;
  std::span<const FleetMember> members_;
  const DigestFindings* digest_;
  std::set<std::string> names_, files_;
  std::map<std::string, Value> vehicles_;  // of each drone
  std::vector<std::string> problems_;
};

// The plans as they are flown.
struct FlownFleet {
  const Fleet& fleet;
  std::span<const FleetMember> members;
  std::vector<Vehicle> vehicles;
  std::vector<TimedPath> paths;

  double end(std::size_t t) const {
    return fleet.tours[t].start + members[t].plan->trajectory.duration();
  }
  std::string names(std::size_t a, std::size_t b) const {
    return name_of_tour(fleet.tours[a]) + " and " + name_of_tour(fleet.tours[b]);
  }
};

void check_tours(const FlownFleet& flown, Certificate& certificate) {
  int failed = 0;
  std::string which;
  for (std::size_t t = 0; t < flown.members.size(); ++t) {
    if (flown.members[t].certificate->feasible()) continue;
    ++failed;
    const auto failures = flown.members[t].certificate->failures();
    which += (which.empty() ? "" : "; ") + name_of_tour(flown.fleet.tours[t]) +
             (failures.empty() ? "" : ": " + to_line(failures.front()));
  }
  Check check = judged(fleet_check("tours"), failed, 0, 0, 0);
  check.detail = which;
  certificate.checks.push_back(check);
}

// Pairs of tours of one drone, one after the other by their batteries.
std::vector<std::pair<std::size_t, std::size_t>> successions(const Fleet& fleet) {
  std::map<std::string, std::map<int, std::size_t>> by_drone;
  for (std::size_t t = 0; t < fleet.tours.size(); ++t)
    by_drone[fleet.tours[t].drone][fleet.tours[t].battery] = t;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [drone, tours] : by_drone)
    for (auto tour = tours.begin(); std::next(tour) != tours.end(); ++tour)
      pairs.emplace_back(tour->second, std::next(tour)->second);
  return pairs;
}

void check_sequence(const FlownFleet& flown, Certificate& certificate) {
  const auto pairs = successions(flown.fleet);
  if (pairs.empty()) return skip_check("sequence", "every drone flies one tour", certificate);
  double least = std::numeric_limits<double>::infinity(), at = 0;
  std::string which;
  for (const auto& [a, b] : pairs) {
    const double between = flown.fleet.tours[b].start - flown.end(a);
    if (between >= least) continue;
    least = between;
    at = flown.end(a);
    which = flown.names(a, b);
  }
  Check check = judged(fleet_check("sequence"), least, flown.fleet.swap, kTimeRounding, at, true);
  check.detail = which;
  certificate.checks.push_back(check);
}

void check_homes(const FlownFleet& flown, Certificate& certificate) {
  double farthest = 0, at = 0;
  std::string which;
  const auto see = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, double time,
                       std::string names) {
    if ((a - b).norm() < farthest || (!which.empty() && (a - b).norm() == farthest)) return;
    farthest = (a - b).norm();
    at = time;
    which = std::move(names);
  };
  for (std::size_t t = 0; t < flown.paths.size(); ++t)
    see(flown.paths[t].places.front(), flown.paths[t].places.back(), flown.end(t),
        name_of_tour(flown.fleet.tours[t]));
  for (const auto& [a, b] : successions(flown.fleet))
    see(flown.paths[a].places.back(), flown.paths[b].places.front(), flown.fleet.tours[b].start,
        flown.names(a, b));
  Check check = judged(fleet_check("homes"), farthest, kSameHome, 0, at);
  check.detail = which;
  certificate.checks.push_back(check);
}

void check_reserve(const FlownFleet& flown, Certificate& certificate) {
  double least = std::numeric_limits<double>::infinity(), at = 0;
  std::string which;
  for (std::size_t t = 0; t < flown.members.size(); ++t) {
    const double left =
        flown.vehicles[t].flight_time - flown.members[t].plan->trajectory.duration();
    if (left >= least) continue;
    least = left;
    at = flown.end(t);
    which = name_of_tour(flown.fleet.tours[t]);
  }
  Check check = judged(fleet_check("reserve"), least, flown.fleet.reserve,
                       tolerance_of(flown.vehicles.front().flight_time), at, true);
  check.detail = which;
  certificate.checks.push_back(check);
}

void check_separation(const FlownFleet& flown, const VerifyRequest& request,
                      Certificate& certificate) {
  Approach nearest{std::numeric_limits<double>::infinity(), 0};
  std::string which;
  for (std::size_t a = 0; a < flown.paths.size(); ++a)
    for (std::size_t b = a + 1; b < flown.paths.size(); ++b) {
      if (flown.paths[a].drone == flown.paths[b].drone) continue;
      if (request.cancellation && request.cancellation->cancelled()) throw Cancelled();
      const Approach found = nearest_approach(flown.paths[a], flown.paths[b]);
      if (!(found.distance < nearest.distance)) continue;
      nearest = found;
      which = flown.names(a, b);
    }
  if (which.empty())
    return skip_check("separation", "no two drones fly at the same time", certificate);
  Check check = judged(fleet_check("separation"), nearest.distance, flown.fleet.separation,
                       kSeparationRounding, nearest.time, true);
  check.detail = which;
  certificate.checks.push_back(check);
}

// The map in which all views see, held as far as the rays of any of them go. Throws what reading it
// throws; null where the first plan names none.
std::unique_ptr<JudgedShape> map_of_fleet(const FlownFleet& flown,
                                          const std::vector<PlannedView>& views,
                                          const VerifyRequest& request) {
  const Plan& first = *flown.members.front().plan;
  const Obstacle* map = find_obstacle(first.environment, "map", first.task.scan->map);
  const Value* file = map ? map->parameters.find("file") : nullptr;
  if (!file || !file->is_text()) return nullptr;
  Eigen::AlignedBox3d box = first.task.scan->region.bounds();
  for (const PlannedView& view : views) box.extend(view.position);
  const auto found = request.elsewhere.find(file->as_text());
  return judged_shape(
      *map, found == request.elsewhere.end() ? request.folder / file->as_text() : found->second,
      box);
}

void check_fleet_coverage(const FlownFleet& flown, const VerifyRequest& request,
                          Certificate& certificate) {
  const Fleet& fleet = flown.fleet;
  Check check = fleet_check("fleet_coverage");
  std::vector<PlannedView> views;
  for (const FleetMember& member : flown.members)
    views.insert(views.end(), member.plan->task.scan->views.begin(),
                 member.plan->task.scan->views.end());
  double share = std::numeric_limits<double>::quiet_NaN();
  std::string detail = "the map of the first tour cannot be read";
  try {
    const auto map = map_of_fleet(flown, views, request);
    if (map && map->voxels()) {
      const std::int64_t count =
          count_seen(*map->voxels(), *flown.members.front().plan->task.scan, views, [&](double) {
            if (request.cancellation && request.cancellation->cancelled()) throw Cancelled();
          });
      share = static_cast<double>(count) / static_cast<double>(fleet.seen);
      detail = std::to_string(count) + " of the " + std::to_string(fleet.seen) +
               " voxels that the fleet states as seen by the views of all tours";
    }
  } catch (const InputError& error) {
    detail += std::string(": ") + error.what();
  }
  check = judged(check, share, fleet.seen_share, 0, 0, true);
  check.detail = detail;
  certificate.checks.push_back(check);
}

}  // namespace

Certificate verify_fleet(const Fleet& fleet, std::span<const FleetMember> members,
                         const DigestFindings* digest, const VerifyRequest& request,
                         std::span<const std::string> faults) {
  Certificate certificate;
  certificate.checks.push_back(FleetReader(fleet, members, digest).read());
  if (!certificate.checks.front().pass) {
    for (const CheckKind& kind : kFleetCheckKinds)
      if (kind.name != std::string_view("fleet_document"))
        skip_check(kind.name, "the check 'fleet_document' failed", certificate);
    return certificate;
  }
  certificate.checks.push_back(check_of_problems("provenance", faults));
  FlownFleet flown{fleet, members, {}, {}};
  for (std::size_t t = 0; t < members.size(); ++t) {
    flown.vehicles.push_back(vehicle_from_value(members[t].plan->vehicle));
    Motion motion(members[t].plan->trajectory, flown.vehicles.back());
    flown.paths.push_back(
        timed_path(motion, fleet.tours[t].drone, fleet.tours[t].start, fleet.swap / 2));
  }
  check_tours(flown, certificate);
  check_sequence(flown, certificate);
  check_homes(flown, certificate);
  check_reserve(flown, certificate);
  check_separation(flown, request, certificate);
  check_fleet_coverage(flown, request, certificate);
  return certificate;
}

}  // namespace lapwing
