// SPDX-License-Identifier: Apache-2.0
// Is the camera on what it was asked to film? Shares of the time asked for, on the continuous
// motion; cuts ask for nothing.
//
// A moment counts when every subject that is asked for then is seen. Moments are no further apart
// than the steps of the motion (kStepMaximum); where seen turns into unseen between two of them,
// the turn is found by halving.
#include "framework/geometry/camera_view.h"
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

// What the camera is at one time.
struct Moment {
  double time;
  Eigen::Vector3d position;
  double yaw, pitch;
};

Moment moment_of(const MotionPoint& p) {
  return {p.time, p.position, p.yaw + p.gimbal_yaw, p.gimbal_pitch};
}

Moment moment_at(const Moment& a, const Moment& b, double time) {
  const double s = b.time > a.time ? std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0) : 0;
  return {time, a.position + s * (b.position - a.position), a.yaw + s * (b.yaw - a.yaw),
          a.pitch + s * (b.pitch - a.pitch)};
}

// Whether the straight way from a to b meets the inside of an obstacle.
bool blocks(const Sphere& sphere, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double length2 = d.squaredNorm();
  const double s = length2 > 0 ? std::clamp((sphere.center - a).dot(d) / length2, 0.0, 1.0) : 0;
  return (a + s * d - sphere.center).norm() < sphere.radius;
}

bool blocks(const Box& box, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    const double d = b[i] - a[i];
    if (d == 0) {
      if (a[i] <= box.lower[i] || a[i] >= box.upper[i]) return false;
      continue;
    }
    const double s = (box.lower[i] - a[i]) / d, t = (box.upper[i] - a[i]) / d;
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  return enter < leave;
}

// Whether a point lies inside a zone and not on its surface: within its polygon, by the even-odd
// rule, and within its heights.
bool holds(const Zone& zone, const Eigen::Vector3d& p) {
  if (!(zone.floor < p.z() && p.z() < zone.ceiling)) return false;
  bool inside = false;
  for (std::size_t i = 0, j = zone.corners.size() - 1; i < zone.corners.size(); j = i++) {
    const Eigen::Vector2d &a = zone.corners[j], &b = zone.corners[i];
    const double side = (b - a).x() * (p.y() - a.y()) - (b - a).y() * (p.x() - a.x());
    if (side == 0 && (p.head<2>() - a).dot(p.head<2>() - b) <= 0) return false;  // on the edge
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if ((side > 0) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

// The way is cut where it crosses the floor, the ceiling or the line through an edge; the middle of
// each part says whether it lies inside.
bool blocks(const Zone& zone, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d way = b - a;
  std::vector<double> cuts{0, 1};
  const auto cut = [&](double share) {
    if (share > 0 && share < 1) cuts.push_back(share);
  };
  for (const double height : {zone.floor, zone.ceiling})
    if (way.z() != 0) cut((height - a.z()) / way.z());
  for (std::size_t i = 0, j = zone.corners.size() - 1; i < zone.corners.size(); j = i++) {
    const Eigen::Vector2d edge = zone.corners[i] - zone.corners[j];
    const Eigen::Vector2d to_edge = zone.corners[j] - a.head<2>();
    const double turn = way.x() * edge.y() - way.y() * edge.x();
    if (turn != 0) cut((to_edge.x() * edge.y() - to_edge.y() * edge.x()) / turn);
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t k = 1; k < cuts.size(); ++k)
    if (holds(zone, a + 0.5 * (cuts[k - 1] + cuts[k]) * way)) return true;
  return false;
}

bool contains(const Sphere& sphere, const Eigen::Vector3d& p) {
  return blocks(sphere, p, p);
}
bool contains(const Box& box, const Eigen::Vector3d& p) {
  return blocks(box, p, p);
}
bool contains(const Zone& zone, const Eigen::Vector3d& p) {
  return holds(zone, p);
}

// An obstacle that contains the subject is part of it.
template <class Obstacle>
bool any_blocks(const std::vector<Obstacle>& obstacles, const Eigen::Vector3d& camera,
                const Eigen::Vector3d& middle) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
    return !contains(obstacle, middle) && blocks(obstacle, camera, middle);
  });
}

