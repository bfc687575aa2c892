// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/pursuit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kPursuitResponse = 0.15;  // s, in which a wrong velocity is mended
constexpr double kApproach = 0.7;          // s, of the last centimetres to a stop
constexpr double kThere = 0.02;            // m, from a view where the vehicle stops
constexpr double kStill = 0.04;            // m/s, of a vehicle at rest
constexpr double kPassed = 0.1;            // m, from a view that is flown by
constexpr double kTurning = 1.5;           // rad/s, bandwidth of the heading
constexpr double kTurned = 0.01;           // rad, from the heading of a view, at rest
constexpr double kLongest = 100'000;       // s, of a flight

void check(const Points& path, std::span<const PursuitView> views, const Vehicle& vehicle,
           const PursuitSettings& s) {
  const auto refuse = [](const std::string& text) { throw InputError("pursuit: " + text); };
  if (path.size() < 2) refuse("expected a path of two points or more");
  for (const Vector3d& p : path)
    if (!p.allFinite()) refuse("a point of the path is not finite");
  if (!(length_of(path) > 0) && (views.size() < 2 || !s.stop))
    refuse("the path has no length, and there are no views");
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!(views[i].least >= 0 && views[i].least <= 3600))
      refuse("view " + std::to_string(i + 1) + " must be reached after 0 to 3600 s");
    if (views[i].point >= path.size() || !std::isfinite(views[i].yaw))
      refuse("view " + std::to_string(i + 1) + " is at no point of the path");
    if (i > 0 && views[i].point <= views[i - 1].point)
      refuse("view " + std::to_string(i + 1) + " comes before the one before it");
  }
  for (const double number :
       {s.speed, s.view_speed, s.slow_within, s.lookahead, s.acceleration, s.step})
    if (!(number > 0) || !std::isfinite(number))
      refuse("speeds, distances, acceleration and step must be above 0");
  if (!(s.pause >= 0 && s.pause <= 3600)) refuse("a pause lasts from 0 to 3600 s");
  if (s.speed > vehicle.speed_across_max || s.view_speed > s.speed)
    refuse("speeds must not exceed the vehicle's, nor that at views the one on the way");
  if (s.acceleration > vehicle.acceleration_across_max)
    refuse("the acceleration must not exceed the vehicle's");
  if (s.lookahead < 3 * s.step * s.speed)
    refuse("the lookahead must be three steps at full speed at least");
}

// The path by the length flown.
class Line {
 public:
  explicit Line(const Points& path) : path_(path), lengths_{0} {
    for (std::size_t i = 1; i < path.size(); ++i)
      lengths_.push_back(lengths_.back() + (path[i] - path[i - 1]).norm());
  }
  double length() const { return lengths_.back(); }
  double at_point(std::size_t i) const { return lengths_[i]; }

  Vector3d place(double along) const {
    const std::size_t i = piece(along);
    const double span = lengths_[i + 1] - lengths_[i];
    const double share = span > 0 ? std::clamp((along - lengths_[i]) / span, 0.0, 1.0) : 1;
    return path_[i] + share * (path_[i + 1] - path_[i]);
  }

  // The place nearest to p from `from` to `to`, so that crossings of the path confuse nobody.
  double nearest(const Vector3d& p, double from, double to) const {
    double best = from, least = (place(from) - p).squaredNorm();
    for (std::size_t i = piece(from); i + 1 < path_.size() && lengths_[i] <= to; ++i) {
      const Vector3d edge = path_[i + 1] - path_[i];
      const double span = lengths_[i + 1] - lengths_[i];
      if (!(span > 0)) continue;
      const double along = std::clamp(lengths_[i] + (p - path_[i]).dot(edge) / span,
                                      std::max(from, lengths_[i]), std::min(to, lengths_[i + 1]));
      const double distance = (place(along) - p).squaredNorm();
      if (distance < least) least = distance, best = along;
    }
    return best;
  }

 private:
  std::size_t piece(double along) const {
    const auto next = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, along);
    return static_cast<std::size_t>(next - lengths_.begin()) - 1;
  }

  const Points& path_;
  std::vector<double> lengths_;
};

class Chase {
 public:
  Chase(const Points& path, std::span<const PursuitView> views, const Vehicle& vehicle,
        const PursuitSettings& settings)
      : line_(path), path_(path), views_(views), vehicle_(vehicle), settings_(settings) {
    now_.position = path.front();
    now_.yaw = views.empty() ? heading() : views.front().yaw;
    result_.views.resize(views.size());
    for (ViewPassed& view : result_.views) view.miss = std::numeric_limits<double>::infinity();
  }

  Pursuit fly() {
    while (!finished()) {
      if (now_.time > kLongest) throw InputError("pursuit: the flight takes more than a day");
      step(pausing() ? Vector3d(Vector3d::Zero()) : acceleration());
    }
    // At rest: what is left of velocity and turning is below what a controller can tell.
    sample(Vector3d::Zero(), 0);
    return std::move(result_);
  }

 private:
  bool at_goal() const { return next_ >= views_.size(); }
  Vector3d goal() const { return at_goal() ? path_.back() : path_[views_[next_].point]; }
  double goal_along() const {
    return at_goal() ? line_.length() : line_.at_point(views_[next_].point);
  }
  bool stops() const { return at_goal() || settings_.stop; }
  double heading() const {
    const Vector3d way = line_.place(std::min(line_.length(), 0.1)) - path_.front();
    return std::atan2(way.y(), way.x());
  }
  double wanted_yaw() const {
    if (views_.empty()) return now_.yaw;
    const std::size_t from = pausing() && next_ > 0 ? next_ - 1 : next_;  // still in the last one
    const double yaw = views_[std::min(from, views_.size() - 1)].yaw;
    return now_.yaw + std::remainder(yaw - now_.yaw, 2 * std::numbers::pi);
  }
  bool pausing() const { return now_.time < until_ - 1e-9; }
  bool finished() const { return done_ && !pausing(); }

