// SPDX-License-Identifier: Apache-2.0
#include "framework/view/candidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kPitchDraws = 1000;
constexpr int kDirectionDraws = 20;
constexpr std::size_t kMostPlaces = 300000;  // that growing may hold
constexpr double kWiderStep = 1.5;           // times, where they are more
constexpr int kThinningRounds = 12;
constexpr double kOneStep = 1 - 1e-9;  // times a step: neighbours of a lattice stay

void check(const CandidateSettings& s) {
  const auto refuse = [](const std::string& why) { throw InputError("candidates: " + why); };
  if (s.region.isEmpty()) refuse("the region of interest is empty");
  for (const ViewAim& aim : s.aims)
    if (aim.box.isEmpty() || !(aim.share > 0))
      refuse("a part of the region is empty, or has a share that is not above 0");
  if (s.allowed.isEmpty()) refuse("the box for the vehicle is empty");
  if (!(s.half.minCoeff() >= 0)) refuse("the vehicle's box must have edges of at least 0 m");
  if (!(s.step > 0) || !(s.step_growth >= 0)) refuse("the step must be above 0 m and grow");
  if (!(s.distance_apart > 0) || !(s.angle_apart >= 0))
    refuse("candidates must be more than 0 m apart");
  if (!(s.pitch_min < s.pitch_max)) refuse("the camera's pitch has no range");
  if (s.directions < 1) refuse("a place must have at least 1 direction");
  if (s.most < 1 || s.least < 0 || s.least > s.most)
    refuse("the largest number must be at least 1 and not below the smallest");
}

// Points of a box by place, so that near ones are found without looking at all. The cells are one
// array where the box has few enough of them, and a hash table otherwise.
class Grid {
 public:
  Grid(double edge, const Eigen::AlignedBox3d& box) : edge_(edge), low_(box.min()) {
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
      counts_[axis] = std::floor(box.sizes()[axis] / edge) + 1;
      cells *= counts_[axis];
    }
    if (cells <= kMostCells) first_.assign(static_cast<std::size_t>(cells), -1);
  }

  void add(const Vector3d& p, int index) {
    int& first = first_.empty() ? sparse_.try_emplace(key(cell(p)), -1).first->second
                                : first_[place(cell(p))];
    entries_.push_back({index, first});
    first = static_cast<int>(entries_.size()) - 1;
  }

  // Whether `holds` is true of any that may be within an edge's length.
  template <class Holds>
  bool any_near(const Vector3d& p, Holds holds) const {
    const std::array<double, 3> middle = cell(p);
    std::array<double, 3> at;
    for (at[2] = middle[2] - 1; at[2] <= middle[2] + 1; ++at[2])
      for (at[1] = middle[1] - 1; at[1] <= middle[1] + 1; ++at[1])
        for (at[0] = middle[0] - 1; at[0] <= middle[0] + 1; ++at[0])
          for (int entry = first_in(at); entry >= 0; entry = entries_[entry].next)
            if (holds(entries_[entry].index)) return true;
    return false;
  }

 private:
  struct Entry {
    int index, next;
  };
  static constexpr double kMostCells = 1 << 24;

  std::array<double, 3> cell(const Vector3d& p) const {
    return {std::floor((p.x() - low_.x()) / edge_), std::floor((p.y() - low_.y()) / edge_),
            std::floor((p.z() - low_.z()) / edge_)};
  }
  std::size_t place(const std::array<double, 3>& at) const {
    return static_cast<std::size_t>((at[2] * counts_[1] + at[1]) * counts_[0] + at[0]);
  }
  static std::uint64_t key(const std::array<double, 3>& at) {
    const auto part = [](double v) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) & 0x1fffff;
    };
    return part(at[0]) | part(at[1]) << 21 | part(at[2]) << 42;
  }
  int first_in(const std::array<double, 3>& at) const {
    if (first_.empty()) {
      const auto found = sparse_.find(key(at));
      return found == sparse_.end() ? -1 : found->second;
    }
    for (int axis = 0; axis < 3; ++axis)
      if (!(at[axis] >= 0 && at[axis] < counts_[axis])) return -1;
    return first_[place(at)];
  }

  double edge_;
  Vector3d low_;
  double counts_[3];
  std::vector<int> first_;  // entry of each cell, x first, then y; -1: none
  std::unordered_map<std::uint64_t, int> sparse_;
  std::vector<Entry> entries_;
};

