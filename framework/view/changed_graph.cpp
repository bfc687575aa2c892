// SPDX-License-Identifier: Apache-2.0
#include "framework/view/changed_graph.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "framework/core/parallel.h"
#include "framework/view/graph_parts.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kColumns = 200;  // along either side of a region, in which it is compared
// An estimate comes soon: of what a region has gained, not every view tells, and not each pixel.
constexpr std::size_t kMostLooks = 160;
constexpr int kAcross = 320;

bool same_view(const Viewpoint& a, const Viewpoint& b) {
  return a.position == b.position && a.yaw == b.yaw && a.pitch == b.pitch;
}

class ChangedGraph {
 public:
  ChangedGraph(const ScanGraph& before, const InterestRegion& was, const FreeSpace& space,
               const FreeSpace* rules, const VisibleVoxels& visible,
               const ViewInformation& information, const ScanGraphSettings& settings,
               const CancellationToken* cancellation)
      : before_(before),
        was_(was),
        space_(space),
        rules_(rules),
        visible_(visible),
        information_(information),
        s_(settings),
        cancellation_(cancellation),
        now_(before.candidates.viewpoints.size(), -1) {}

  ScanGraph make(const std::vector<Viewpoint>& starts, const std::vector<Viewpoint>& pinned,
                 std::span<const int> pinned_before) {
    choose(starts, pinned, pinned_before);
    throw_if_cancelled();
    weigh();
    throw_if_cancelled();
    keep_motions();
    for (std::size_t k = 0; k < old_.size(); ++k)
      if (old_[k] < 0) join(static_cast<int>(k));
    throw_if_cancelled();
    auto& motions = made_.motions.motions;
    std::sort(motions.begin(), motions.end(), [](const ViewMotion& a, const ViewMotion& b) {
      return std::pair(a.a, a.b) < std::pair(b.a, b.b);
    });
    return std::move(made_);
  }

 private:
  void throw_if_cancelled() const {
    if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
  }

  bool keeps_rules(const Vector3d& from, const Vector3d& to) const {
    return !rules_ || rules_->swept_box_free(from, to, s_.candidates.half);
  }

  void add(const Viewpoint& view, int old) {
    if (old >= 0) now_[static_cast<std::size_t>(old)] = static_cast<int>(old_.size());
    old_.push_back(old);
    made_.candidates.viewpoints.push_back(view);
  }

  // A view that is given, with what is known of it where it was there before.
  void give(const Viewpoint& view) {
    const auto& views = before_.candidates.viewpoints;
    int old = -1;
    for (std::size_t k = 0; k < views.size() && old < 0; ++k)
      if (now_[k] < 0 && same_view(views[k], view)) old = static_cast<int>(k);
    add(view, old);
  }

  void choose(const std::vector<Viewpoint>& starts, const std::vector<Viewpoint>& pinned,
              std::span<const int> pinned_before) {
    const auto& views = before_.candidates.viewpoints;
    std::vector<char> stays(views.size());
    parallel_for(views.size(), s_.threads, [&](std::size_t k) {
      const Vector3d& p = views[k].position;
      stays[k] = !is_viewless(s_.candidates.viewless, p) && s_.candidates.allowed.contains(p) &&
                 keeps_rules(p, p);
    });
    for (const Viewpoint& view : starts) give(view);
    const auto given = static_cast<std::size_t>(before_.candidates.given);
    std::vector<char> was_pinned(views.size(), 0);
    for (const int view : pinned_before) was_pinned[static_cast<std::size_t>(view)] = 1;
    for (std::size_t k = 0; k < given; ++k)
      if (stays[k] && now_[k] < 0 && !was_pinned[k]) add(views[k], static_cast<int>(k));
    for (const Viewpoint& view : pinned) give(view);
    made_.candidates.given = static_cast<int>(old_.size());
    for (std::size_t k = given; k < views.size(); ++k)
      if (stays[k] && now_[k] < 0) add(views[k], static_cast<int>(k));
  }

  // Around what the region has gained; nothing where it has gained nothing.
  std::optional<Eigen::AlignedBox3d> gained() const {
    const InterestRegion& region = visible_.settings().region;
    if (region == was_) return std::nullopt;
    const Eigen::AlignedBox3d& bounds = region.bounds();
    const Vector3d cell = bounds.sizes() / kColumns;
    const double least = visible_.map().grid().resolution() / 2;
    Eigen::AlignedBox3d box;
    for (int y = 0; y < kColumns; ++y)
      for (int x = 0; x < kColumns; ++x) {
        const Eigen::Vector2d p =
            bounds.min().head<2>() + Eigen::Vector2d(cell.x() * (x + 0.5), cell.y() * (y + 0.5));
        const auto is = region.heights_at(p), had = was_.heights_at(p);
        if (!is) continue;
        const auto more = [&](double low, double high) {
          if (high - low < least) return;
          const Eigen::Vector2d half = cell.head<2>() / 2;
          box.extend(Vector3d(p.x() - half.x(), p.y() - half.y(), low));
          box.extend(Vector3d(p.x() + half.x(), p.y() + half.y(), high));
        };
        if (had && had->first < is->second && is->first < had->second) {
          more(is->first, had->first);
          more(had->second, is->second);
        } else {
          more(is->first, is->second);
        }
      }
    if (box.isEmpty()) return std::nullopt;
    return box;
  }

