// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/race_flight.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/flight_controller.h"

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double kBehind = 0.3, kAhead = 0.6;  // s of the plan, where progress is looked for
constexpr double kProgressStep = 0.005;        // s of the plan
constexpr double kFollow = 5;                  // 1/s, of the reference after the pilot's progress
constexpr double kAtRest = 0.5;                // m/s
constexpr double kLastLeg = 1;                 // s of the plan, in which the finish counts

void check(const Pilot& pilot) {
  const auto refuse = [&](const std::string& text) {
    throw InputError("pilot '" + pilot.name + "': " + text);
  };
  if (!(pilot.weight >= 0 && pilot.weight <= 1)) refuse("weight must lie between 0 and 1");
  if (!(pilot.strength > 0) || !std::isfinite(pilot.strength))
    refuse("strength must be above 0 m/s^2");
  if (!(pilot.reach > 0) || !std::isfinite(pilot.reach)) refuse("reach must be above 0 m");
  if (!(pilot.speed >= 0.1 && pilot.speed <= 3)) refuse("speed must lie between 0.1 and 3");
  if (!std::isfinite(pilot.handicap)) refuse("handicap must be a number of seconds");
}

// Where the course leads, seen from above, and left of it; east where it stands still.
struct CourseAxes {
  Vector3d along, left;
};
CourseAxes axes_of(const Vector3d& velocity) {
  Vector3d along(velocity.x(), velocity.y(), 0);
  along = along.norm() > 1e-3 ? Vector3d(along.normalized()) : Vector3d::UnitX();
  return {along, {-along.y(), along.x(), 0}};
}

class RaceController {
 public:
  RaceController(const Vehicle& vehicle, const ReferenceMotion& reference, const Pilot& pilot)
      : reference_(reference),
        pilot_(pilot),
        mass_(vehicle.mass),
        drag_(vehicle.drag),
        inertia_(vehicle.inertia),
        gains_(gains_of(vehicle)),
        allocation_(vehicle),
        lead_(pilot.weight * 2 / std::sqrt(gains_.attitude.x() / inertia_.x()) +
              vehicle.rotors.lag),
        progress_(reference.start()),
        clock_(reference.start()) {}

  double progress() const { return progress_; }
  // Where the vehicle's z axis was to point, after the last command.
  const Vector3d& wanted_up() const { return wanted_up_; }

  // Moves the place on the course that is nearest, and the reference that follows it.
  void advance(const Vector3d& position, double step) {
    const double from = std::max(reference_.start(), progress_ - kBehind);
    const double to = std::min(reference_.finish(), progress_ + kAhead);
    double nearest = 1e300, best = progress_;
    for (double t = from; t < to + kProgressStep; t += kProgressStep) {
      const double at = std::min(t, to);
      const double distance = (reference_.at(at).position - position).squaredNorm();
      if (distance < nearest) nearest = distance, best = at;
    }
    progress_ = best;
    const double rate = std::max(0.0, pilot_.speed + kFollow * (progress_ - clock_));
    clock_ = std::min(reference_.finish(), clock_ + rate * step);
  }