constexpr double kTouching = 1e-9;  // m, from a voxel, is on it

// Whether anything stands between the camera and the middle of a subject. Meshes and maps have no
// inside: what of them is nearer to the middle than the subject's own size is taken for a part of
// it.
bool hidden(const Flight& flight, const Eigen::Vector3d& camera, const Eigen::Vector3d& middle,
            const Subject& subject) {
  const Environment& environment = flight.plan.environment;
  if (any_blocks(environment.spheres, camera, middle) ||
      any_blocks(environment.boxes, camera, middle) ||
      any_blocks(environment.zones, camera, middle))
    return true;
  const double own = std::max(subject.height, subject.width) / 2;
  const double length = (middle - camera).norm() - own;
  if (!(length > 0)) return false;
  const Eigen::Vector3d direction = (middle - camera).normalized();
  for (const MeshScene& mesh : flight.meshes)
    if (mesh.blocked({camera, direction, length})) return true;
  for (const BlockedVoxels& map : flight.maps)
    if (map.nearest(camera, camera + length * direction, kTouching).distance < kTouching)
      return true;
  return false;
}

// The ways of seeing a subject that are judged.
enum class Sight { middle, whole, free };
constexpr std::array kSights{Sight::middle, Sight::whole, Sight::free};
constexpr std::array kFramingNames{"framing", "whole_subject", "line_of_sight"};

bool seen(Sight sight, const CameraView& view, const Subject& subject, double time,
          const Flight& flight) {
  const Eigen::Vector3d middle = subject.position(time);
  if (sight == Sight::middle) return view.sees(middle);
  if (sight == Sight::free) return !hidden(flight, view.position, middle, subject);
  const auto box = view.box_of(middle, subject.height, subject.width);
  return box && box->left >= -0.5 && box->top >= -0.5 && box->right < view.pinhole.width - 0.5 &&
         box->bottom < view.pinhole.height - 0.5;
}

// How long one way of seeing lasted, and when it was first lost.
struct Lasting {
  double seconds = 0;
  double lost_at = 0;
  const Subject* lost = nullptr;
};

class Framing {
 public:
  explicit Framing(const Flight& flight)
      : flight_(flight), pinhole_(flight.vehicle.camera.pinhole()), cuts_(flight.plan.cuts) {
    const auto& subjects = flight.plan.environment.subjects;
    for (const FramingTask& task : flight.plan.task.framing) {
      const auto subject =
          std::find_if(subjects.begin(), subjects.end(),
                       [&](const Subject& candidate) { return candidate.name == task.subject; });
      asked_.push_back({&*subject, task.span});
      add_ends(task.span);
    }
    for (const TimeSpan& cut : cuts_) add_ends(cut);
    std::sort(ends_.begin(), ends_.end());
  }

  // The motion between two moments, cut where something begins or ends to be asked.
  void see(const Moment& a, const Moment& b) {
    double from = a.time;
    for (auto end = std::upper_bound(ends_.begin(), ends_.end(), a.time);
         end != ends_.end() && *end < b.time; ++end) {
      see_piece(a, b, from, *end);
      from = *end;
    }
    see_piece(a, b, from, b.time);
  }

  double asked_seconds() const { return asked_seconds_; }
  const Lasting& lasting(std::size_t sight) const { return lasting_[sight]; }

 private:
  struct Asked {
    const Subject* subject;
    TimeSpan span;
  };

  void add_ends(const TimeSpan& span) { ends_.insert(ends_.end(), {span.start, span.finish}); }