  // Whether a view may see something of a box.
  bool may_see(const Viewpoint& view, const Eigen::AlignedBox3d& box) const {
    const SightSettings& sight = visible_.settings();
    if (box.exteriorDistance(view.position) > std::min(sight.range, sight.usable_range))
      return false;
    const Vector3d towards = box.center() - view.position;
    const double radius = box.diagonal().norm() / 2, distance = towards.norm();
    if (distance <= radius) return true;
    const double half_image = std::hypot(sight.pinhole.width / sight.pinhole.focal_x,
                                         sight.pinhole.height / sight.pinhole.focal_y) /
                              2;
    const double angle = std::acos(std::clamp(towards.dot(view.direction()) / distance, -1.0, 1.0));
    return angle < std::atan(half_image) + std::asin(radius / distance);
  }

  using Row = std::vector<std::pair<VoxelKey, float>>;  // shares of voxels that a view tells of

  Row look(const VisibleVoxels& visible, const Viewpoint& view, bool new_voxels) const {
    const std::vector<SeenVoxel> seen = visible.seen_from(view);
    const std::vector<float> amounts = contributions_of(seen, information_);
    Row row;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (amounts[i] > 0 &&
          !(new_voxels && was_.contains(visible.map().grid().center(seen[i].voxel))))
        row.emplace_back(seen[i].voxel, std::min(amounts[i], 1.0f));
    return row;
  }

  // What only a look tells: all of new views, and what the region has gained of some others.
  std::vector<Row> looks() const {
    const auto& views = made_.candidates.viewpoints;
    std::vector<Row> rows(views.size());
    const auto box = gained();
    std::vector<std::size_t> looked;
    std::optional<VisibleVoxels> part;
    if (box) {
      SightSettings sight = visible_.settings();
      sight.within = *box;
      if (sight.across == 0 || sight.across > kAcross)
        sight.across = std::min(kAcross, sight.pinhole.width);
      part.emplace(visible_.shared_map(), visible_.prior(), sight);
      for (std::size_t k = 0; k < views.size(); ++k)
        if (old_[k] >= 0 && may_see(views[k], *box)) looked.push_back(k);
      const std::size_t all = looked.size();
      for (std::size_t k = 0; all > kMostLooks && k < kMostLooks; ++k)
        looked[k] = looked[k * all / kMostLooks];
      looked.resize(std::min(all, kMostLooks));
    }
    parallel_for(looked.size(), s_.threads, [&](std::size_t k) {
      if (cancellation_ && cancellation_->cancelled()) return;
      rows[looked[k]] = look(*part, views[looked[k]], true);
    });
    parallel_for(views.size(), s_.threads, [&](std::size_t k) {
      if (old_[k] < 0) rows[k] = look(visible_, views[k], false);
    });
    return rows;
  }

  void weigh() {
    const InterestRegion& region = visible_.settings().region;
    const std::vector<Row> rows = looks();
    throw_if_cancelled();
    VoxelNumbers numbers(region.bounds(), visible_.map().grid());
    ViewScoreBuilder builder = ViewScoreBuilder::growing(region.largest_weight());
    const ViewScore& score = *before_.score;
    const auto capacities = score.capacities();
    std::vector<float> weights(before_.voxels.size());
    for (std::size_t v = 0; v < weights.size(); ++v)
      weights[v] = static_cast<float>(visible_.weight(before_.voxels[v]));
    std::vector<ViewScore::Contribution> contributions;
    const auto tell = [&](const VoxelKey& voxel, float weight, float share) {
      const std::size_t count = numbers.count();
      contributions.push_back({numbers.number(voxel), weight * share});
      if (numbers.count() > count) builder.add_voxel(weight);
    };
    for (std::size_t k = 0; k < rows.size(); ++k) {
      contributions.clear();
      if (old_[k] >= 0) {
        const auto voxels = score.voxels_of(old_[k]);
        const auto amounts = score.amounts_of(old_[k]);
        for (std::size_t i = 0; i < voxels.size(); ++i)
          if (const float weight = weights[voxels[i]]; weight > 0)
            tell(before_.voxels[voxels[i]], weight,
                 static_cast<float>(amounts[i]) / static_cast<float>(capacities[voxels[i]]));
      }
      for (const auto& [voxel, share] : rows[k])
        tell(voxel, static_cast<float>(visible_.weight(voxel)), share);
      builder.add_view(contributions);
    }
    made_.voxels = numbers.take();
    if (made_.voxels.empty()) throw NothingSeen("no view of the plan before sees the region");
    made_.score = std::make_shared<const ViewScore>(std::move(builder).take());
  }