class Generator {
 public:
  Generator(const FreeSpace& space, const CandidateSettings& settings, std::uint64_t seed,
            const CancellationToken* cancellation)
      : space_(space), s_(settings), random_(seed), cancellation_(cancellation) {}

  Candidates generate(const std::vector<Viewpoint>& given) {
    give(given);
    if (full() && made_.given >= s_.least) {
      made_.places = made_.given;
      return std::move(made_);
    }
    double step = s_.step;
    while (!grow(step)) step *= kWiderStep;
    made_.grown = static_cast<std::int64_t>(places_.size());
    thin(step);
    look_around();
    draw_more();
    return std::move(made_);
  }

 private:
  void give(const std::vector<Viewpoint>& given) {
    if (given.empty()) throw InputError("candidates: no start");
    for (std::size_t k = 0; k < given.size(); ++k) {
      const Vector3d& p = given[k].position;
      const auto refuse = [&](const std::string& why) {
        throw InputError("candidates: the viewpoint " + std::to_string(k + 1) + " to begin with " +
                         why);
      };
      if (!p.allFinite() || !s_.allowed.contains(p))
        refuse("lies outside the room that is allowed");
      if (!space_.swept_box_free(p, p, s_.half)) refuse("is not in free space");
      made_.viewpoints.push_back(given[k]);
    }
    made_.given = static_cast<int>(given.size());
  }

  double step_at(const Vector3d& p, double step) const {
    return step + s_.step_growth * s_.region.exteriorDistance(p);
  }