  RotorCommand command(const BodyState& state, const Eigen::Vector2d& stick, double step) {
    const ReferencePoint wanted = reference_.at(clock_);
    const Vector3d velocity = pilot_.speed * wanted.velocity;
    const CourseAxes axes = axes_of(wanted.velocity);
    Vector3d error = state.position - wanted.position;
    error -= error.dot(axes.along) * axes.along;
    if (!saturated_) integral_ += step * error.z();
    const Vector3d drift = state.velocity - velocity;
    const double stiffness = pilot_.strength / pilot_.reach;
    Vector3d feedback = stiffness * error + 2 * std::sqrt(stiffness) * drift;
    feedback.z() =
        gains_.integral * integral_ + gains_.position * error.z() + gains_.velocity * drift.z();
    // The attitude answers that much later, where its rates are not fed forward, and by the lag.
    const double ahead = std::min(clock_ + pilot_.speed * lead_, reference_.finish());
    const Vector3d planned = pilot_.speed * pilot_.speed * reference_.at(ahead).acceleration;
    const Vector3d flown = pilot_.strength * (stick.x() * axes.along + stick.y() * axes.left);
    const Vector3d acceleration = (1 - pilot_.weight) * planned + pilot_.weight * flown - feedback;
    const Vector3d force = mass_ * (acceleration + Vector3d(0, 0, kGravity)) + drag_ * velocity;

    const Matrix3d r = state.orientation.toRotationMatrix();
    const Matrix3d rd = attitude_of(force, wanted.yaw).toRotationMatrix();
    const Matrix3d skew = rd.transpose() * r - r.transpose() * rd;
    wanted_up_ = rd.col(2);
    const Vector3d error_r = 0.5 * Vector3d(skew(2, 1), skew(0, 2), skew(1, 0));
    // Rates of the planned attitude, as far as the stick leaves the plan its feed-forward.
    const Vector3d rates =
        (1 - pilot_.weight) * pilot_.speed * planned_attitude(reference_, ahead).body_rates;
    const Vector3d& omega = state.body_rates;
    const Vector3d error_rates = omega - r.transpose() * (rd * rates);
    Eigen::Vector4d wrench;
    wrench << force.dot(r.col(2)), -gains_.attitude.cwiseProduct(error_r) -
                                       gains_.rates.cwiseProduct(error_rates) +
                                       omega.cross(inertia_.cwiseProduct(omega));
    const RotorCommand command = allocation_(wrench);
    saturated_ = command.saturated;
    return command;
  }

 private:
  const ReferenceMotion& reference_;
  const Pilot& pilot_;
  double mass_, drag_;
  Vector3d inertia_;
  ControllerGains gains_;
  RotorAllocation allocation_;
  double lead_;              // s
  double progress_, clock_;  // s of the plan: of the pilot, and of the reference that follows
  double integral_ = 0;      // m s, of the height
  Vector3d wanted_up_ = Vector3d::UnitZ();
  bool saturated_ = false;
};

// The last point, moving as just before it: afterwards the reference hovers.
ReferencePoint end_of(const ReferenceMotion& reference) {
  ReferencePoint end = reference.at(reference.finish());
  end.velocity = reference.at(reference.finish() - kProgressStep).velocity;
  return end;
}

BodyState starting_state(const ReferenceMotion& reference, const Vehicle& vehicle, double speed) {
  const ReferencePoint start = reference.at(reference.start());
  BodyState state;
  state.position = start.position;
  state.velocity = speed * start.velocity;
  state.orientation = attitude_of(reference.force(start), start.yaw);
  state.rotor_thrusts.setConstant(vehicle.mass * kGravity / 4);
  return state;
}

}  // namespace

const char* to_string(RaceEnd end) {
  switch (end) {
    case RaceEnd::finished:
      return "finished";
    case RaceEnd::off_course:
      return "left the course";
    case RaceEnd::turned_over:
      return "turned over";
    case RaceEnd::time_up:
      break;
  }
  return "ran out of time";
}

RaceFlight fly_race(const Trajectory& course, const Vehicle& vehicle, const Pilot& pilot,
                    const RaceFlightLimits& limits, const CancellationToken* cancellation) {
  const auto logged = [&](double time, const BodyState&, double) { return pilot.log.at(time); };
  return fly_race(course, vehicle, pilot, logged, limits, cancellation);
}

struct RaceInProgress::Inside {
  Inside(const Trajectory& course_given, const Vehicle& vehicle, const Pilot& pilot_given,
         const RaceFlightLimits& limits_given)
      : course(course_given),
        pilot(pilot_given),
        limits(limits_given),
        reference(course, vehicle),
        controller(vehicle, reference, pilot),
        body(vehicle),
        state(starting_state(reference, vehicle, pilot.speed)),
        finish(end_of(reference)),
        onward(limits.finish_direction.value_or(finish.velocity)),
        most(limits.time_factor * (reference.finish() - reference.start()) / pilot.speed),
        every(std::max<std::int64_t>(1, std::llround(limits.sample_step / limits.step))),
        progress(reference.start()) {}

