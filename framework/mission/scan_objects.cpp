// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/scan_objects.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/mission/run.h"

namespace lapwing {

void take_over_time_limit(const TourReport& initial, TourReport& report) {
  if (initial.status != TourStatus::time_limit || report.status != TourStatus::feasible) return;
  report.status = TourStatus::time_limit;
  report.message += "; the time limit ended the tour that it begins with";
}

std::vector<PursuitView> stops_of(const std::vector<Eigen::Vector3d>& points, const Viewpoint& from,
                                  const Viewpoint& to, const Vehicle& vehicle) {
  constexpr double kTiltShare = 0.9;  // of the gimbal's rate
  const double turn = std::remainder(to.yaw - from.yaw, 2 * EIGEN_PI);
  const double tilt_seconds = vehicle.gimbal ? std::abs(to.pitch - from.pitch) /
                                                   (kTiltShare * vehicle.gimbal->pitch_rate_max)
                                             : 0;
  const double length = path_length(points);
  std::vector<PursuitView> stops;
  double along = 0, before = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) along += (points[i] - points[i - 1]).norm();
    const double share = length > 0 ? along / length : i > 0;
    stops.push_back({i, from.yaw + share * turn, (share - before) * tilt_seconds});
    before = share;
  }
  return stops;
}

std::optional<std::size_t> ScanWork::find_motion(int a, int b) const {
  const auto& motions = graph.motions.motions;  // by a, then b
  const std::pair<int, int> wanted = std::minmax(a, b);
  const auto found = std::lower_bound(motions.begin(), motions.end(), wanted,
                                      [](const ViewMotion& m, const std::pair<int, int>& pair) {
                                        return std::pair(m.a, m.b) < pair;
                                      });
  if (found == motions.end() || std::pair(found->a, found->b) != wanted) return std::nullopt;
  return static_cast<std::size_t>(found - motions.begin());
}

std::size_t ScanWork::motion_between(int a, int b) const {
  const auto found = find_motion(a, b);
  if (!found) throw Error("a tour passes from view to view without a motion");
  return *found;
}

std::unique_ptr<FreeSpace> space_of(const Prior& prior, double mesh_room) {
  std::shared_ptr<const Map> map = prior.mapping.map;
  return free_in_both(free_space_of(map), with_room(free_space_of(prior.mesh), mesh_room));
}

std::shared_ptr<const VisibleVoxels> make_sight(ScanWork& work, const MissionRun& run,
                                                const Parameters& given,
                                                const PluginChoice& information,
                                                const Eigen::AlignedBox3d* within) {
  work.information = run.settings.registry->create<ViewInformation>(
      information.type, information.parameters, "information");
  SightSettings sight;
  sight.pinhole = pinhole_of(given.table("camera"));
  sight.range = given.number("range");
  if (given.has("usable_range")) sight.usable_range = given.number("usable_range");
  sight.usable_incidence = radians(given.number("usable_incidence_deg"));
  sight.region = region_of(given.table("region"));
  if (within) sight.within = *within;
  work.prior->mapping.map->set_threads(1);  // views are shared among threads, not their rays
  work.visible = std::make_shared<VisibleVoxels>(work.prior->mapping.map, work.prior->mesh, sight);
  const TriangleMesh& known = work.prior->mesh->mesh();
  if (std::none_of(known.vertices.begin(), known.vertices.end(),
                   [&](const Eigen::Vector3d& p) { return sight.region.contains(p); }))
    throw InputError(
        given.origin("region"),
        "the region of interest has no surface: the prior mesh does not reach into it");
  sight.across = static_cast<int>(given.integer("across"));
  work.weighed_fully = sight.across == 0 || sight.across >= sight.pinhole.width;
  if (sight.across == 0) return work.visible;
  return std::make_shared<VisibleVoxels>(work.prior->mapping.map, work.prior->mesh, sight);
}

}  // namespace lapwing