  // Places from the given ones; false when they are too many to be held.
  bool grow(double step) {
    places_.clear();
    made_.blocked = made_.crowded = made_.lost_beyond = 0;
    made_.lost.clear();
    Grid grid(s_.distance_apart, s_.allowed);
    // Steps from the rim lead beyond the box.
    double widest = step;
    for (int corner = 0; corner < 8; ++corner)
      widest = std::max(
          widest,
          step_at(s_.allowed.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)), step));
    const Vector3d beyond = Vector3d::Constant(widest);
    Grid stops(s_.distance_apart, {s_.allowed.min() - beyond, s_.allowed.max() + beyond});
    std::vector<Vector3d> stopped;
    const auto stop_at = [&](const Vector3d& p) {
      if (stops.any_near(p, [&](int other) {
            return (stopped[static_cast<std::size_t>(other)] - p).norm() < s_.distance_apart;
          }))
        return;
      stops.add(p, static_cast<int>(stopped.size()));
      stopped.push_back(p);
      lose(p, s_.allowed.contains(p) ? PlaceLoss::blocked : PlaceLoss::outside);
    };
    std::vector<int> front;
    const auto keep = [&](const Vector3d& p) {
      front.push_back(static_cast<int>(places_.size()));
      grid.add(p, front.back());
      places_.push_back(p);
    };
    for (const Viewpoint& v : made_.viewpoints) keep(v.position);
    while (!front.empty()) {
      throw_if_cancelled();
      // Any of the front, which then closes over it.
      const auto pick =
          static_cast<std::size_t>(random_.integer(0, static_cast<std::int64_t>(front.size()) - 1));
      const Vector3d from = places_[static_cast<std::size_t>(front[pick])];
      front[pick] = front.back();
      front.pop_back();
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          const Vector3d p = from + sign * step_at(from, step) * Vector3d::Unit(axis);
          const bool crowded = grid.any_near(p, [&](int other) {
            return (places_[static_cast<std::size_t>(other)] - p).norm() < s_.distance_apart;
          });
          made_.crowded += crowded;
          if (crowded) continue;
          if (!allowed(p)) {
            stop_at(p);
            continue;
          }
          if (places_.size() >= kMostPlaces) return false;
          keep(p);
        }
      }
    }
    return true;
  }

  void lose(const Vector3d& p, PlaceLoss why) {
    if (made_.lost.size() < Candidates::kMostLost)
      made_.lost.push_back({p, why});
    else
      ++made_.lost_beyond;
  }

  bool allowed(const Vector3d& p) {
    const bool free = s_.allowed.contains(p) && space_.swept_box_free(p, p, s_.half);
    made_.blocked += !free;
    return free;
  }

  // Leaves places at least a step from each other, and farther where each could not have its
  // directions otherwise.
  void thin(double step) {
    const auto wanted =
        std::max<std::size_t>(static_cast<std::size_t>(s_.most / s_.directions), 1) +
        static_cast<std::size_t>(made_.given);
    std::vector<int> order(places_.size());
    std::iota(order.begin(), order.end(), 0);
    for (int k = static_cast<int>(order.size()) - 1; k > made_.given; --k)
      std::swap(order[static_cast<std::size_t>(k)],
                order[static_cast<std::size_t>(random_.integer(made_.given, k))]);
    std::vector<Vector3d> left;
    double narrow = kOneStep, wide = kOneStep;  // times the steps
    while (!spaced(order, step, wide, wanted, left)) narrow = std::exchange(wide, 2 * wide);
    for (int round = 0; round < kThinningRounds && narrow < wide; ++round) {
      const double middle = (narrow + wide) / 2;
      (spaced(order, step, middle, wanted, left) ? wide : narrow) = middle;
    }
    std::vector<int> kept;
    spaced(order, step, wide, wanted, left, &kept);
    std::vector<char> is_kept(places_.size(), 0);
    for (const int k : kept) is_kept[static_cast<std::size_t>(k)] = 1;
    for (std::size_t k = 0; k < places_.size(); ++k)
      if (!is_kept[k]) lose(places_[k], PlaceLoss::thinned);
    places_ = std::move(left);
  }

  // False where more than `most` are so many steps apart. `kept`: the numbers of those left.
  bool spaced(const std::vector<int>& order, double step, double times, std::size_t most,
              std::vector<Vector3d>& left, std::vector<int>* kept = nullptr) const {
    throw_if_cancelled();
    left.clear();
    double widest = 0;
    for (const Vector3d& p : places_) widest = std::max(widest, times * step_at(p, step));
    Grid grid(widest, s_.allowed);
    for (const int k : order) {
      const Vector3d& p = places_[static_cast<std::size_t>(k)];
      const double apart = times * step_at(p, step);
      const bool given = k < made_.given;
      if (!given && grid.any_near(p, [&](int other) {
            return (left[static_cast<std::size_t>(other)] - p).norm() < apart;
          }))
        continue;
      if (left.size() >= most) return false;
      grid.add(p, static_cast<int>(left.size()));
      left.push_back(p);
      if (kept) kept->push_back(k);
    }
    return true;
  }

  // Views of the places, one after the other, until there are as many as allowed or no place has
  // a direction left.
  void look_around() {
    looks_.assign(places_.size(), {});
    for (int k = 0; k < made_.given; ++k) looks_[static_cast<std::size_t>(k)].push_back(k);
    std::vector<std::size_t> open;
    for (std::size_t place = 0; place < places_.size(); ++place)
      if (!is_viewless(s_.viewless, places_[place]))
        open.push_back(place);
      else if (looks_[place].empty())
        lose(places_[place], PlaceLoss::viewless);
    for (int round = 0; !open.empty() && !full(); ++round) {
      std::vector<std::size_t> still;
      for (const std::size_t place : open) {
        throw_if_cancelled();
        if (full()) break;
        const bool has_one = round == 0 && !looks_[place].empty();
        if (has_one || look(place)) still.push_back(place);
      }
      open = std::move(still);
    }
    for (std::size_t place = 0; place < places_.size(); ++place) {
      made_.places += !looks_[place].empty();
      if (looks_[place].empty() && !is_viewless(s_.viewless, places_[place]))
        lose(places_[place], PlaceLoss::thinned);
    }
  }

  bool full() const { return static_cast<int>(made_.viewpoints.size()) >= s_.most; }

  // One more view of a place; false where those that were drawn look like others.
  bool look(std::size_t place) {
    for (int draw = 0; draw < kDirectionDraws; ++draw) {
      const Viewpoint viewpoint = looking_from(places_[place]);
      bool crowded = false;
      for (const int other : looks_[place])
        crowded = crowded || angle_between(made_.viewpoints[static_cast<std::size_t>(other)],
                                           viewpoint) < s_.angle_apart;
      made_.crowded += crowded;
      if (crowded) continue;
      looks_[place].push_back(static_cast<int>(made_.viewpoints.size()));
      made_.viewpoints.push_back(viewpoint);
      return true;
    }
    return false;
  }

  // Where growing found too few: free places anywhere.
  void draw_more() {
    const Vector3d low = s_.allowed.min(), high = s_.allowed.max();
    int failed = 0;
    while (static_cast<int>(made_.viewpoints.size()) < s_.least && failed < s_.most_failed_draws) {
      throw_if_cancelled();
      const Vector3d p(random_.uniform(low.x(), high.x()), random_.uniform(low.y(), high.y()),
                       random_.uniform(low.z(), high.z()));
      const Viewpoint viewpoint = looking_from(p);
      bool taken = !allowed(p) || is_viewless(s_.viewless, p);
      for (std::size_t k = 0; k < made_.viewpoints.size() && !taken; ++k)
        taken = (made_.viewpoints[k].position - p).norm() < s_.distance_apart &&
                angle_between(made_.viewpoints[k], viewpoint) < s_.angle_apart;
      failed = taken ? failed + 1 : 0;
      if (taken) continue;
      made_.viewpoints.push_back(viewpoint);
      ++made_.places;
    }
  }

  void throw_if_cancelled() const {
    if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
  }

  // The region, or one of its parts.
  const Eigen::AlignedBox3d& aimed_at() {
    if (s_.aims.empty()) return s_.region;
    double all = 0;
    for (const ViewAim& aim : s_.aims) all += aim.share;
    double left = s_.aims.size() > 1 ? random_.uniform(0, all) : 0;
    for (const ViewAim& aim : s_.aims)
      if ((left -= aim.share) < 0) return aim.box;
    return s_.aims.back().box;
  }

  // Towards the middle of the region, more or less. From within the region any way is towards it.
  Viewpoint looking_from(const Vector3d& p) {
    const Eigen::AlignedBox3d& aim = aimed_at();
    const Vector3d middle = aim.center();
    const Vector3d towards = middle - p;
    const double yaw = std::atan2(towards.y(), towards.x());
    const double pitch = std::atan2(towards.z(), towards.head<2>().norm());
    double wide = 0, high = 0;
    const bool above = (p.head<2>().array() >= aim.min().head<2>().array()).all() &&
                       (p.head<2>().array() <= aim.max().head<2>().array()).all();
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d to = aim.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - p;
      const double turn = std::atan2(to.y(), to.x()) - yaw;
      wide = std::max(wide, std::abs(std::remainder(turn, 2 * std::numbers::pi)));
      high = std::max(high, std::abs(std::atan2(to.z(), to.head<2>().norm()) - pitch));
    }
    if (above) wide = std::numbers::pi;
    Viewpoint viewpoint{p, 0, 0};
    viewpoint.yaw = std::remainder(yaw + wide * random_.normal(), 2 * std::numbers::pi);
    for (int draw = 0; draw < kPitchDraws; ++draw) {
      viewpoint.pitch = pitch + high * random_.normal();
      if (viewpoint.pitch >= s_.pitch_min && viewpoint.pitch <= s_.pitch_max) return viewpoint;
    }
    // The region lies where the camera cannot look: as near to it as it can.
    viewpoint.pitch = pitch > s_.pitch_max ? s_.pitch_max : s_.pitch_min;
    return viewpoint;
  }

  const FreeSpace& space_;
  const CandidateSettings& s_;
  Random random_;
  const CancellationToken* cancellation_;
  std::vector<Vector3d> places_;         // the given ones first
  std::vector<std::vector<int>> looks_;  // of every place, by their index
  Candidates made_;
};

}  // namespace

bool is_viewless(const std::vector<ViewlessBall>& balls, const Vector3d& place) {
  return std::any_of(balls.begin(), balls.end(), [&](const ViewlessBall& ball) {
    return (place - ball.middle).norm() <= ball.radius;
  });
}

Candidates generate_candidates(const FreeSpace& space, const std::vector<Viewpoint>& given,
                               const CandidateSettings& settings, std::uint64_t seed,
                               const CancellationToken* cancellation) {
  check(settings);
  return Generator(space, settings, seed, cancellation).generate(given);
}

}  // namespace lapwing
