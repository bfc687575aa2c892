// SPDX-License-Identifier: Apache-2.0
// How find_passage leaves the passages of failed ways: the first try plans in the true space. Each
// further try closes a ball about the narrowest place of every failed way, larger each time but
// never over an end, and takes another seed. A path found there is compared with the failed ways in
// the true space (same_passage) and returned if it differs from all of them.
//
// How grow_corridor makes boxes: each straight piece of the way is halved until the bounding box of
// a part is free. That box grows face by face, by 1 m and then by halved steps, until every face is
// stopped. A part that the box before contains gets no box of its own.
#include "framework/path/passages.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

using Eigen::Vector3d;

double length_of(std::span<const Vector3d> way) {
  return path_length({way.begin(), way.end()});
}

// The largest cube about a place that is free, found by halving.
double room_at(const FreeSpace& space, const Vector3d& p) {
  constexpr double kMost = 20, kAccuracy = 0.01;  // m
  if (space.swept_box_free(p, p, Vector3d::Constant(kMost))) return kMost;
  double low = 0, high = kMost;
  while (high - low > std::max(kAccuracy, 0.02 * low)) {
    const double middle = (low + high) / 2;
    (space.swept_box_free(p, p, Vector3d::Constant(middle)) ? low : high) = middle;
  }
  return low;
}

// A space with balls that are closed.
class StoppedUp final : public FreeSpace {
 public:
  struct Ball {
    Vector3d center;
    double radius;
  };
  StoppedUp(const FreeSpace& space, std::vector<Ball> balls)
      : space_(space), balls_(std::move(balls)) {}

  bool point_free(const Vector3d& p) const override {
    return open(p, p, 0) && space_.point_free(p);
  }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    return open(from, to, 0) && space_.segment_free(from, to);
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to,
                      const Vector3d& half) const override {
    return open(from, to, half.norm()) && space_.swept_box_free(from, to, half);
  }
  Eigen::AlignedBox3d bounds() const override { return space_.bounds(); }

 private:
  bool open(const Vector3d& from, const Vector3d& to, double grown) const {
    const Vector3d way = to - from;
    for (const Ball& ball : balls_) {
      const double squared = way.squaredNorm();
      const double share =
          squared > 0 ? std::clamp((ball.center - from).dot(way) / squared, 0.0, 1.0) : 0.0;
      if ((ball.center - from - share * way).norm() < ball.radius + grown) return false;
    }
    return true;
  }

  const FreeSpace& space_;
  std::vector<Ball> balls_;
};

// The balls of one try: about the narrowest places, but never about an end.
std::vector<StoppedUp::Ball> plugs(const PathProblem& problem, const std::vector<Narrowest>& narrow,
                                   int attempt) {
  std::vector<StoppedUp::Ball> balls;
  for (const Narrowest& place : narrow) {
    const double to_ends =
        std::min((place.place - problem.start).norm(), (place.place - problem.goal).norm());
    const double wanted = (place.room + 0.5) * (1 + 0.4 * (attempt - 1));
    balls.push_back({place.place, std::min(wanted, 0.8 * to_ends - problem.half.norm())});
  }
  std::erase_if(balls, [](const auto& ball) { return !(ball.radius > 0); });
  return balls;
}

bool is_known(const FreeSpace& space, const PassageSearch& search,
              const std::vector<Vector3d>& way) {
  return std::any_of(search.excluded.begin(), search.excluded.end(),
                     [&](const auto& other) { return same_passage(space, way, other); });
}

// Grows one box face by face, a face that is stopped no more, until none can go on.
Eigen::AlignedBox3d grown(const FreeSpace& space, const Eigen::AlignedBox3d& bounds,
                          const Eigen::AlignedBox3d& seed, double growth) {
  constexpr double kFirst = 1.0, kLast = 0.05;  // m, steps of a face
  Eigen::AlignedBox3d box = seed;
  const Eigen::AlignedBox3d most(
      (seed.min() - Vector3d::Constant(growth)).cwiseMax(bounds.min().cwiseMin(seed.min())),
      (seed.max() + Vector3d::Constant(growth)).cwiseMin(bounds.max().cwiseMax(seed.max())));
  double step[6];
  std::fill_n(step, 6, kFirst);
  for (bool moving = true; moving;) {
    moving = false;
    for (int face = 0; face < 6; ++face) {
      if (step[face] < kLast) continue;
      moving = true;
      Eigen::AlignedBox3d next = box;
      const int axis = face / 2;
      if (face % 2 == 0)
        next.min()(axis) = std::max(box.min()(axis) - step[face], most.min()(axis));
      else
        next.max()(axis) = std::min(box.max()(axis) + step[face], most.max()(axis));
      const bool further = !next.isApprox(box, 0);
      if (further && space.swept_box_free(next.center(), next.center(), next.sizes() / 2))
        box = next;
      else
        step[face] = further ? step[face] / 2 : 0;
    }
  }
  return box;
}

}  // namespace

