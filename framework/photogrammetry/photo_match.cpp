// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/photo_match.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostPairs = 20'000'000;
constexpr double kCheaper = 1e-12;  // by which a path must be, so that rounding makes no circles

constexpr int kOffsetSteps = 10;  // offsets of height that are tried, to a distance
constexpr double kAsGood = 0.98;  // share of the best offset's votes; the least such one counts

// A view and a photograph that are near each other seen from above.
struct HeightPair {
  std::size_t view = 0, photo = 0;
  double height = 0;  // m, of the photograph above the view
};

// Of each offset (in steps of distance / kOffsetSteps), what it explains: the sum, over the views
// or the photographs, of 1 where a pair lies just there, falling to 0 at `distance` from there.
std::map<std::int64_t, double> offset_votes(const std::vector<HeightPair>& pairs,
                                            std::size_t HeightPair::*side, double distance) {
  std::map<std::size_t, std::map<std::int64_t, double>> best;  // of each of a side, by offset
  for (const HeightPair& pair : pairs) {
    const double place = pair.height / distance * kOffsetSteps;
    for (int k = -kOffsetSteps; k <= kOffsetSteps; ++k) {
      const auto offset = std::llround(place) + k;
      const double vote = 1 - std::abs(static_cast<double>(offset) - place) / kOffsetSteps;
      double& so_far = best[pair.*side][offset];
      so_far = std::max(so_far, vote);
    }
  }
  std::map<std::int64_t, double> votes;
  for (const auto& one : best)
    for (const auto& [offset, vote] : one.second) votes[offset] += vote;
  return votes;
}

struct Pair {
  int photo = 0;
  double cost = 0;
};

// Of each view, the photographs within the limits.
std::vector<std::vector<Pair>> pairs_within(const std::vector<WantedView>& views,
                                            const std::vector<TakenPhoto>& photos,
                                            const MatchLimits& limits) {
  std::vector<std::vector<Pair>> pairs(views.size());
  std::size_t count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t p = 0; p < photos.size(); ++p) {
      const double distance = (views[v].position - photos[p].position).norm();
      if (!(distance <= limits.distance)) continue;
      double cost = distance / limits.distance;
      if (photos[p].ahead) {
        const Eigen::Vector3d &a = views[v].ahead, &b = *photos[p].ahead;
        const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
        if (!(angle <= limits.angle)) continue;
        cost += angle / limits.angle;
      }
      pairs[v].push_back({static_cast<int>(p), cost});
      if (++count > kMostPairs)
        throw InputError(
            "more than 20 million pairs of views and photographs are within reach of "
            "each other: state a smaller distance");
    }
  }
  return pairs;
}

// A matching that grows by the cheapest path that leads from a view without a photograph to a
// photograph without a view, along pairs and back along those that are chosen.
class Assignment {
 public:
  Assignment(const std::vector<std::vector<Pair>>& pairs, std::size_t photos)
      : pairs_(pairs), photo_of_(pairs.size(), -1), view_of_(photos, -1) {}

  bool grow() {
    search();
    int end = -1;
    for (std::size_t p = 0; p < view_of_.size(); ++p)
      if (view_of_[p] < 0 && std::isfinite(cost_[p]) &&
          (end < 0 || cost_[p] < cost_[static_cast<std::size_t>(end)]))
        end = static_cast<int>(p);
    if (end < 0) return false;
    while (end >= 0) {
      const int view = from_[static_cast<std::size_t>(end)];
      const int before = photo_of_[static_cast<std::size_t>(view)];
      photo_of_[static_cast<std::size_t>(view)] = end;
      view_of_[static_cast<std::size_t>(end)] = view;
      end = before;
    }
    return true;
  }
  const std::vector<int>& photo_of() const { return photo_of_; }

