#include "framework/view/candidates.h"

#include <cmath>
#include <numbers>
#include <unordered_map>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kPitchDraws = 1000;

void check(const CandidateSettings& s) {
  const auto refuse = [](const std::string& why) { throw InputError("candidates: " + why); };
  if (s.region.isEmpty()) refuse("the region of interest is empty");
  if (s.allowed.isEmpty()) refuse("there is no room that is allowed");
  if (!(s.half.minCoeff() >= 0)) refuse("the vehicle's box must have edges of at least 0 m");
  if (!(s.step > 0) || !(s.step_growth >= 0)) refuse("the step must be above 0 m and grow");
  if (!(s.distance_apart > 0) || !(s.angle_apart >= 0))
    refuse("candidates must be apart by more than 0 m");
  if (!(s.pitch_min < s.pitch_max)) refuse("the camera's pitch has no range");
  if (s.most < 1 || s.least < 0 || s.least > s.most)
    refuse("their number must be at least 1, and the least no more than the most");
}

// Candidates by place, so that near ones are found without looking at all.
class Grid {
 public:
  explicit Grid(double edge) : edge_(edge) {}

  void add(const Vector3d& p, int index) { cells_[cell(p, 0, 0, 0)].push_back(index); }

  template <class Visit>
  void near(const Vector3d& p, Visit visit) const {
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (const auto found = cells_.find(cell(p, x, y, z)); found != cells_.end())
            for (const int index : found->second) visit(index);
  }

 private:
  std::uint64_t cell(const Vector3d& p, int x, int y, int z) const {
    const auto part = [&](double v, int offset) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v / edge_)) + offset) &
             0x1fffff;
    };
    return part(p.x(), x) | part(p.y(), y) << 21 | part(p.z(), z) << 42;
  }

  double edge_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

class Generator {
 public:
  Generator(const FreeSpace& space, const CandidateSettings& settings, std::uint64_t seed)
      : space_(space), s_(settings), random_(seed), grid_(settings.distance_apart) {}

  void give(const std::vector<Viewpoint>& given) {
    if (given.empty()) throw InputError("candidates: no viewpoint to begin with");
    for (std::size_t k = 0; k < given.size(); ++k) {
      const Vector3d& p = given[k].position;
      const auto refuse = [&](const std::string& why) {
        throw InputError("candidates: the viewpoint " + std::to_string(k + 1) + " to begin with " +
                         why);
      };
      if (!p.allFinite() || !s_.allowed.contains(p))
        refuse("lies outside the room that is allowed");
      if (!space_.swept_box_free(p, p, s_.half)) refuse("is not in free space");
      keep(given[k]);
    }
    made_.given = static_cast<int>(given.size());
  }

  void grow(const CancellationToken* cancellation) {
    int failed = 0;
    while (static_cast<int>(made_.viewpoints.size()) < s_.most) {
      if (cancellation && cancellation->cancelled()) throw Cancelled();
      if (!front_.empty()) {
        // Any of the front, which then closes over it.
        const auto pick = static_cast<std::size_t>(
            random_.integer(0, static_cast<std::int64_t>(front_.size()) - 1));
        const Vector3d from = made_.viewpoints[static_cast<std::size_t>(front_[pick])].position;
        front_[pick] = front_.back();
        front_.pop_back();
        spread(from);
        continue;
      }
      if (static_cast<int>(made_.viewpoints.size()) >= s_.least) return;
      const Vector3d low = s_.allowed.min(), high = s_.allowed.max();
      const Vector3d p(random_.uniform(low.x(), high.x()), random_.uniform(low.y(), high.y()),
                       random_.uniform(low.z(), high.z()));
      failed = add(p) ? 0 : failed + 1;
      if (failed >= s_.most_failed_draws) return;
    }
  }

  Candidates take() { return std::move(made_); }

 private:
  void spread(const Vector3d& from) {
    const double step = s_.step + s_.step_growth * s_.region.exteriorDistance(from);
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0})
        if (static_cast<int>(made_.viewpoints.size()) < s_.most)
          add(from + sign * step * Vector3d::Unit(axis));
  }

  bool add(const Vector3d& p) {
    if (!s_.allowed.contains(p) || !space_.swept_box_free(p, p, s_.half)) {
      ++made_.blocked;
      return false;
    }
    const Viewpoint viewpoint = looking_from(p);
    bool crowded = false;
    grid_.near(p, [&](int other) {
      const Viewpoint& v = made_.viewpoints[static_cast<std::size_t>(other)];
      crowded = crowded || ((v.position - p).norm() < s_.distance_apart &&
                            angle_between(v, viewpoint) < s_.angle_apart);
    });
    if (crowded) {
      ++made_.crowded;
      return false;
    }
    keep(viewpoint);
    return true;
  }

  void keep(const Viewpoint& viewpoint) {
    const auto index = static_cast<int>(made_.viewpoints.size());
    made_.viewpoints.push_back(viewpoint);
    grid_.add(viewpoint.position, index);
    front_.push_back(index);
  }

  // Towards the middle of the region, more or less. From within the region any way is towards it.
  Viewpoint looking_from(const Vector3d& p) {
    const Vector3d middle = s_.region.center();
    const Vector3d towards = middle - p;
    const double yaw = std::atan2(towards.y(), towards.x());
    const double pitch = std::atan2(towards.z(), towards.head<2>().norm());
    double wide = 0, high = 0;
    const bool above = (p.head<2>().array() >= s_.region.min().head<2>().array()).all() &&
                       (p.head<2>().array() <= s_.region.max().head<2>().array()).all();
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d to =
          s_.region.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - p;
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
  Grid grid_;
  std::vector<int> front_;
  Candidates made_;
};

}  // namespace

Candidates generate_candidates(const FreeSpace& space, const std::vector<Viewpoint>& given,
                               const CandidateSettings& settings, std::uint64_t seed,
                               const CancellationToken* cancellation) {
  check(settings);
  Generator generator(space, settings, seed);
  generator.give(given);
  generator.grow(cancellation);
  return generator.take();
}

}  // namespace lapwing