  // Past the end of the course, or, where it ends at rest, as good as there.
  bool there() const {
    const Vector3d beyond = state.position - finish.position;
    const bool past = progress >= reference.finish() && beyond.dot(onward) >= 0;
    const bool near = finish.velocity.norm() < kAtRest &&
                      progress >= reference.finish() - kLastLeg &&
                      beyond.norm() <= limits.finish_radius;
    return past || near;
  }
  double time() const { return static_cast<double>(k) * limits.step; }
  void step(const StickSource& source);

  Trajectory course;
  Pilot pilot;
  RaceFlightLimits limits;
  ReferenceMotion reference;
  RaceController controller;
  RotorBody body;
  BodyState state;
  ReferencePoint finish;
  Vector3d onward;
  double most;  // s
  std::int64_t every;
  double progress, deviation = 0;
  double tumbling = 0;  // s
  RaceFlight flight;
  double sum = 0;  // of deviations, m
  std::int64_t k = 0, saturated = 0;
  bool ended = false;
};

void RaceInProgress::Inside::step(const StickSource& source) {
  controller.advance(state.position, limits.step);
  progress = controller.progress();
  const Vector3d place = reference.at(progress).position;
  deviation = (state.position - place).norm();
  const Eigen::Vector2d stick = source(time(), state, progress);
  const bool arrived = there();
  // Tumbling, as the simulation of plans has it: a course may lead upside down.
  const Vector3d up = state.orientation * Vector3d::UnitZ();
  tumbling = up.z() < 0 && up.dot(controller.wanted_up()) < 0 ? tumbling + limits.step : 0;
  const bool over = tumbling > kTumbling;
  const bool lost = !(deviation <= limits.off_course);
  ended = arrived || over || lost || time() >= most;
  if (ended)
    flight.end = arrived ? RaceEnd::finished
                 : lost  ? RaceEnd::off_course
                 : over  ? RaceEnd::turned_over
                         : RaceEnd::time_up;
  if (!(deviation <= flight.deviation_worst))
    flight.deviation_worst = deviation, flight.deviation_at = time();
  sum += deviation;
  flight.time = time();
  flight.deviation_mean = sum / static_cast<double>(k + 1);
  if (k % every == 0 || ended)
    flight.samples.push_back({time(), state, place, progress, deviation, stick});
  if (ended) {
    flight.saturated_share =
        static_cast<double>(saturated) / static_cast<double>(std::max<std::int64_t>(1, k));
    return;
  }
  const RotorCommand command = controller.command(state, stick, limits.step);
  saturated += command.saturated;
  state = body.after(state, command.thrusts, Vector3d::Zero(), limits.step);
  ++k;
}

namespace {

const Pilot& checked(const Pilot& pilot) {
  check(pilot);
  return pilot;
}

}  // namespace

RaceInProgress::RaceInProgress(const Trajectory& course, const Vehicle& vehicle, const Pilot& pilot,
                               const RaceFlightLimits& limits)
    : inside_(std::make_unique<Inside>(course, vehicle, checked(pilot), limits)) {}
RaceInProgress::~RaceInProgress() = default;
RaceInProgress::RaceInProgress(RaceInProgress&&) noexcept = default;
RaceInProgress& RaceInProgress::operator=(RaceInProgress&&) noexcept = default;

bool RaceInProgress::ended() const {
  return inside_->ended;
}

double RaceInProgress::time() const {
  return inside_->time();
}

const BodyState& RaceInProgress::state() const {
  return inside_->state;
}

double RaceInProgress::progress() const {
  return inside_->progress;
}

double RaceInProgress::deviation() const {
  return inside_->deviation;
}

const RaceFlight& RaceInProgress::flight() const {
  return inside_->flight;
}

void RaceInProgress::step(const StickSource& stick) {
  if (!inside_->ended) inside_->step(stick);
}

RaceFlight fly_race(const Trajectory& course, const Vehicle& vehicle, const Pilot& pilot,
                    const StickSource& source, const RaceFlightLimits& limits,
                    const CancellationToken* cancellation) {
  RaceInProgress race(course, vehicle, pilot, limits);
  for (int k = 0; !race.ended(); k = (k + 1) % 1024) {
    if (cancellation && k == 0 && cancellation->cancelled()) throw Cancelled();
    race.step(source);
  }
  return race.flight();
}

}  // namespace lapwing