  // Map and mesh are as they were.
  bool free(const std::vector<Vector3d>& points) const {
    for (std::size_t i = 1; i < points.size(); ++i)
      if (!keeps_rules(points[i - 1], points[i])) return false;
    return true;
  }

  void keep_motions() {
    const auto& motions = before_.motions.motions;
    const auto now = [&](int view) { return now_[static_cast<std::size_t>(view)]; };
    std::vector<char> stays(motions.size(), 0);
    parallel_for(motions.size(), s_.threads, [&](std::size_t k) {
      if (cancellation_ && cancellation_->cancelled()) return;
      stays[k] = now(motions[k].a) >= 0 && now(motions[k].b) >= 0 && free(motions[k].points);
    });
    for (std::size_t k = 0; k < motions.size(); ++k) {
      if (!stays[k]) continue;
      ViewMotion motion = motions[k];
      motion.a = now(motion.a), motion.b = now(motion.b);
      if (motion.a > motion.b) {
        std::swap(motion.a, motion.b);
        std::reverse(motion.points.begin(), motion.points.end());
      }
      made_.motions.motions.push_back(std::move(motion));
    }
  }

  // Motions of a new view: to the nearest whose images match its own.
  void join(int view) {
    const auto& views = made_.candidates.viewpoints;
    const Viewpoint& own = views[static_cast<std::size_t>(view)];
    std::vector<std::pair<double, int>> near;
    for (std::size_t k = 0; k < views.size(); ++k)
      if (static_cast<int>(k) != view && (old_[k] >= 0 || static_cast<int>(k) < view))
        near.emplace_back((views[k].position - own.position).norm(), static_cast<int>(k));
    const auto most = std::min(near.size(), static_cast<std::size_t>(s_.motions.among));
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(most), near.end());
    const int level = coarse_level(visible_, s_.coarse_across);
    std::vector<std::vector<VoxelKey>> seen(most + 1);
    if (s_.motions.alpha > 0)
      parallel_for(most + 1, s_.threads, [&](std::size_t k) {
        const int of = k == most ? view : near[k].second;
        seen[k] =
            coarse_cubes(visible_, views[static_cast<std::size_t>(of)], s_.coarse_across, level);
      });
    MotionSettings one = s_.motions;
    one.neighbours = one.among = 1;
    int joined = 0;
    for (std::size_t k = 0; k < most && joined < s_.motions.neighbours; ++k) {
      throw_if_cancelled();
      const int other = near[k].second;
      const int a = std::min(view, other), b = std::max(view, other);
      const auto seen_by = [&](int of) { return of == view ? seen[most] : seen[k]; };
      const MotionGraph found = find_motions(
          space_, {views[static_cast<std::size_t>(a)], views[static_cast<std::size_t>(b)]},
          {seen_by(a), seen_by(b)}, one, s_.seed + k, 1, cancellation_);
      if (found.motions.empty()) continue;
      ViewMotion motion = found.motions.front();
      motion.a = a, motion.b = b;
      made_.motions.motions.push_back(std::move(motion));
      ++joined;
    }
  }

  const ScanGraph& before_;
  const InterestRegion& was_;
  const FreeSpace& space_;
  const FreeSpace* rules_;
  const VisibleVoxels& visible_;
  const ViewInformation& information_;
  const ScanGraphSettings& s_;
  const CancellationToken* cancellation_;
  std::vector<int> now_;  // per view of before: its number, or -1
  std::vector<int> old_;  // per view: its number before, or -1
  ScanGraph made_;
};

}  // namespace

ScanGraph changed_graph(const ScanGraph& before, const InterestRegion& was,
                        std::span<const int> pinned_before, const FreeSpace& space,
                        const FreeSpace* rules, const VisibleVoxels& visible,
                        const ViewInformation& information, const std::vector<Viewpoint>& starts,
                        const std::vector<Viewpoint>& pinned, const ScanGraphSettings& settings,
                        const CancellationToken* cancellation) {
  return ChangedGraph(before, was, space, rules, visible, information, settings, cancellation)
      .make(starts, pinned, pinned_before);
}

}  // namespace lapwing