Vector3d place_on(std::span<const Vector3d> way, double share) {
  double left = std::clamp(share, 0.0, 1.0) * length_of(way);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double piece = (way[i] - way[i - 1]).norm();
    if (left <= piece && piece > 0) return way[i - 1] + left / piece * (way[i] - way[i - 1]);
    left -= piece;
  }
  return way.back();
}

bool same_passage(const FreeSpace& space, std::span<const Vector3d> a, std::span<const Vector3d> b,
                  int samples) {
  for (int k = 1; k < samples; ++k) {
    const double share = static_cast<double>(k) / samples;
    if (!space.segment_free(place_on(a, share), place_on(b, share))) return false;
  }
  return true;
}

Narrowest narrowest(const FreeSpace& space, std::span<const Vector3d> way) {
  constexpr int kPlaces = 60;
  Narrowest least{place_on(way, 0.5), std::numeric_limits<double>::infinity()};
  for (int k = 6; k <= kPlaces - 6; ++k) {
    const Vector3d p = place_on(way, static_cast<double>(k) / kPlaces);
    const double room = room_at(space, p);
    if (room < least.room) least = {p, room};
  }
  return least;
}

PassageResult find_passage(const PathPlanner& planner, const PathProblem& problem,
                           const PathRequest& request, const PassageSearch& search) {
  std::vector<Narrowest> narrow;
  for (const auto& way : search.excluded) narrow.push_back(narrowest(*problem.space, way));
  PassageResult result;
  int known = 0;
  PathReport last;
  for (int attempt = 0; attempt < search.tries; ++attempt) {
    const StoppedUp space(*problem.space, attempt == 0 ? std::vector<StoppedUp::Ball>{}
                                                       : plugs(problem, narrow, attempt));
    PathProblem asked = problem;
    asked.space = &space;
    PathRequest seeded = request;
    seeded.seed = request.seed + static_cast<std::uint64_t>(attempt);
    result.path = planner.plan(asked, seeded);
    ++result.tries;
    if (result.path.report.status == PathStatus::cancelled) return result;
    if (result.path.report.status == PathStatus::found) {
      if (!is_known(*problem.space, search, result.path.points)) return result;
      ++known;
    }
    if (search.excluded.empty()) return result;
    last = result.path.report;
  }
  result.path.points.clear();
  result.path.report = last;
  if (last.status == PathStatus::found) result.path.report.status = PathStatus::iteration_limit;
  result.path.report.message = "no other passage in " + std::to_string(result.tries) +
                               " tries, of which " + std::to_string(known) +
                               " found a failed one again";
  return result;
}

std::vector<CorridorBox> grow_corridor(const FreeSpace& space, const Eigen::AlignedBox3d& bounds,
                                       std::span<const Vector3d> way, double growth) {
  constexpr double kShortest = 0.05;  // m, of a part
  const double length = length_of(way);
  std::vector<CorridorBox> boxes;
  if (way.size() < 2 || !(length > 0)) return boxes;
  std::vector<std::pair<double, double>> parts;  // the next one last
  std::vector<double> corners{0};
  for (std::size_t i = 1; i < way.size(); ++i)
    corners.push_back(corners.back() + (way[i] - way[i - 1]).norm() / length);
  corners.back() = 1;
  for (std::size_t i = corners.size() - 1; i > 0; --i)
    if (corners[i] > corners[i - 1]) parts.emplace_back(corners[i - 1], corners[i]);
  while (!parts.empty()) {
    const auto [from, to] = parts.back();
    parts.pop_back();
    Eigen::AlignedBox3d seed(place_on(way, from));
    seed.extend(place_on(way, to));
    if (!space.swept_box_free(seed.center(), seed.center(), seed.sizes() / 2)) {
      if ((to - from) * length < kShortest) return {};
      parts.emplace_back((from + to) / 2, to);
      parts.emplace_back(from, (from + to) / 2);
      continue;
    }
    // A part that the box before holds as well needs none of its own.
    if (!boxes.empty() && boxes.back().box.contains(seed))
      boxes.back().to = to;
    else
      boxes.push_back({from, to, grown(space, bounds, seed, growth)});
  }
  return boxes;
}

}  // namespace lapwing