 private:
  // Bellman and Ford with a queue of photographs whose cost fell.
  void search() {
    cost_.assign(view_of_.size(), std::numeric_limits<double>::infinity());
    from_.assign(view_of_.size(), -1);
    waits_.assign(view_of_.size(), 0);
    for (std::size_t v = 0; v < pairs_.size(); ++v)
      if (photo_of_[v] < 0) relax(v, 0);
    while (!queue_.empty()) {
      const auto p = static_cast<std::size_t>(queue_.front());
      queue_.pop_front();
      waits_[p] = 0;
      if (view_of_[p] < 0) continue;
      const auto v = static_cast<std::size_t>(view_of_[p]);
      relax(v, cost_[p] - cost_of(v, static_cast<int>(p)));
    }
  }
  void relax(std::size_t view, double spent) {
    for (const Pair& pair : pairs_[view]) {
      const auto p = static_cast<std::size_t>(pair.photo);
      if (photo_of_[view] == pair.photo || !(spent + pair.cost < cost_[p] - kCheaper)) continue;
      cost_[p] = spent + pair.cost;
      from_[p] = static_cast<int>(view);
      if (waits_[p]) continue;
      waits_[p] = 1;
      queue_.push_back(pair.photo);
    }
  }
  double cost_of(std::size_t view, int photo) const {
    for (const Pair& pair : pairs_[view])
      if (pair.photo == photo) return pair.cost;
    throw Error("a photograph is matched with a view that is not near it");
  }

  const std::vector<std::vector<Pair>>& pairs_;
  std::vector<int> photo_of_, view_of_, from_;
  std::vector<double> cost_;
  std::vector<char> waits_;
  std::deque<int> queue_;
};

}  // namespace

PhotoMatch match_photos(const std::vector<WantedView>& views, const std::vector<TakenPhoto>& photos,
                        const MatchLimits& limits) {
  if (!(limits.distance > 0) || !(limits.angle > 0))
    throw InputError(
        "the largest distance and angle between a view and its photograph must be "
        "above 0");
  const std::vector<std::vector<Pair>> pairs = pairs_within(views, photos, limits);
  Assignment assignment(pairs, photos.size());
  while (assignment.grow()) {
  }
  PhotoMatch match;
  match.photo_of_view = assignment.photo_of();
  std::vector<char> used(photos.size(), 0);
  std::size_t count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (match.photo_of_view[v] < 0) continue;
    const auto p = static_cast<std::size_t>(match.photo_of_view[v]);
    used[p] = 1;
    ++count;
    const double distance = (views[v].position - photos[p].position).norm();
    match.distance += distance * distance;
    match.farthest = std::max(match.farthest, distance);
  }
  if (count > 0) match.distance = std::sqrt(match.distance / static_cast<double>(count));
  for (std::size_t p = 0; p < photos.size(); ++p)
    if (!used[p]) match.unmatched.push_back(static_cast<int>(p));
  return match;
}

double common_height_offset(const std::vector<WantedView>& views,
                            const std::vector<TakenPhoto>& photos, double distance) {
  std::vector<HeightPair> pairs;
  for (std::size_t v = 0; v < views.size(); ++v)
    for (std::size_t p = 0; p < photos.size(); ++p) {
      const Eigen::Vector3d way = photos[p].position - views[v].position;
      if (way.head<2>().norm() <= distance) pairs.push_back({v, p, way.z()});
    }
  if (pairs.empty()) return 0;
  const auto by_view = offset_votes(pairs, &HeightPair::view, distance);
  const auto by_photo = offset_votes(pairs, &HeightPair::photo, distance);
  // One photograph is that of one view: an offset explains no more than the fewer of both.
  const auto explained = [&](const auto& vote) {
    const auto other = by_photo.find(vote.first);
    return other == by_photo.end() ? 0.0 : std::min(vote.second, other->second);
  };
  double most = 0;
  for (const auto& vote : by_view) most = std::max(most, explained(vote));
  double offset = std::numeric_limits<double>::infinity();
  for (const auto& vote : by_view) {
    const double here = static_cast<double>(vote.first) * distance / kOffsetSteps;
    if (explained(vote) >= kAsGood * most && std::abs(here) < std::abs(offset)) offset = here;
  }
  const auto nearest = [&](std::size_t HeightPair::*side) {
    std::map<std::size_t, double> found;  // the height nearest to the offset
    for (const HeightPair& pair : pairs) {
      const auto at = found.emplace(pair.*side, pair.height).first;
      if (std::abs(pair.height - offset) < std::abs(at->second - offset)) at->second = pair.height;
    }
    std::vector<double> heights;
    for (const auto& entry : found)
      if (std::abs(entry.second - offset) <= distance) heights.push_back(entry.second);
    return heights;
  };
  std::vector<double> of_views = nearest(&HeightPair::view);
  std::vector<double> of_photos = nearest(&HeightPair::photo);
  std::vector<double>& heights = of_views.size() < of_photos.size() ? of_views : of_photos;
  std::sort(heights.begin(), heights.end());
  return 0.5 * (heights[(heights.size() - 1) / 2] + heights[heights.size() / 2]);
}

}  // namespace lapwing
