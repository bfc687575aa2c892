// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/scan_look.h"

#include <algorithm>
#include <array>
#include <limits>

#include "framework/core/parallel.h"
#include "framework/mission/environment_space.h"
#include "framework/path/pilot_sight.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// Of the zones that forbid a place the one that leaves it least room.
LeftOutReason side_of_zone(const FlightRules& rules, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  LeftOutReason why = LeftOutReason::no_fly;
  for (const Obstacle& zone : rules.zones.obstacles) {
    const bool inside = zone.side == Side::keep_inside;
    const double room = (inside ? -1 : 1) * zone.shape->distance(p, nullptr);
    if (room >= least) continue;
    least = room;
    why = inside ? LeftOutReason::flight_zone : LeftOutReason::no_fly;
  }
  return why;
}

// Why the vehicle's box cannot be at a place.
class PlaceJudge {
 public:
  explicit PlaceJudge(const ScanWork& work)
      : work_(work),
        map_(*work.prior->mapping.map),
        known_(free_space_of(std::shared_ptr<const Map>(work.prior->mapping.map))),
        mesh_(free_space_of(work.prior->mesh)) {
    if (!work.rules->zones.obstacles.empty()) zones_ = free_space_of(work.rules->zones, {}, 0);
    if (work.rules->pilot) pilot_ = in_sight_of(work.prior->mapping.map, *work.rules->pilot);
  }

  LeftOutReason why(const Vector3d& p) const {
    const auto fits = [&](const FreeSpace& space) {
      return space.swept_box_free(p, p, work_.body);
    };
    if (meets_occupied(p) || !fits(*mesh_)) return LeftOutReason::obstacle;
    if (!fits(*known_)) return LeftOutReason::unknown;
    const Vector3d wider = work_.body + Vector3d::Constant(work_.mesh_room);
    if (!mesh_->swept_box_free(p, p, wider)) return LeftOutReason::close;
    if (zones_ && !fits(*zones_)) return side_of_zone(*work_.rules, p);
    if (pilot_ && !fits(*pilot_)) return LeftOutReason::pilot;
    return LeftOutReason::close;  // within rounding of the distance that is kept
  }

 private:
  bool meets_occupied(const Vector3d& p) const {
    const VoxelGrid& grid = map_.grid();
    // Touching is free.
    const Vector3d half = work_.body - Vector3d::Constant(1e-6 * grid.resolution());
    const Vector3d low = p - half, high = p + half;
    if (!grid.contains(low) || !grid.contains(high)) return false;
    const VoxelKey from = grid.key(low), to = grid.key(high);
    for (int x = from.x; x <= to.x; ++x)
      for (int y = from.y; y <= to.y; ++y)
        for (int z = from.z; z <= to.z; ++z) {
          const VoxelKey key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                             static_cast<std::uint16_t>(z)};
          if (map_.read(key).state == VoxelState::occupied) return true;
        }
    return false;
  }

  const ScanWork& work_;
  const Map& map_;
  std::unique_ptr<FreeSpace> known_, mesh_, zones_, pilot_;
};

// Of a candidate that no tour takes an image of.
LeftOutReason why_not_taken(const KeptTour& tour, const std::vector<int>& taken, int view) {
  const ScanWork& work = *tour.work;
  if (work.graph.score->alone(view) == 0) return LeftOutReason::nothing;
  const bool joined =
      !work.passes.empty() || taken.empty() || work.islands.joins(view, taken.front());
  if (!joined) return LeftOutReason::apart;
  const bool within = tour.reachable.empty() ||
                      std::binary_search(tour.reachable.begin(), tour.reachable.end(), view);
  return within ? LeftOutReason::not_chosen : LeftOutReason::budget;
}

