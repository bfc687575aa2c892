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

// What stands between the camera and the middle of a subject: the first such obstacle of the list,
// or null.
const Obstacle* hiding(const Flight& flight, const Eigen::Vector3d& camera,
                       const Eigen::Vector3d& middle, const Subject& subject, double time) {
  const auto& obstacles = flight.plan.environment.obstacles;
  const double own = std::max(subject.height, subject.width) / 2;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (!obstacles[i].opaque || obstacles[i].side == Side::keep_inside) continue;
    const Eigen::Vector3d moved = obstacles[i].moved(time);
    if (flight.shapes[i]->hides(camera - moved, middle - moved, own)) return &obstacles[i];
  }
  return nullptr;
}

// The ways of seeing a subject that are judged.
enum class Sight { middle, whole, free };
constexpr std::array kSights{Sight::middle, Sight::whole, Sight::free};
constexpr std::array kFramingNames{"framing", "whole_subject", "line_of_sight"};

bool seen(Sight sight, const CameraView& view, const Subject& subject, double time,
          const Flight& flight) {
  const Eigen::Vector3d middle = subject.position(time);
  if (sight == Sight::middle) return view.sees(middle);
  if (sight == Sight::free) return !hiding(flight, view.position, middle, subject, time);
  const auto box = view.box_of(middle, subject.height, subject.width);
  return box && box->left >= -0.5 && box->top >= -0.5 && box->right < view.pinhole.width - 0.5 &&
         box->bottom < view.pinhole.height - 0.5;
}

// How long one way of seeing lasted, and when it was first lost.
struct Lasting {
  double seconds = 0;
  double lost_at = 0;
  const Subject* lost = nullptr;
  std::string behind;  // the obstacle that hid it then; "" for none
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
      Lasting& lasting = lasting_[k];
      const bool before = lasting.lost != nullptr;
      measure(lost, from, to, lasting);
      if (!before && lasting.lost && kSights[k] == Sight::free) {
        lasting.behind = what_hides(*lasting.lost, moment_at(a, b, lasting.lost_at));
      }
    }
  }

  std::string what_hides(const Subject& subject, const Moment& m) const {
    const Obstacle* obstacle =
        hiding(flight_, m.position, subject.position(m.time), subject, m.time);
    if (!obstacle) return "";
    const auto& all = flight_.plan.environment.obstacles;
    return obstacle->label(static_cast<std::size_t>(obstacle - all.data()) + 1);
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

void skip(const char* reason, Certificate& certificate) {
  for (const char* name : kFramingNames) certificate.checks.push_back(skipped_check(name, reason));
}

}  // namespace

void check_framing(const Flight& flight, Certificate& certificate) {
  const Task& task = flight.plan.task;
  if (task.framing.empty()) return skip("the task has no framing", certificate);
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
    return skip("all required time lies in cuts", certificate);
  }
  for (std::size_t k = 0; k < kFramingNames.size(); ++k) {
    const Lasting& lasting = framing.lasting(k);
    const double share = lasting.seconds / framing.asked_seconds();
    Check asked = make_check(kFramingNames[k]);
    if (kSights[k] == Sight::free) asked.required = task.line_of_sight_required;
    Check check = judged(std::move(asked), share, task.framing_share,
                         tolerance_of(task.framing_share), lasting.lost_at, true);
    if (lasting.lost) {
      check.detail += (check.detail.empty() ? "" : "; ") + ("subject '" + lasting.lost->name + "'");
      if (!lasting.behind.empty()) check.detail += " behind " + lasting.behind;
    }
    certificate.checks.push_back(check);
  }
}

}  // namespace lapwing
