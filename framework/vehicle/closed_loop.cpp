// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/closed_loop.h"

#include <cmath>
#include <cstdio>
#include <deque>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/vehicle/dryden.h"
#include "framework/vehicle/flight_controller.h"

namespace lapwing {

using Eigen::Vector3d;

namespace {

constexpr double kLost = 100.0;        // m
constexpr double kBeyondLimit = 1e-9;  // N, of a command, for rounding

// Streams of random numbers that one seed gives.
enum : std::uint64_t { kGustStream, kNoiseStream };

// A mean wind and gusts about it.
class Wind {
 public:
  explicit Wind(const FlightConditions& conditions)
      : along_(std::cos(conditions.wind_yaw), std::sin(conditions.wind_yaw), 0),
        across_(-along_.y(), along_.x(), 0),
        mean_(conditions.wind_mean * along_),
        gust_(conditions.wind_gust, Random(conditions.seed).split(kGustStream)) {}

  Vector3d next(const BodyState& state, double step) {
    const Vector3d gust = gust_.next(state.position.z(), (state.velocity - mean_).norm(), step);
    return mean_ + gust.x() * along_ + gust.y() * across_ + Vector3d(0, 0, gust.z());
  }

 private:
  Vector3d along_, across_, mean_;
  DrydenGust gust_;
};

// What is known of the state: late, and with noise.
class Estimator {
 public:
  Estimator(const FlightConditions& conditions, double step)
      : d_(conditions.disturbances),
        late_(static_cast<std::size_t>(std::llround(d_.estimator_delay / step))),
        noisy_(d_.position_noise > 0 || d_.velocity_noise > 0 || d_.attitude_noise > 0 ||
               d_.rate_noise > 0),
        random_(Random(conditions.seed).split(kNoiseStream)) {}

  BodyState estimate(const BodyState& state) {
    if (late_ == 0 && !noisy_) return state;
    known_.push_back(state);
    if (known_.size() > late_ + 1) known_.pop_front();
    BodyState estimate = known_.front();
    if (!noisy_) return estimate;
    estimate.position += d_.position_noise * three();
    estimate.velocity += d_.velocity_noise * three();
    estimate.body_rates += d_.rate_noise * three();
    const Vector3d turn = d_.attitude_noise * three();
    if (turn.norm() > 0)
      estimate.orientation = estimate.orientation *
                             Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    return estimate;
  }

 private:
  Vector3d three() {
    const double x = random_.normal(), y = random_.normal(), z = random_.normal();
    return {x, y, z};
  }
  const Disturbances& d_;
  std::size_t late_;
  bool noisy_;
  Random random_;
  std::deque<BodyState> known_;
};

// Commands on their way to the rotors, and what an emptying battery makes of them.
class Actuators {
 public:
  Actuators(const FlightConditions& conditions, const Vehicle& vehicle, const BodyState& start,
            double step)
      : d_(conditions.disturbances),
        flight_time_(vehicle.flight_time),
        late_(static_cast<std::size_t>(std::llround(d_.command_delay / step))),
        sent_(late_, start.rotor_thrusts) {}

  Eigen::Vector4d arriving(const Eigen::Vector4d& command, double flown) {
    Eigen::Vector4d now = command;
    if (late_ > 0) {
      sent_.push_back(command);
      now = sent_.front();
      sent_.pop_front();
    }
    if (d_.battery_loss == 0) return now;
    return (1 - d_.battery_loss * std::min(1.0, d_.battery_used + flown / flight_time_)) * now;
  }