// Every number that some tour takes an image of, ascending.
std::vector<int> all_images(std::span<const KeptTour> tours) {
  std::vector<int> all;
  for (const KeptTour& tour : tours) all.insert(all.end(), tour.images.begin(), tour.images.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

const char* to_string(LeftOutReason reason) {
  static constexpr std::array<const char*, kLeftOutReasons> kNames{
      "outside",   "obstacle", "unknown", "close", "no_fly", "flight_zone", "pilot",
      "forbidden", "thinned",  "nothing", "apart", "budget", "not_chosen"};
  return kNames[static_cast<std::size_t>(reason)];
}

VoxelLook look_at_voxel(std::span<const KeptTour> tours, const VoxelKey& voxel, int threads) {
  VoxelLook look;
  const VisibleVoxels& visible = *tours.front().work->visible;
  look.reading = visible.map().read(voxel);
  look.weight = visible.weight(voxel);
  std::vector<ImageOfVoxel> all;
  for (std::size_t t = 0; t < tours.size(); ++t)
    for (std::size_t k = 0; k < tours[t].images.size(); ++k) all.push_back({t, k, {}, 0});
  std::vector<char> sees(all.size(), 0);
  parallel_for(all.size(), threads, [&](std::size_t i) {
    const KeptTour& tour = tours[all[i].tour];
    const auto view = static_cast<std::size_t>(tour.images[all[i].image]);
    const auto sight =
        tour.work->visible->sight_of(tour.work->graph.candidates.viewpoints[view], voxel);
    if (!sight) return;
    sees[i] = 1;
    all[i].sight = *sight;
    all[i].told = contributions_of({{voxel, *sight}}, *tour.work->information).front();
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!sees[i]) continue;
    // Added in the tour's order, as the report does.
    look.share = std::min(1.0f, look.share + all[i].told);
    all[i].told = std::min(1.0f, all[i].told);
    look.images.push_back(all[i]);
  }
  return look;
}

LeftOut left_out_of(std::span<const KeptTour> tours, int threads) {
  const KeptTour& first = tours.front();
  const ScanWork& work = *first.work;
  const Candidates& candidates = work.graph.candidates;
  LeftOut left;
  left.beyond = candidates.lost_beyond;
  left.places.resize(candidates.lost.size());
  const PlaceJudge judge(work);
  parallel_for(candidates.lost.size(), threads, [&](std::size_t k) {
    const LostPlace& lost = candidates.lost[k];
    LeftOutReason why = LeftOutReason::outside;
    if (lost.why == PlaceLoss::blocked) why = judge.why(lost.position);
    if (lost.why == PlaceLoss::viewless) why = LeftOutReason::forbidden;
    if (lost.why == PlaceLoss::thinned) why = LeftOutReason::thinned;
    left.places[k] = {lost.position, why};
  });
  const std::vector<int> taken = all_images(tours);
  for (std::size_t view = 0; view < candidates.viewpoints.size(); ++view) {
    const int number = static_cast<int>(view);
    if (!std::binary_search(taken.begin(), taken.end(), number))
      left.places.push_back(
          {candidates.viewpoints[view].position, why_not_taken(first, taken, number)});
  }
  return left;
}

ViewLook look_from_view(const ScanWork& work, int view) {
  const auto& views = work.graph.candidates.viewpoints;
  ViewLook look;
  look.view = views.at(static_cast<std::size_t>(view));
  look.score = work.graph.score->alone(view);
  const auto& motions = work.graph.motions.motions;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const ViewMotion& motion = motions[k];
    if (motion.a != view && motion.b != view) continue;
    WayToView way{motion.a == view ? motion.b : motion.a, motion.points, work.seconds[k]};
    if (motion.b == view) std::reverse(way.points.begin(), way.points.end());
    look.ways.push_back(std::move(way));
  }
  const std::vector<SeenVoxel> seen = work.visible->seen_from(look.view);
  const std::vector<float> amounts = contributions_of(seen, *work.information);
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (amounts[k] > 0) look.told.push_back({seen[k].voxel, std::min(1.0f, amounts[k])});
  return look;
}

std::size_t bytes_of(const ScanWork& work) {
  std::size_t bytes = work.graph.score->bytes() + work.prior->mapping.map->bytes() +
                      work.graph.voxels.size() * sizeof(VoxelKey) +
                      work.graph.candidates.lost.size() * sizeof(LostPlace);
  if (work.pinned_score) bytes += work.pinned_score->bytes();
  return bytes;
}

}  // namespace lapwing