  double away() const { return (goal() - now_.position).norm(); }

  // The speed that lets the vehicle be as slow as it must where it must.
  double speed() const {
    const double a = 0.7 * settings_.acceleration, left = away();
    double speed = settings_.speed;
    if (!at_goal()) {
      // What was asked for comes kPursuitResponse later.
      const double late = kPursuitResponse * now_.velocity.norm();
      const double before = std::max(0.0, left - late - settings_.slow_within);
      speed =
          std::min(speed, std::sqrt(settings_.view_speed * settings_.view_speed + 2 * a * before));
    }
    if (stops()) speed = std::min({speed, std::sqrt(2 * a * left), left / kApproach});
    return speed;
  }

  // The circle that leads to the pursued point bends by 2 sin(angle) / lookahead; the speed at
  // which the acceleration asked for is enough for it.
  double turning_speed(const Vector3d& way) const {
    constexpr double kSlow = 0.1;  // m/s, below which there is no direction of flight
    const double fast = now_.velocity.norm();
    if (fast < kSlow) return settings_.speed;
    const double cosine = now_.velocity.dot(way) / fast;
    const double sine = cosine < 0 ? 1 : std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return std::sqrt(0.7 * settings_.acceleration * settings_.lookahead / std::max(2 * sine, 1e-3));
  }

  Vector3d acceleration() {
    along_ = line_.nearest(now_.position, along_, std::min(goal_along(), along_ + reach()));
    const double ahead = std::min(along_ + settings_.lookahead, goal_along());
    Vector3d way = line_.place(ahead) - now_.position;
    const double distance = way.norm();
    if (distance > 0) way /= distance;
    double pace = std::min(speed(), turning_speed(way));
    if (way.z() * pace > vehicle_.climb_speed_max) pace = vehicle_.climb_speed_max / way.z();
    if (-way.z() * pace > vehicle_.descent_speed_max) pace = vehicle_.descent_speed_max / -way.z();
    Vector3d wanted = (0.98 * pace * way - now_.velocity) / kPursuitResponse;
    const double asked = wanted.norm();
    return asked > settings_.acceleration ? Vector3d(wanted * (settings_.acceleration / asked))
                                          : wanted;
  }
  double reach() const { return 2 * settings_.lookahead; }

  double turning() const {
    const double error = wanted_yaw() - now_.yaw, fastest = 0.7 * vehicle_.yaw_rate_max;
    const double rate = std::clamp(kTurning / 2 * error, -fastest, fastest);
    const double most = 0.7 * vehicle_.yaw_torque_max() / vehicle_.inertia.z();
    return std::clamp(2 * kTurning * (rate - now_.yaw_rate), -most, most);
  }

  void sample(const Vector3d& a, double spin) {
    now_.acceleration = a;
    now_.columns.set("force", Vector3d(vehicle_.mass * (a + Vector3d(0, 0, kGravity))));
    now_.columns.set("yaw_torque", vehicle_.inertia.z() * spin);
    result_.trajectory.samples.push_back(now_);
  }

  void step(const Vector3d& asked) {
    const double h = settings_.step;
    // In a pause the rest of the motion dies away.
    Vector3d a = pausing() ? Vector3d(-now_.velocity / kPursuitResponse) : asked;
    const double spin = turning();
    sample(a, spin);
    now_.time += h;
    now_.position += h * now_.velocity + h * h / 2 * a;
    now_.velocity += h * a;
    now_.yaw += h * now_.yaw_rate + h * h / 2 * spin;
    now_.yaw_rate += h * spin;
    arrive();
  }

  void arrive() {
    if (pausing() || done_) return;
    const double left = away();
    if (!at_goal()) {
      ViewPassed& view = result_.views[next_];
      view.miss = std::min(view.miss, left);
    }
    const bool there = stops() ? left < kThere && now_.velocity.norm() < kStill : left < kPassed;
    const bool turned =
        !stops() || views_.empty() ||
        (std::abs(wanted_yaw() - now_.yaw) < kTurned && std::abs(now_.yaw_rate) < kTurned);
    if (!there || !turned) return;
    // Where it stops it waits for the camera; `until_` is when it left the view before.
    if (!at_goal() && settings_.stop && now_.time < until_ + views_[next_].least - 1e-9) return;
    if (at_goal()) {
      done_ = true;
      return;
    }
    const double pause = settings_.stop ? settings_.pause : 0;
    result_.views[next_].arrival = now_.time;
    result_.views[next_].departure = until_ = now_.time + pause;
    along_ = goal_along();
    ++next_;
    // The path may end in its last view.
    if (at_goal() && settings_.stop && away() < kThere) done_ = true;
  }

  Line line_;
  const Points& path_;
  std::span<const PursuitView> views_;
  const Vehicle& vehicle_;
  const PursuitSettings& settings_;
  Sample now_;
  double along_ = 0, until_ = 0;
  std::size_t next_ = 0;
  bool done_ = false;
  Pursuit result_;
};

}  // namespace

Pursuit pursue(const Points& path, std::span<const PursuitView> views, const Vehicle& vehicle,
               const PursuitSettings& settings) {
  check(path, views, vehicle, settings);
  return Chase(path, views, vehicle, settings).fly();
}

}  // namespace lapwing