 private:
  const Disturbances& d_;
  double flight_time_;
  std::size_t late_;
  std::deque<Eigen::Vector4d> sent_;
};

void check(const FlightConditions& c, const Vehicle& vehicle) {
  const auto refuse = [](const std::string& text) { throw InputError({}, text); };
  constexpr double kFastestWind = 150;  // m/s, beyond what was ever measured near the ground
  if (!(c.wind_mean >= 0 && c.wind_gust >= 0 && c.wind_mean + c.wind_gust <= kFastestWind))
    refuse("wind: mean and gust must be at least 0 m/s, and at most 150 m/s together");
  if (!std::isfinite(c.wind_yaw)) refuse("wind: its direction must be a number");
  if (!(c.mass_error > -0.9 && c.mass_error <= 10))
    refuse("mass error: must lie between -90 and 1000 percent");
  if (!(c.step > 0 && c.step <= 0.02 && c.sample_step >= c.step))
    refuse("the controller's step must lie between 0 and 0.02 s");
  if (const auto problem = problem_of(c.disturbances)) refuse(*problem);
  if ((c.wind_mean > 0 || c.wind_gust > 0) && vehicle.drag <= 0 &&
      c.disturbances.quadratic_drag <= 0)
    refuse("vehicle '" + vehicle.name +
           "' states no drag, so that wind cannot move it: add 'drag' "
           "to its file");
}

// The yaw of an attitude is that of the heading at right angles to its y axis (thesis 3.8.2); where
// the x axis points seen from above differs from it by the product of two tilts.
double yaw_error_of(const BodyState& state, double yaw) {
  const Vector3d y = state.orientation * Vector3d::UnitY();
  return std::remainder(std::atan2(-y.x(), y.y()) - yaw, 2 * std::numbers::pi);
}

// Of a plan that states attitudes: how far the body is turned about its own z axis, which is the
// heading of a level vehicle and has a meaning in every attitude.
double twist_error_of(const BodyState& state, const BodyPoint& wanted) {
  const Eigen::Quaterniond off = wanted.orientation.conjugate() * state.orientation;
  return std::remainder(2 * std::atan2(off.z(), off.w()), 2 * std::numbers::pi);
}

void require_limits(const RotorCommand& command, const Vehicle& vehicle,
                    const Controller& controller, double time) {
  const Rotors& rotors = vehicle.rotors;
  for (const double thrust : command.thrusts) {
    if (thrust >= rotors.thrust_min - kBeyondLimit && thrust <= rotors.thrust_max + kBeyondLimit)
      continue;
    char text[200];
    std::snprintf(text, sizeof text,
                  "the controller commands a thrust of %.6g N at %.6g s; a rotor takes %.6g to "
                  "%.6g N",
                  thrust, time, rotors.thrust_min, rotors.thrust_max);
    const char* name = controller.plugin_name();
    throw Error(name ? std::string("plugin '") + name + "': " + text : text);
  }
}

}  // namespace

ControlledPlan::ControlledPlan(const Trajectory& trajectory, const Vehicle& vehicle,
                               std::unique_ptr<Controller> controller)
    : vehicle_(vehicle),
      reference_(trajectory, vehicle),
      controller_(controller ? std::move(controller) : std::make_unique<ThesisController>()) {
  in_plugin(
      *controller_, "follow", [&] { controller_->follow(vehicle_, reference_); },
      CallLength::lengthy);
}

FlownPath ControlledPlan::fly(const FlightConditions& conditions,
                              const CancellationToken* cancellation,
                              const std::function<void(double)>& told) const {
  check(conditions, vehicle_);
  const ReferenceMotion& reference = reference_.motion();
  const std::unique_ptr<ControlledFlight> flight =
      in_plugin(*controller_, "begin", [&] { return controller_->begin(); });
  const Disturbances& d = conditions.disturbances;
  const RotorBody body(vehicle_, 1 + conditions.mass_error, 1 + d.inertia_error, d.quadratic_drag);
  BodyState state = reference_.starting_state();

  FlownPath path;
  const double duration = reference.finish() - reference.start();
  const auto steps = static_cast<std::int64_t>(std::ceil(duration / conditions.step - 1e-9));
  const double step = duration / static_cast<double>(steps);
  const auto every = std::max<std::int64_t>(1, std::llround(conditions.sample_step / step));
  Wind wind(conditions);
  Estimator estimator(conditions, step);
  Actuators actuators(conditions, vehicle_, state, step);
  double sum = 0, turned = 0;
  std::int64_t saturated = 0, flown = 0;
  // A controller that waits gets as long again.
  const std::int64_t most = 2 * steps;
  for (std::int64_t k = 0;; ++k) {
    if (k % 1024 == 0) {
      if (cancellation && cancellation->cancelled()) throw Cancelled();
      if (told) told(std::min(1.0, static_cast<double>(k) / static_cast<double>(steps)));
    }
    const double time = reference.start() + static_cast<double>(k) * step;
    const double progress =
        in_plugin(*controller_, "progress", [&] { return flight->progress(time); });
    path.finished = progress >= reference.finish() - step / 2;
    path.late_worst = std::max(path.late_worst, std::min(time, reference.finish()) - progress);
    const ReferencePoint wanted = reference.at(progress);
    const double error = (state.position - wanted.position).norm();
    Vector3d up = Vector3d::UnitZ();
    double yaw_error = 0;
    if (reference_.states_attitude()) {
      const BodyPoint whole = reference_.at(progress);
      up = whole.orientation * Vector3d::UnitZ();
      yaw_error = twist_error_of(state, whole);
    } else {
      yaw_error = yaw_error_of(state, wanted.yaw);
    }
    if (!(error <= kLost)) path.lost = true;
    const bool over = !((state.orientation * Vector3d::UnitZ()).dot(up) >= 0);
    turned = over ? turned + step : 0;
    if (over && (!reference_.states_attitude() || turned > kTumbling)) path.lost = true;
    if (!(error <= path.position_error_worst))
      path.position_error_worst = error, path.position_error_at = time;
    if (!(std::abs(yaw_error) <= path.yaw_error_worst))
      path.yaw_error_worst = std::abs(yaw_error), path.yaw_error_at = time;
    if (k <= steps) {
      const double off =
          progress == time ? error : (state.position - reference.at(time).position).norm();
      if (!(off <= path.clock_error_worst))
        path.clock_error_worst = off, path.clock_error_at = time;
    }
    const bool ended = path.finished || path.lost || k == most;
    if (k % every == 0 || ended)
      path.samples.push_back({time, state, wanted.position, error, yaw_error});
    sum += error;
    ++flown;
    if (ended) break;
    const BodyState known = estimator.estimate(state);
    const RotorCommand command =
        in_plugin(*controller_, "command", [&] { return flight->command(time, known, step); });
    require_limits(command, vehicle_, *controller_, time);
    saturated += command.saturated;
    const Eigen::Vector4d thrusts = actuators.arriving(command.thrusts, time - reference.start());
    state = body.after(state, thrusts, wind.next(state, step), step);
    path.rotor_speed_worst =
        std::max(path.rotor_speed_worst,
                 std::sqrt(state.rotor_thrusts.maxCoeff() / vehicle_.rotors.thrust_max));
  }
  path.position_error_mean = sum / static_cast<double>(flown);
  path.saturated_share =
      static_cast<double>(saturated) / static_cast<double>(std::max<std::int64_t>(1, flown - 1));
  return path;
}

FlownPath fly(const Trajectory& trajectory, const Vehicle& vehicle,
              const FlightConditions& conditions, const CancellationToken* cancellation,
              const std::function<void(double)>& told) {
  check(conditions, vehicle);
  return ControlledPlan(trajectory, vehicle).fly(conditions, cancellation, told);
}

}  // namespace lapwing