  // The first subject that is asked for but not seen; null when all are.
  const Subject* unseen(Sight sight, const Moment& m, const std::vector<const Subject*>& subjects) {
    const CameraView view{pinhole_, m.position, camera_axes(m.yaw, m.pitch)};
    for (const Subject* subject : subjects) {
      if (!seen(sight, view, *subject, m.time, flight_)) return subject;
    }
    return nullptr;
  }

  void see_piece(const Moment& a, const Moment& b, double from, double to) {
    const double middle = (from + to) / 2;
    const auto covers = [middle](const TimeSpan& s) {
      return s.start <= middle && middle <= s.finish;
    };
    if (!(from < to) || std::any_of(cuts_.begin(), cuts_.end(), covers)) return;
    std::vector<const Subject*> subjects;
    for (const Asked& asked : asked_) {
      if (covers(asked.span)) subjects.push_back(asked.subject);
    }
    if (subjects.empty()) return;
    asked_seconds_ += to - from;
    for (std::size_t k = 0; k < kSights.size(); ++k) {
      const auto lost = [&](double time) {
        return unseen(kSights[k], moment_at(a, b, time), subjects);
      };
      measure(lost, from, to, lasting_[k]);
    }
  }

  template <class Lost>
  static void measure(Lost lost, double from, double to, Lasting& lasting) {
    const Subject* first = lost(from);
    const Subject* last = lost(to);
    double low = from, high = to;
    if ((first == nullptr) != (last == nullptr)) {
      for (int i = 0; i < 20; ++i) {
        const double middle = (low + high) / 2;
        ((lost(middle) == nullptr) == (first == nullptr) ? low : high) = middle;
      }
    }
    if (!first) lasting.seconds += last ? low - from : to - from;
    if (first && !last) lasting.seconds += to - high;
    if (lasting.lost || (!first && !last)) return;
    lasting.lost = first ? first : last;
    lasting.lost_at = first ? from : high;
  }

  const Flight& flight_;
  const Pinhole pinhole_;
  const std::vector<TimeSpan>& cuts_;
  std::vector<Asked> asked_;
  std::vector<double> ends_;
  double asked_seconds_ = 0;
  std::array<Lasting, kSights.size()> lasting_;
};

// A film is to show its subjects, unless its own options say that this is told and not asked for.
bool sight_required(const Plan& plan) {
  const Value* stated = plan.configuration.find("line_of_sight");
  return !stated || !stated->is_text() || stated->as_text() != "reported";
}

void skip(const char* reason, Certificate& certificate) {
  for (const char* name : kFramingNames) certificate.checks.push_back(skipped_check(name, reason));
}

}  // namespace

void check_framing(const Flight& flight, Certificate& certificate) {
  const Task& task = flight.plan.task;
  if (task.framing.empty()) return skip("the task asks for no framing", certificate);
  if (!flight.plan.trajectory.has_gimbal) {
    return skip("the plan moves no gimbal, so the camera's direction is not known", certificate);
  }
  Framing framing(flight);
  for (std::size_t i = 0; i < flight.motion.intervals(); ++i) {
    const auto points = flight.motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      framing.see(moment_of(points[k - 1]), moment_of(points[k]));
    }
  }
  if (!(framing.asked_seconds() > 0)) {
    return skip("all the time that is asked for lies in cuts", certificate);
  }
  for (std::size_t k = 0; k < kFramingNames.size(); ++k) {
    const Lasting& lasting = framing.lasting(k);
    const double share = lasting.seconds / framing.asked_seconds();
    Check asked = make_check(kFramingNames[k]);
    if (kSights[k] == Sight::free) asked.required = sight_required(flight.plan);
    Check check = judged(std::move(asked), share, task.framing_share,
                         tolerance_of(task.framing_share), lasting.lost_at, true);
    if (lasting.lost) {
      check.detail += (check.detail.empty() ? "" : "; ") + ("subject '" + lasting.lost->name + "'");
    }
    certificate.checks.push_back(check);
  }
}

}  // namespace lapwing
